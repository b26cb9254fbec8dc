"""Hencky solid: closed forms at 30 digits, the undeformed state, and its rate form with the rates that are exact."""

from pathlib import Path
from typing import Any

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from fixtures_rates import started, step_to, turned

from mpm_verify.cases.exact.dense import weights
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.judging.order import Expectation, Level, Outcome, judge
from mpm_verify.cases.judging.records import ReasonCode
from mpm_verify.cases.mms import rates
from mpm_verify.cases.mms.execute import execute, setup
from mpm_verify.cases.mms.expectations import expected, promised
from mpm_verify.cases.mms.rates import SHEARED, table
from mpm_verify.cases.mms.run import Run
from mpm_verify.mms.manufacture import manufacture
from mpm_verify.solver.log_spread import written
from mpm_verify.solver.log_spread_symbol import SpreadSquared
from mpm_verify.solver.material.hencky import NEAR, flatness, spread_squared
from mpm_verify.solver.plugins import MATERIALS, NEGATIVE_CONTROLS, SOLUTIONS, available, canonical, create
from mpm_verify.solver.state import Floats, Particles
from mpm_verify.verify.commands.export import made

HENCKY: Any = create(MATERIALS, "hencky")
LAM, MU = HENCKY.lam, HENCKY.mu
SPREADS = (1e-12, 1e-8, 1e-4, 0.01, 0.14, 0.3, 1.0, 3.0, 5.0)  # d; NEAR is at 0.14


def stress(law: Any, F: Any) -> Floats:
    """Stress (P,4) of a function of F for F (P,2,2)."""
    F = np.asarray(F, np.float64)
    p = Particles(np.zeros((len(F), 2)), np.ones(len(F)), np.ones(len(F)), np.zeros((len(F), 0)))
    p.F[:] = F
    law.update(p, 1.0)
    return p.sigma.copy()


def exact(F: Any, lam: float = LAM, mu: float = MU) -> Floats:
    """Stress (4,) of one F (2,2) by eigenvectors of F F^T, in 40 digits: no formula that the solver has."""
    with mp.workdps(40):
        F = mp.matrix(np.asarray(F).tolist())
        values, axes = mp.eigsy(F * F.T)
        logs = [mp.log(b) / 2 for b in values]
        J, trace = mp.det(F), logs[0] + logs[1]
        tau = [lam * trace + 2 * mu * one for one in logs]
        plane = axes * mp.diag(tau) * axes.T
        return np.array([float(c / J) for c in (plane[0, 0], plane[1, 1], lam * trace, plane[0, 1])])


@pytest.mark.parametrize("d", SPREADS)
def test_square_of_the_spread_and_its_slopes_have_all_digits(d: float) -> None:
    with mp.workdps(60):
        y = mp.cosh(mp.mpf(d)) - 1
        known = [mp.mpf(d) ** 2, 2 * d / mp.sinh(d), 2 * (mp.sinh(d) - d * mp.cosh(d)) / mp.sinh(d) ** 3]
    for n, value in enumerate(known):
        assert written(float(y), n) == pytest.approx(float(value), rel=2e-15, abs=0)
    assert flatness.py_func(float(y)) == pytest.approx(float(known[1] / 2), rel=2e-15, abs=0)


def test_series_and_logarithm_of_the_kernel_meet() -> None:
    below, above = (flatness.py_func(np.nextafter(NEAR, side)) for side in (0.0, 1.0))
    assert below == pytest.approx(above, rel=3e-16, abs=0)


def test_a_naive_arcosh_fails_near_one() -> None:
    """Square of arcosh(tr C / 2J) as it is written: half of its digits are gone at a strain of 1e-8, then all."""
    for stretch, lost in ((1e-3, 1e-11), (1e-6, 1e-5), (1e-8, 1e-1)):
        F = np.diag([1 + stretch, 1.0])
        naive = np.arccosh(np.trace(F.T @ F) / (2 * np.linalg.det(F))) ** 2
        right = float(mp.log(1 + mp.mpf(stretch)) ** 2)
        y = (F[0, 0] - F[1, 1]) ** 2 / (2 * np.linalg.det(F))
        assert abs(naive / right - 1) > lost
        assert spread_squared(y) == pytest.approx((F[0, 0] - 1) ** 2 * (1 - stretch), rel=2e-6)
        assert spread_squared(y) == pytest.approx(np.log(F[0, 0]) ** 2, rel=3e-15)
    y = sp.Symbol("y", positive=True)
    slope = sp.diff(sp.acosh(1 + y) ** 2, y)
    with np.errstate(all="ignore"):
        assert np.isnan(sp.lambdify(y, slope, "numpy")(np.float64(0.0)))
    assert sp.diff(SpreadSquared(y, 0), y).subs(y, 0).expand(func=True) == 2
    assert sp.diff(SpreadSquared(y, 0), y, 2).subs(y, 0).expand(func=True) == sp.Rational(-2, 3)


