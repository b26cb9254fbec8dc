"""Void-strain memory: what has parted carries nothing until it touches again, and the volume is accounted for."""

from typing import Any

import numpy as np
import pytest

from mpm_verify.solver.plugins import create
from mpm_verify.solver.voids import remembering

LAWS = ["mohr_coulomb", "drucker_prager", "ubcsand"]
START = np.array([-2e3, -2e3, -2e3, 0.0])


def driven(law: Any, path: Any, start: Any = START) -> tuple[Any, Any]:
    """Stresses (n,4) and histories (n,H) along strain increments (n,3) of one element."""
    sigma, history = start.copy(), law.initial(start[None])[0]
    seen = []
    for de in np.array(path, float):
        law.respond(law.constants(), sigma, de.copy(), history)
        seen.append((sigma.copy(), history.copy()))
    return np.array([s for s, _ in seen]), np.array([h for _, h in seen])


def column(law: Any, name: str) -> int:
    return int(law.memory.index(name))


OPEN, CLOSE = [(0.0, 2e-3, 0.0)] * 50, [(0.0, -2e-3, 0.0)] * 50


@pytest.mark.parametrize("name", LAWS)
def test_stress_returns_where_it_left(name: str) -> None:
    """Pulled apart and pushed together by the same strain: contact is where it parted. Without memory it is at once."""
    with_, without = (driven(create("mpm_verify.solver.material", f"{name}:void={v}"), OPEN + CLOSE) for v in (1, 0))
    touches = [int(np.argmax(np.abs(sigma[50:]).max(axis=1) > 1.0)) for sigma, _ in (with_, without)]
    assert np.abs(with_[0][49]).max() == 0.0
    assert touches[0] > 40
    assert touches[1] == 0
    # what is left in the end is the strain of unloading from START; without memory the whole way back
    assert abs(without[0][-1, 1]) > 5 * abs(with_[0][-1, 1]) > 0


@pytest.mark.parametrize("name", LAWS)
def test_shear_while_open_changes_nothing(name: str) -> None:
    law = create("mpm_verify.solver.material", f"{name}:void=1")
    sigma, history = driven(law, [*OPEN, (1e-3, -1e-3, 5e-3), (0.0, 0.0, -0.1), (-5e-3, 0.0, 0.02)])
    assert np.abs(sigma[50:]).max() == 0.0
    void = history[:, column(law, "void")]
    np.testing.assert_allclose(np.diff(void[49:]), [0.0, 0.0, -5e-3], atol=1e-15)


@pytest.mark.parametrize("name", ["mohr_coulomb", "drucker_prager"])
def test_volume_is_accounted_for(name: str) -> None:
    """Elastic volume, plastic volume and void strain make the volume strain, to round-off, on random paths."""
    law = create("mpm_verify.solver.material", f"{name}:void=1,psi=5")
    path = np.random.default_rng(1).normal(0, 3e-3, (2000, 3))
    sigma, history = driven(law, path)
    bulk = law.lam + 2 * law.mu / 3
    elastic = (sigma[:, :3].sum(axis=1) - START[:3].sum()) / (9 * bulk) * 3
    void = history[:, column(law, "void")]
    total = elastic + history[:, column(law, "eps_v_p")] + void
    volume = np.cumsum(path[:, 0] + path[:, 1])
    lost = np.abs(total - volume).max()
    assert lost < 1e-12
    assert 0 < (void > 0).mean() < 1
    assert (void >= 0).all()


def test_ubcsand_opens_by_what_no_pressure_takes() -> None:
    """Detached from the start, all of the strain is void strain; in compression nothing is."""
    law = create("mpm_verify.solver.material", "ubcsand:void=1")
    _, history = driven(law, [(1e-3, 2e-3, 0.0)] * 10, np.zeros(4))
    np.testing.assert_allclose(history[:, column(law, "void")], 3e-3 * np.arange(1, 11), rtol=1e-9)
    _, history = driven(law, [(-1e-4, -1e-4, 1e-4)] * 10)
    assert (history[:, column(law, "void")] == 0).all()


@pytest.mark.parametrize("name", LAWS)
def test_off_it_is_not_there(name: str) -> None:
    path = np.random.default_rng(2).normal(0, 3e-3, (300, 3))
    plain = create("mpm_verify.solver.material", name)
    assert (driven(plain, path)[1][:, column(plain, "void")] == 0).all()


@pytest.mark.parametrize("name", LAWS)
def test_a_void_below_zero_is_none(name: str) -> None:
    """Rounding at the apex of Drucker-Prager leaves -1e-72, and a strain of no volume made NaN of it."""
    law = create("mpm_verify.solver.material", f"{name}:void=1")
    for start, de in ((START, (1e-4, -2e-4, 1e-4)), (START, (1e-4, -1e-4, 1e-4)), (0 * START, (0.0, 0.0, 1e-19))):
        ends = []
        for void in (0.0, -1e-72):
            sigma, history = start.copy(), law.initial(start[None])[0]
            history[column(law, "void")] = void
            law.respond(law.constants(), sigma, np.array(de), history)
            ends.append(np.concatenate([sigma, history]))
        np.testing.assert_array_equal(ends[1], ends[0])
        assert np.isfinite(ends).all()


@pytest.mark.parametrize("name", LAWS)
def test_a_lost_strain_is_not_hidden(name: str) -> None:
    law = create("mpm_verify.solver.material", f"{name}:void=1")
    for bad in (np.nan, np.inf):
        sigma, history = driven(law, [*OPEN, (0.0, bad, 0.0), (-bad, bad, 0.0)])
        assert not np.isfinite(sigma[-1]).all() or not np.isfinite(history[-1]).all()


@pytest.mark.parametrize("name", ["mohr_coulomb:c=500", "ubcsand:c=500"])
def test_soil_with_cohesion_parts_free_of_stress_too(name: str) -> None:
    """Parted at a cut-off of zero it touches where it left; without memory at once, and it has grown by the opening."""
    path = [(1e-3, 1e-3, 0.0)] * 50 + [(-1e-3, -1e-3, 0.0)] * 50  # on both axes: on one alone it is a crack
    with_, without = (driven(create("mpm_verify.solver.material", f"{name},void={v}"), path) for v in (1, 0))
    touches = [int(np.argmax(np.abs(sigma[50:, :2]).max(axis=1) > 1.0)) for sigma, _ in (with_, without)]
    assert np.abs(with_[0][49, [0, 1, 3]]).max() == 0.0
    assert touches[0] > 40
    assert touches[1] == 0
    assert abs(without[0][-1, 1]) > 5 * abs(with_[0][-1, 1]) > 0


def test_who_remembers() -> None:
    """Sand, and soil that parts at no stress; not what holds tension, nor what has no voids."""
    for name, remembers in {
        "mohr_coulomb": True, "mohr_coulomb:c=500": True, "mohr_coulomb:c=500,sigma_t=10": False, "ubcsand:c=500": True,
        "drucker_prager": True, "drucker_prager:c=500": False,
    }.items():  # fmt: skip
        assert remembering(create("mpm_verify.solver.material", name)).void == remembers, name


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize(
    ("parameters", "says"), [("void=2", "must be 0 or 1"), ("void=1,c=100,sigma_t=10", "must have c = 0")]
)
def test_refusals(name: str, parameters: str, says: str) -> None:
    parameters = parameters.replace(",sigma_t=10", "") if name == "drucker_prager" else parameters  # it has no cut-off
    with pytest.raises(ValueError, match=says):
        create("mpm_verify.solver.material", f"{name}:{parameters}")
