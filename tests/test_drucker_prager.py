"""Drucker-Prager: what its return must obey, and Mohr-Coulomb where the two cones are matched."""

from math import cos, inf, nan, radians, sin, sqrt, tan
from typing import Any

import numpy as np
import pytest
from fixtures_plastic import biaxial, eigenvalues, respond, simple_shear, stiffness, turned
from hypothesis import given, settings
from hypothesis import strategies as st

from mpm_verify.solver.material.drucker_prager import CONES, DruckerPrager
from mpm_verify.solver.material.mohr_coulomb import MohrCoulomb
from mpm_verify.solver.plugins import create
from mpm_verify.solver.state import Floats

COUNT = 10_000
LAWS: dict[str, dict[str, Any]] = {
    "paper": {},
    "associated": {"psi": 31.0},
    "cohesive": {"psi": 10.0, "c": 2e3},
    "without dilation": {"psi": 0.0, "c": 2e3},
    "compression": {"psi": 10.0, "c": 2e3, "cone": "compression"},
    "auxetic": {"nu": -0.6, "phi": 60.0, "psi": 20.0, "c": 3e3},
}
every_law = pytest.mark.parametrize("name", LAWS)


def random_trials() -> Floats:
    rng = np.random.default_rng(3)
    return np.column_stack([rng.uniform(-2e4, 1e4, (COUNT, 3)), rng.uniform(-1e4, 1e4, COUNT)])


def invariants(sigma: Floats) -> tuple[Floats, Floats, Floats]:
    """p (P,), deviator as xx, yy, zz, xy (P,4), sqrt(J2) (P,)."""
    p = sigma[:, :3].mean(axis=1)
    s = sigma - p[:, None] * [1, 1, 1, 0]
    return p, s, np.sqrt((s**2).sum(axis=1) / 2 + s[:, 3] ** 2 / 2)


def excess(law: DruckerPrager, sigma: Floats) -> Floats:
    a, _ = CONES[law.cone](law.phi, law.psi)
    p, _, root = invariants(sigma)
    return root + a * (p - law.c / tan(radians(law.phi)))


@every_law
def test_return(name: str) -> None:
    """Admissible; plastic strain is C (trial - sigma), along s/(2 sqrt(J2)) + d/3 on the cone; at the apex inside."""
    law, trial = DruckerPrager(**LAWS[name]), random_trials()
    _, d = CONES[law.cone](law.phi, law.psi)
    sigma, history = respond(law, trial)
    assert excess(law, sigma).max() < 1e-13 * 1e5
    apex = np.abs(sigma - law.c / tan(radians(law.phi)) * np.array([1, 1, 1, 0])).max(axis=1) < 1e-9
    cone = (np.abs(sigma - trial).max(axis=1) > 0) & ~apex
    assert min(apex.sum(), cone.sum(), (~apex & ~cone).sum()) > 100
    assert np.abs(excess(law, sigma[cone])).max() < 1e-12 * 2e4
    volume = (trial - sigma)[:, :3].sum(axis=1) * (1 - 2 * law.nu) / law.E
    _, s, root = invariants(trial - sigma)
    shear = root / law.mu  # the multiplier, of the deviatoric part
    assert np.abs(volume - d * shear)[cone].max() < 1e-13
    _, t, size = invariants(sigma)
    assert np.abs(s * size[:, None] - t * root[:, None])[cone].max() < 1e-13 * 4e8
    assert (volume >= d * shear - 1e-13)[apex].all()
    assert np.abs(history[:, 1] - volume).max() < 1e-14
    plastic = eigenvalues(trial - sigma)
    assert np.abs(history[:, 0] - (plastic[:, 0] - plastic[:, 2]) / (2 * law.mu)).max() < 1e-13
    assert history[:, 0].max() > 1e-3


