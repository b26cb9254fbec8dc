"""The exactness battery: it holds on the solver as it is, and each of its tests can fail."""

from collections.abc import Iterator

import numpy as np
import pytest
from fixtures_command import TOP
from fixtures_planted import DEFECTS, PLACEBOS, Defect, Plant

from mpm_verify.cases.exact import battery
from mpm_verify.cases.exact.battery import run
from mpm_verify.cases.exact.body import Subject
from mpm_verify.cases.exact.groups import GROUPS, group_of
from mpm_verify.mms.constitutive import driver, hardening, plastic
from mpm_verify.mms.constitutive.surfaces import surfaces
from mpm_verify.mms.constitutive.tested import MARGIN, Tested
from mpm_verify.reports.sentences import exact as said
from mpm_verify.solver._jit import use_threads
from mpm_verify.solver.plugins import MATERIALS, METHODS, available, create

FAST = (  # one of each kind; the others take ten seconds together
    "gradients swapped", "round for floor", "domains by F^T", "sigma_xy in one row", "L transposed", "FLIP 0.99",
    "reaction handed on", "sigma_zz = 0", "gamma_p overwritten", "half sides 1 % short", "damping 1 % low",
    "means without volumes", "state that is not stored", "edge a step late",
    "held in tension", "void with cohesion closes with more",
)  # fmt: skip
FAR = 1e3  # times its bound: what a planted defect is seen by, in the test that points to it


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    use_threads(1)
    yield
    use_threads(2)


def missed(tested: tuple[Tested, ...] | list[Tested]) -> list[str]:
    return [f"{one.name}: {one.residual:.2g} > {one.bound:.2g}" for one in tested if not one.passed]


def groups(method: str, material: str, *tests: str) -> list[Tested]:
    """Tests of the groups that some tests belong to."""
    names = dict.fromkeys(map(group_of, tests))
    subject = Subject(method, material)
    return [one for name in names for one in battery.tested(name, subject)]


@pytest.mark.parametrize("material", ["neo_hookean", "mohr_coulomb"])
def test_all_holds(material: str) -> None:
    """Every test of CPDI, with a margin: all that round-off bounds is a tenth of its bound or less."""
    tested = run("cpdi", material)
    assert not missed(tested)
    assert all(one.residual <= 0.1 * one.bound for one in tested if not one.reason and one.test != "stable_step")


@pytest.mark.slow
@pytest.mark.parametrize("material", available(MATERIALS))
@pytest.mark.parametrize("method", available(METHODS))
def test_all_holds_with_every_method_and_material(method: str, material: str) -> None:
    tested = run(method, material)
    assert not missed(tested)
    assert {one.test for one in tested} == {name for names in GROUPS.values() for name in names}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("method", "material"),
    [
        ("cpdi:limit=1", "hypoelastic:rate=truesdell"),
        ("cpdi:limit=0.3", "hypoelastic:rate=logarithmic"),
        ("mpm", "mohr_coulomb:void=1"),
        ("mpm", "mohr_coulomb:c=1000,void=1"),
        ("mpm", "ubcsand:c=1000,void=1"),
        ("mpm", "mohr_coulomb:c=1000,sigma_t=50,psi=10,rate=jaumann"),
        ("mpm", "drucker_prager:c=500,cone=compression"),
        ("mpm", "ubcsand:reversal=1"),
        ("mpm", "neo_hookean:nu=0.45,E=3e6,rho0=1800"),
    ],
)
def test_all_holds_with_parameters(method: str, material: str) -> None:
    assert not missed(run(method, material))


@pytest.mark.parametrize("defect", [pytest.param(DEFECTS[name], id=name) for name in FAST])
def test_a_defect_is_seen(defect: Defect, monkeypatch: pytest.MonkeyPatch) -> None:
    check_defect(defect, monkeypatch)


@pytest.mark.slow
@pytest.mark.parametrize("defect", [pytest.param(one, id=name) for name, one in DEFECTS.items() if name not in FAST])
def test_a_defect_is_seen_by_the_tests_that_point_to_it(defect: Defect, monkeypatch: pytest.MonkeyPatch) -> None:
    check_defect(defect, monkeypatch)


def check_defect(defect: Defect, monkeypatch: pytest.MonkeyPatch) -> None:
    """Plant a defect, and hold that each test that points to it sees it."""
    defect.plant(monkeypatch)
    tested = groups(defect.method, defect.material, *defect.seen_by)
    for name in defect.seen_by:
        worst = max(one.over for one in tested if one.test == name)
        assert worst > (1.1 if name == "stable_step" else FAR), (name, worst, missed(tested))


@pytest.mark.slow
@pytest.mark.parametrize("placebo", PLACEBOS.values(), ids=PLACEBOS)
def test_a_placebo_is_not_seen(placebo: Plant, monkeypatch: pytest.MonkeyPatch) -> None:
    placebo(monkeypatch)
    assert not missed(run("cpdi", "neo_hookean"))


def test_every_test_is_shown_to_fail() -> None:
    seen = {name for defect in DEFECTS.values() for name in defect.seen_by}
    assert {name for names in GROUPS.values() for name in names} == seen


def test_every_test_part_and_reason_has_its_words() -> None:
    from mpm_verify.mms.constitutive.tested import Part, Reason

    assert set(said.HELD) == {name for names in GROUPS.values() for name in names}
    assert set(said.PARTS) == set(Part)
    assert set(said.REASONS) == set(Reason)
    assert set(said.HEADINGS) == set(GROUPS)
    assert MARGIN == 100


def test_bad_names_are_refused() -> None:
    with pytest.raises(ValueError, match=r"no method 'cpdy'.*did you mean cpdi"):
        run("cpdy")
    with pytest.raises(ValueError, match="no material"):
        run("cpdi", "steel")


def test_the_numbers_of_states_that_are_told() -> None:
    """docs/exact.md counts the trial stresses with equal principal stresses, and tells the strains of the sand."""
    text = " ".join((TOP / "docs/exact.md").read_text().split())
    material = create(MATERIALS, "mohr_coulomb")
    sigma, D = plastic.states(driver.Subject(material), surfaces(material))
    trial = np.linalg.eigvalsh(plastic.whole(sigma + driver.elastic(material.lam, material.mu, D)))[plastic.COUNT :]
    same = (np.diff(trial, axis=1) < 1e-12 * np.abs(trial).max()).sum(axis=1)
    two, three = (int((same == count).sum()) for count in (1, 2))
    assert f"Of {len(D)} steps" in text
    assert (
        f"{len(trial)} from an isotropic stress, with two equal principal trial stresses in {two} and three in {three}"
        in text
    )
    sand = create(MATERIALS, "ubcsand")
    start, strains = hardening.states(sand)
    s = -start.sigma[:, :2].sum(axis=1) / 2
    most = np.abs(strains).max(axis=(1, 2)) * sand.KGe * sand.Pa * (s / sand.Pa) ** sand.ne / s
    assert most.max() == pytest.approx(1e-4, rel=0.02)
    assert f"{len(s)} steps of strains up to 10⁻⁴ s/G" in text
