"""All exact tests of a method and a material; `run` is what a campaign calls."""

from importlib import import_module

from mpm_verify.cases.exact.tested import Tested

# Tests of each group, a file of this folder with `tests(subject)`.
GROUPS = {
    "weights": ("moments", "positive", "domain_moment", "domain_area", "shared_corners", "sum_mass", "sum_momentum",
                "sum_force", "virtual_work"),
    "motion": ("fall", "throw_damped_local", "throw_damped_objective", "oscillator_local", "oscillator_objective"),
    "walls": ("slide", "no_force_free", "no_force_roller", "no_force_fixed"),
    "step": ("step", "affine", "domain_motion"),
    "symmetry": ("mirror", "quarter_turn"),
    "stress": ("stress", "stress_turned", "rigid_turn", "turned_path", "increment", "constants",
               "wave_speed"),
    "history": ("history_sums", "plastic_volume", "plastic_shear", "strength", "cut_off"),
    "smoothing": ("smoothing_means", "smoothing_constants", "smoothing_adjoint", "smoothing_twice", "smoothing_parts",
                  "smoothing_uniform", "smoothing_ratio"),
    "state": ("restart", "step_limit", "stable_step"),
}  # fmt: skip


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
    from mpm_verify.cases.exact.body import Subject

    subject = Subject(method, material)
    subject.check()
    groups = [import_module(f"mpm_verify.cases.exact.{group}") for group in GROUPS]
    return tuple(one for group in groups for one in group.tests(subject))


def group_of(test: str) -> str:
    """Group of a test."""
    return next(group for group, names in GROUPS.items() if test in names)