STREAM = """\"\"\"Stream function in a clamped square: its linear part has no divergence.\"\"\"
import sympy as sp

def displacement(X, t, A=0.01):
    psi = sp.sin(sp.pi * X[0]) ** 2 * sp.sin(sp.pi * X[1]) ** 2
    return A * sp.Matrix([sp.diff(psi, X[1]), -sp.diff(psi, X[0])]) * (1 - sp.cos(100 * sp.pi * t)) / 2

def domain():
    return {"lower": (0, 0), "upper": (1, 1), "duration": 0.02, "speed": 100, "order": 2}
"""


def test_the_stable_courant_number_of_what_is_nearly_incompressible(tmp_path: Path) -> None:
    """The limit is told, 0.241, and the number that is typed, 0.7 of it, is one that the limit does not refuse."""
    (tmp_path / "stream.py").write_text(STREAM)
    values = {"solution": (str(tmp_path / "stream.py"),), "cells": (8, 16), "ppc": (4,)}
    for nu, limit, typed in (("0.49", "0.241", "0.169"), ("0.499", "0.0773", "0.0541")):
        model = (f"neo_hookean:nu={nu}",)
        with pytest.raises(ValueError, match=f"limit of {limit}, and nearly incompressible .* {typed};") as told:
            build(Asked("mms", values | {"material": model}), "verify mms")
        assert f"take --courant {typed}" in str(told.value)
        assert build(Asked("mms", values | {"material": model, "courant": (float(typed),)}), "verify mms").runs
    stiff = values | {"material": ("neo_hookean:nu=0.49",), "courant": (0.2,)}
    with pytest.raises(ValueError, match=r"0.2 is below the stability limit of 0.241, .* up to 0.169: noise .* grows"):
        build(Asked("mms", stiff), "verify mms")
    for other in ({"method": ("bspline2",)}, {"smoothing": ("fbar",)}):
        assert build(Asked("mms", stiff | other), "verify mms").runs
    with pytest.raises(ValueError, match=r"limit of 0.241; .* take --courant 0.241"):  # F-bar relieves it
        build(Asked("mms", values | {"material": ("neo_hookean:nu=0.49",), "smoothing": ("fbar",)}), "verify mms")


def growth(nu: float, method: str, part: float) -> float:
    """Largest growth of a small state in one step of update-stress-last, at `part` of dx/c, undeformed."""
    material = canonical(MATERIALS, f"neo_hookean:nu={nu}")
    model, _, _ = setup(Run(method, "clamped_shear", material, 5, 4))
    p, g, m = model.particles, model.grid, model.material
    by = weights(model, p.x, np.tile(np.eye(2), (len(p), 1, 1)))
    free = (p.m @ by.N > 1e-12) & ~np.asarray(model.walls.held).any(axis=1)
    N, (gx, gy) = by.N[:, free], np.moveaxis(by.dN[:, free], -1, 0)
    mass, none, dt = p.m @ N, np.zeros_like(N), part * g.dx / m.wave_speed()
    B = np.block([[gx, none], [none, gy], [gy, gx]])
    D = np.kron([[m.lam + 2 * m.mu, m.lam, 0], [m.lam, m.lam + 2 * m.mu, 0], [0, 0, m.mu]], np.eye(len(p)))
    push = -dt * (B * np.tile(p.V0, 3)[:, None] / np.tile(mass, 2)).T  # of the grid's velocities by stresses
    back, take = np.kron(np.eye(2), N), np.kron(np.eye(2), (N * p.m[:, None] / mass).T)
    size = len(p)
    step = np.block([[np.eye(2 * size), back @ push], [dt * D @ B @ take, np.eye(3 * size) + dt * D @ B @ push]])
    unit = np.repeat([1.0, m.rho0 * m.wave_speed()], [2 * size, 3 * size])  # of velocity and stress
    return float(np.abs(np.linalg.eigvals(step * unit / unit[:, None])).max()) - 1


