"""All exact tests of a method and a material; `run` is what a campaign calls."""

from mpm_verify.cases.exact import (
    edges,
    friction,
    large,
    motion,
    smoothed,
    smoothing,
    state,
    step,
    symmetry,
    unusual,
    walls,
    weights,
)
from mpm_verify.cases.exact.body import Subject
from mpm_verify.cases.exact.groups import GROUPS
from mpm_verify.mms.constitutive import driver, hardening, history, plastic, rates, stress
from mpm_verify.mms.constitutive.tested import Tested

GRID = {
    "weights": weights.tests,
    "large": large.tests,
    "motion": motion.tests,
    "walls": walls.tests,
    "friction": friction.tests,
    "step": step.tests,
    "edges": edges.tests,
    "symmetry": symmetry.tests,
    "smoothing": smoothing.tests,
    "smoothed": smoothed.tests,
    "state": state.tests,
    "unusual": unusual.tests,
}
POINT = {
    "stress": stress.tests,
    "history": history.tests,
    "plastic": plastic.tests,
    "hardening": hardening.tests,
    "rates": rates.tests,
}  # of the constitutive model alone


def run(method: str = "cpdi", material: str = "neo_hookean") -> tuple[Tested, ...]:
    """Test a method with a material.

    Parameters
    ----------
    method, material
        Specifications, `name` or `name:key=value`, or a user's file.

    Returns
    -------
    tuple of Tested
        One for each test and each transfer and stress update; those that are not promised have a `reason`. A run that
        comes to an end in a test is its failure; what else the solver raises is raised here.

    Raises
    ------
    ValueError
        For a method or material that is not there.
    """
    subject = Subject(method, material)
    subject.check()
    return tuple(one for group in GROUPS for one in tested(group, subject))


def tested(group: str, subject: Subject) -> list[Tested]:
    """Tests of a group."""
    return GRID[group](subject) if group in GRID else POINT[group](driver.Subject(subject.material))