@pytest.mark.parametrize(("cone", "strength"), [("plane_strain", 1e3), ("compression", 2e3 / sqrt(3))])
def test_von_mises(cone: str, strength: float) -> None:
    """phi = 0: sqrt(J2) comes to its strength to round-off at any pressure, which stays; the return is radial."""
    law, trial = DruckerPrager(phi=0.0, c=1e3, cone=cone), random_trials()
    assert law.psi == 0.0
    sigma, history = respond(law, trial)
    p, s, root = invariants(sigma)
    before, t, size = invariants(trial)
    yielding = history[:, 0] > 0
    assert yielding.sum() > COUNT / 2
    assert np.abs(root[yielding] - strength).max() < 1e-12 * 2e4
    assert root[~yielding].max() < strength
    assert np.abs(p - before).max() < 1e-12 * 2e4
    assert np.abs(s * size[:, None] - t * root[:, None]).max() < 1e-13 * 4e8
    assert np.abs(history[:, 1]).max() == 0.0
    almost = respond(DruckerPrager(phi=1e-6, psi=0.0, c=1e3, cone=cone), trial)[0]
    assert np.abs(almost - sigma).max() < 1e-2  # its limit
    assert np.isfinite(respond(law, np.array([[1e150, 0.0, -1e150, 0.0]]))[0]).all()


def test_associated_is_the_closest_point() -> None:
    """(trial - s) . C (y - s) <= 0 for admissible y."""
    law, trial = DruckerPrager(psi=31.0, c=2e3), random_trials()[:2000]
    trial[:, 3] = 0.0
    sigma, rng = respond(law, trial)[0][:, :3], np.random.default_rng(8)
    strain = (trial[:, :3] - sigma) @ np.linalg.inv(stiffness(law)) * law.E / 2e4
    y = rng.uniform(-4e4, 1e4, (4000, 3))
    y = y[excess(law, np.column_stack([y, np.zeros(4000)])) <= 0]
    assert len(y) > 500
    work = strain @ y.T - (strain * sigma).sum(axis=1)[:, None]
    assert work.max() < 1e-12 * 2e4
    other = respond(DruckerPrager(psi=10.0, c=2e3), trial)[0][:, :3]
    strain = (trial[:, :3] - other) @ np.linalg.inv(stiffness(law)) * law.E / 2e4
    assert (strain @ y.T - (strain * other).sum(axis=1)[:, None]).max() > 1e2


@every_law
def test_once_is_enough_and_the_frame_does_not_matter(name: str) -> None:
    law, trial = DruckerPrager(**LAWS[name]), random_trials()
    once, history = respond(law, trial)
    twice, more = respond(law, once)
    assert np.abs(twice - once).max() < 1e-12 * 2e4
    assert np.abs(more).max() < 1e-12
    angle = np.random.default_rng(5).uniform(0, 2 * np.pi, COUNT)
    askew, kept = respond(law, turned(trial, angle))
    assert np.abs(askew - turned(once, angle)).max() < 1e-12 * 2e4
    assert np.abs(kept - history).max() < 1e-12 * history.max()


def test_of_degree_one_without_cohesion() -> None:
    law, trial = DruckerPrager(), random_trials()
    for factor in (2.0**40, 2.0**-60, 2.0**450, 2.0**-450):
        assert np.array_equal(respond(law, factor * trial)[0], factor * respond(law, trial)[0])


def test_the_associated_cone_of_plane_strain() -> None:
    """a = d = 3 tan phi / sqrt(9 + 12 tan^2 phi)."""
    for phi in (1.0, 20.0, 31.0, 60.0):
        known = 3 * tan(radians(phi)) / sqrt(9 + 12 * tan(radians(phi)) ** 2)
        assert CONES["plane_strain"](phi, phi) == pytest.approx((known, known), rel=1e-14)


@pytest.mark.parametrize("psi", [0.0, 1.0, 31.0])
def test_simple_shear_as_mohr_coulomb(psi: float) -> None:
    """The plane strain cone has the ratio of Davis, sin phi cos psi/(1 - sin phi sin psi), and dilates by tan psi."""
    s, flow = sin(radians(31)), radians(psi)
    ratio, dilation = simple_shear(DruckerPrager(psi=psi), 840.0, 0.2, 100)
    assert ratio == pytest.approx(s * cos(flow) / (1 - s * sin(flow)), abs=1e-12)
    assert dilation == pytest.approx(tan(flow), abs=1e-11)
    stronger, _ = simple_shear(DruckerPrager(psi=psi, cone="compression"), 840.0, 0.2, 100)
    assert stronger > ratio + 0.05