@pytest.mark.slow
@pytest.mark.parametrize("nu", [0.3, 0.49, 0.4999])
def test_noise_grows_beyond_five_sixths_of_the_limit_whatever_the_compressibility(nu: float) -> None:
    """Hat functions: stable at 0.8 of dx/c, and 0.4 a step at 0.9; splines are stable at the whole of it."""
    assert growth(nu, "cpdi", 0.8) < 1e-6
    assert growth(nu, "cpdi", 0.9) > 0.3
    assert growth(nu, "bspline2", 1.0) < 1e-6


def test_body_force_is_finite_where_nothing_is_deformed() -> None:
    """The start of axis_aligned, where F = I everywhere; 1e-9 of a period later the body force has hardly changed."""
    solution: Any = create(SOLUTIONS, "axis_aligned")
    b = manufacture(solution, HENCKY, HENCKY.rho0).b
    X = np.random.default_rng(3).uniform(0.1, 0.9, (20, 2))
    still, soon = b(X, 0.0), b(X, 1e-9 * solution.duration)
    assert np.isfinite(still).all()
    assert np.abs(soon - still).max() < 1e-7 * np.abs(b(X, 0.3 * solution.duration)).max()


def test_stress_of_any_gradient_in_40_digits() -> None:
    rng = np.random.default_rng(7)
    F = np.concatenate([np.eye(2) + size * rng.uniform(-1, 1, (12, 2, 2)) for size in (1e-9, 1e-5, 0.1, 0.6)])
    F = F[np.linalg.det(F) > 0.05]
    found, known = stress(HENCKY, F), np.array([exact(one) for one in F])
    scale = np.abs(known).max(axis=1) + LAM * 1e-16
    assert (np.abs(found - known).max(axis=1) / scale < 2e-6)[:24].all()  # round-off in F itself, of 1e-9 at the least
    assert np.abs(found - known).max() < 4e-13 * LAM


@pytest.mark.parametrize("stretch", [0.3, 0.999999, 1.0, 1.5, 3.0])
def test_uniaxial_strain(stretch: float) -> None:
    axial, lateral = (LAM + 2 * MU) * np.log(stretch) / stretch, LAM * np.log(stretch) / stretch
    found = stress(HENCKY, [np.diag([stretch, 1.0])])[0]
    np.testing.assert_allclose(found, [axial, lateral, lateral, 0.0], rtol=1e-14, atol=1e-12 * MU)


@pytest.mark.parametrize("shear", [1e-9, 0.1, 1.0, 5.0])
def test_simple_shear(shear: float) -> None:
    """Closed form by asinh(g/2): tau_xy = 2 mu asinh(g/2) / sqrt(1 + g^2/4), normal stresses +/- g/2 of it."""
    xy = 2 * MU * np.arcsinh(shear / 2) / np.sqrt(1 + shear**2 / 4)
    found = stress(HENCKY, [[[1.0, shear], [0.0, 1.0]]])[0]
    np.testing.assert_allclose(found, [shear / 2 * xy, -shear / 2 * xy, 0.0, xy], rtol=1e-14, atol=1e-15 * LAM)


def test_a_superposed_rotation_turns_the_stress() -> None:
    F = np.array([[1.2, 0.5], [-0.1, 0.8]])
    for angle in (0.3, 1.9, -2.8):
        Q = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        turned_stress = turned(stress(HENCKY, [F])[0], angle)
        np.testing.assert_allclose(stress(HENCKY, [Q @ F])[0], turned_stress, atol=1e-13 * LAM)
        right = stress(HENCKY, [F @ Q])[0]
        np.testing.assert_allclose(right, stress(HENCKY, [F])[0], atol=1e-13 * LAM)  # isotropic


def test_it_has_no_energy_in_three_dimensions() -> None:
    F = [[sp.Symbol(f"F{i}{j}", real=True) for j in range(3)] for i in range(3)]
    with pytest.raises(ValueError, match="take --material neo_hookean"):
        HENCKY.energy(F, sp.log)


# ---- rate form


def path(t: float) -> Floats:
    """Stretch, shear and a turn of 1.2 that all go on."""
    c, s = np.cos(1.2 * t), np.sin(1.2 * t)
    return np.array([[c, -s], [s, c]]) @ np.array([[1 + 0.4 * t, 0.7 * t**2], [0.1 * t, 1 - 0.3 * t]])


def error(law: str, function: str, steps: int) -> float:
    """Distance from the stress of a function of F after the path, over its largest component."""
    rate: Any = create(MATERIALS, law)
    p = started(rate, np.eye(2)[None], np.zeros((1, 4)))
    for t in np.linspace(0, 1, steps + 1)[1:]:
        p = step_to(rate, p, path(t)[None])
    known = stress(create(MATERIALS, function), path(1.0)[None])[0]
    return float(np.abs(p.sigma[0] - known).max() / np.abs(known).max())


EXACT = {"hencky_rate": "hencky", "hencky_rate:rate=truesdell,nu=0": "neo_hookean:nu=0"}


@pytest.mark.parametrize("law", EXACT)
def test_rate_form_is_the_function_of_F_at_second_order(law: str) -> None:
    errors = [error(law, EXACT[law], steps) for steps in (20, 40, 80)]
    assert errors[-1] < 3e-4
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.1)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2, abs=0.05)


LIMITS = {"green_naghdi": 0.0282, "jaumann": 0.0569, "truesdell": 0.501}  # of the stress


@pytest.mark.parametrize("rate", LIMITS)
def test_another_rate_has_another_limit(rate: str) -> None:
    coarse, fine = (error(f"hencky_rate:rate={rate}", "hencky", steps) for steps in (40, 80))
    assert fine == pytest.approx(LIMITS[rate], rel=0.02)
    assert fine == pytest.approx(coarse, rel=0.05)


def test_work_of_a_closed_path_is_that_of_its_energy() -> None:
    """Work per initial volume from I to F is W(F), by steps; counted as if of a Cauchy stress it is off by J."""
    law: Any = create(MATERIALS, "hencky_rate")
    p = started(law, np.eye(2)[None], np.zeros((1, 4)))
    for t in np.linspace(0, 1, 401)[1:]:
        p = step_to(law, p, path(t)[None])
    whole = np.eye(3)
    whole[:2, :2] = path(1.0)
    assert p.work[0].mean() == pytest.approx(float(HENCKY.energy(whole.tolist(), np.log)), rel=2e-5)


# ---- what is registered, and the negative controls through MMS with rotation


def registered(material: str, solution: str, quantity: str = "u") -> Expectation | None:
    names = canonical(SOLUTIONS, solution), canonical(MATERIALS, material)
    return expected("cpdi", *names, 4, quantity, "rms")


def test_what_is_registered_of_hencky_solids() -> None:
    """Orders of neo-Hookean solids; a stall on the limit of another rate; a control is taken for the right rate."""
    for material in ("hencky", "hencky_rate", "hencky_rate:rate=truesdell,nu=0", "hencky_rate:rate=printed"):
        for solution in ("swirl", "clamped_shear"):
            found = registered(material, solution)
            assert found is not None
            assert found.order == 2
    for rate in ("green_naghdi", "jaumann"):
        found = registered(f"hencky_rate:rate={rate}", SHEARED)
        assert found is not None
        assert (found.kind, found.within, len(found.recorded)) == ("stalls", 0.01, 6)
        straight = registered(f"hencky_rate:rate={rate}", "axis_aligned")
        assert straight is not None
        assert straight.order == 2
        assert registered(f"hencky_rate:rate={rate}", "swirl") is None  # no limit was measured
    assert registered("hencky_rate:rate=truesdell", "axis_aligned") is None
    right, control = registered("hencky_rate", SHEARED), registered("hencky_rate:rate=strain_end", SHEARED)
    assert right is not None
    assert right == control
    assert len(right.recorded) == 6
    assert registered("hypoelastic", "swirl") is None


def verdict(material: str, solution: str, errors: list[float]) -> tuple[Outcome, ReasonCode]:
    """Verdict on u of cells 8, 12, 16, 24, 32 and, with six errors, 48."""
    expectation = registered(material, solution)
    assert expectation is not None
    levels = [Level(1 / n, (e,)) for n, e in zip((8, 12, 16, 24, 32, 48), errors, strict=False)]
    found = judge(levels, expectation, floor=1e-14, dt_halved=errors[-1])
    return found.outcome, found.reason.code


@pytest.mark.parametrize(("material", "solution"), [name[:2] for name in table()])
def test_recorded_errors_are_as_registered_and_others_are_not(material: str, solution: str) -> None:
    rows = [errors["u"] for _, errors in table()[material, solution, "cpdi", "4"]]
    assert verdict(material, solution, rows)[0] is Outcome.PASS
    assert verdict(material, solution, [1.03 * error for error in rows]) == (Outcome.FAIL, ReasonCode.MAGNITUDE)