@pytest.mark.parametrize("c", [0.0, 100.0])
def test_biaxial_failure_as_mohr_coulomb(c: float) -> None:
    """s_yy = k s_xx - 2 c sqrt(k), de_xx = -m de_yy: reached exactly, and zz goes on to s_zz = -2/3 d sqrt(J2)."""
    law, p0 = DruckerPrager(c=c), 840.0
    k, m = ((1 + sin(radians(angle))) / (1 - sin(radians(angle))) for angle in (31, 1))
    sigma, ratio = biaxial(law, p0, 0.1, 200)
    assert sigma[-1, 1] == pytest.approx(-k * p0 - 2 * c * sqrt(k), rel=1e-12)
    assert ratio[-1] == pytest.approx(m, abs=1e-11)
    _, s, root = invariants(sigma)
    assert s[-1, 2] == pytest.approx(-2 / 3 * CONES["plane_strain"](31, 1)[1] * root[-1], rel=1e-10)
    limit, _ = biaxial(MohrCoulomb(c=c), p0, 0.1, 200)
    assert limit[-1, 1] == pytest.approx(sigma[-1, 1], rel=1e-12)
    assert abs(limit[-1, 2] - sigma[-1, 2]) > 1e-2 * p0  # s_zz is another one


@pytest.mark.parametrize("c", [0.0, 1e3])
def test_the_compression_cone_holds_the_edge(c: float) -> None:
    """s1 = s2 on the edge of Mohr-Coulomb is on the cone; s2 = s3 is inside."""
    k = (1 + sin(radians(31))) / (1 - sin(radians(31)))
    law = DruckerPrager(c=c, cone="compression")
    low = -1e4 * k - 2 * c * sqrt(k)
    sigma = np.array([[-1e4, -1e4, low, 0], [-1e4, low, -1e4, 0], [-1e4, low, low, 0]])
    assert np.abs(excess(law, sigma)[:2]).max() < 1e-13 * 4e4
    assert excess(law, sigma)[2] < -1e3


def test_the_apex_is_that_of_mohr_coulomb() -> None:
    trial = np.full((1, 4), 1e6) * [1, 1, 1, 0]
    for cone in CONES:
        for psi in (0.0, 10.0, 31.0):
            out, _ = respond(DruckerPrager(psi=psi, c=2e3, cone=cone), trial)
            assert np.abs(out - 2e3 / tan(radians(31)) * np.array([1, 1, 1, 0])).max() < 1e-11
    assert not respond(DruckerPrager(), trial)[0].any()
    assert not respond(DruckerPrager(), np.zeros((1, 4)))[0].any()


numbers = st.one_of(st.floats(-3e4, 3e4), st.sampled_from([0.0, -1e4, 1e-150, -1e-150, 1e150, -1e150, nan, inf, -inf]))
parameters = st.fixed_dictionaries(
    {
        "nu": st.floats(-0.95, 0.495),
        "phi": st.floats(0.5, 85),
        "share": st.floats(0, 1),
        "c": st.one_of(st.just(0.0), st.floats(1e-3, 1e6)),
        "cone": st.sampled_from(sorted(CONES)),
    }
)


@pytest.mark.slow
@settings(deadline=None, max_examples=300, derandomize=True, database=None)
@given(parameters, st.tuples(numbers, numbers, numbers, numbers))
def test_whatever_comes(values: dict[str, Any], state: tuple[float, ...]) -> None:
    """Admissible and the same again; what is lost stays lost."""
    rest = dict(values)
    share = rest.pop("share")
    law = DruckerPrager(psi=min(share * rest["phi"], rest["phi"]), **rest)
    out, history = respond(law, np.array([state]))
    assert np.isfinite(out).all() == np.isfinite(state).all()
    if np.isfinite(state).all():
        apex = law.c / tan(radians(law.phi))
        scale = max(np.abs(state).max(), apex, 1e-3)
        assert np.isfinite(history).all()
        assert excess(law, out)[0] <= 1e-13 * scale
        assert np.abs(respond(law, out)[0] - out).max() <= 1e-13 * scale


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("phi=0", "phi = 0 must have c above zero"),
        ("phi=0,c=1,psi=2", "psi = 2.0 must lie between 0 and phi = 0.0"),
        ("psi=40", "psi = 40.0 must lie between 0 and phi"),
        ("c=-1", "must be zero or more"),
        ("nu=0.5", "must lie between"),
        ("cone=outer", "cone = 'outer' must be one of plane_strain, compression"),
        ("sigma_t=1", "has no parameter 'sigma_t'"),
        ("rate=none", "choose from"),
    ],
)
def test_bad_parameters(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        create("mpm_verify.solver.material", f"drucker_prager:{text}")