@pytest.mark.slow
@pytest.mark.parametrize("run", [run for run in rates.runs() if run.cells == 12], ids=str)
def test_recorded_errors_of_hencky_solids(run: Run) -> None:
    """Run anew, ten times as near as the order rule asks for: every material, rate and solution of the table."""
    result, known = execute(run)[0], dict(table()[run.material, run.solution, "cpdi", "4"])[12]
    for quantity, error in known.items():
        assert result.errors[quantity]["rms"] == pytest.approx(error, rel=1e-3), quantity


@pytest.mark.parametrize(
    ("material", "solution", "quoted", "finest"),
    [
        ("hencky", "axis_aligned", (2.06, 1.92, 1.96, 1.94), 1.756e-4),
        ("hencky", "clamped_shear", (1.95, 2.01, 2.02, 2.01), 3.298e-4),
        ("hencky", "swirl", (2.04, 2.11, 2.03, 2.02), 7.556e-4),
        ("hencky_rate", "clamped_shear", (1.95, 2.01, 2.02, 2.01), 3.298e-4),
        ("hencky_rate", "swirl", (2.04, 2.11, 2.03, 2.02), 7.557e-4),
    ],
)
def test_quoted_orders_of_hencky_solids(material: str, solution: str, quoted: tuple[float, ...], finest: float) -> None:
    rows = dict(table()[canonical(MATERIALS, material), solution, "cpdi", "4"])
    cells = (8, 12, 16, 24, 32)
    errors = np.array([rows[n]["u"] for n in cells])
    local = np.log(errors[:-1] / errors[1:]) / np.log(np.array(cells[1:]) / cells[:-1])
    assert local == pytest.approx(quoted, abs=0.01)
    assert errors[-1] == pytest.approx(finest, rel=1e-3)


def test_the_limit_of_another_rate_is_no_order_of_the_right_one() -> None:
    """Floors of 3.9 and 9.8 % of u: as if of the logarithmic rate both are refused, by magnitude and without it."""
    for rate in ("green_naghdi", "jaumann"):
        rows = [errors["u"] for _, errors in table()[f"hencky_rate:rate={rate}", SHEARED, "cpdi", "4"]]
        assert verdict("hencky_rate", SHEARED, rows)[0] is Outcome.FAIL
        levels = [Level(1 / n, (e,)) for n, e in zip((8, 12, 16, 24, 32, 48), rows, strict=True)]
        plain = judge(levels, Expectation(2.0), floor=1e-14, dt_halved=rows[-1])
        assert plain.outcome is Outcome.FAIL


@pytest.mark.slow
@pytest.mark.parametrize("rate", ["logarithmic", *available(NEGATIVE_CONTROLS)])
def test_each_negative_control_is_refused_by_its_errors(rate: str) -> None:
    """One or two runs, v in rms: off the recorded errors of the rate that it is taken for, or inverted."""
    known = {one.h: one for one in rates.recorded("hencky_rate", SHEARED, "cpdi", 4, "v")}
    away = []
    for cells in (8, 12):
        result = execute(Run("cpdi", SHEARED, canonical(MATERIALS, f"hencky_rate:rate={rate}"), cells, 4))[0]
        away.append(abs(known[1 / cells].ratio(result.errors["v"]["rms"]) - 1) if result.errors else np.inf)
    assert max(away) < 1e-3 if rate == "logarithmic" else max(away) > 0.03


def test_rates_that_agree_on_a_straight_motion_are_no_other_solid_there() -> None:
    """Green-Naghdi and Jaumann are the logarithmic rate where F is diagonal; Truesdell's is not."""
    runs = {
        (rate, solution): Run("mpm", solution, f"hencky_rate:rate={rate}", 8, 4)
        for rate in ("jaumann", "green_naghdi", "truesdell")
        for solution in ("axis_aligned", "clamped_shear")
    }
    assert {one for one, run in runs.items() if not run.strays} == {
        ("jaumann", "axis_aligned"), ("green_naghdi", "axis_aligned"),
    }  # fmt: skip


def test_no_case_is_exported_of_a_rate_that_strays() -> None:
    """Motion that would be that of the energy; with the logarithmic rate, and where nothing turns, it is exact."""
    with pytest.raises(ValueError, match=r"rate without an energy.* export --material hencky"):
        made("clamped_shear", "hencky_rate:rate=jaumann", 8, 4, 0.4, 4)
    for solution, rate in (("axis_aligned", "jaumann"), ("clamped_shear", "logarithmic")):
        assert made(solution, f"hencky_rate:rate={rate}", 4, 1, 0.4, 2).record.steps > 0


def test_a_solver_of_somebody_else_promises_nothing() -> None:
    assert promised("mycode", crossing=True) is None
    assert promised("cpdi", crossing=False) is not None
