"""Groups of exact tests by name; light, for whoever shows what is stored."""

# Tests of each group; a group is a file of this folder, or of mms/constitutive, with `tests(subject)`.
GROUPS = {
    "weights": ("moments", "positive", "domain_moment", "domain_area", "shared_corners", "sum_mass", "sum_momentum",
                "sum_force", "virtual_work"),
    "large": ("wall_moments", "wide_moments", "domain_reach", "far_work"),
    "motion": ("fall", "throw_damped_local", "throw_damped_objective", "oscillator_local", "oscillator_objective",
               "budget"),
    "walls": ("slide", "no_force_free", "no_force_roller", "no_force_fixed", "reaction", "pushed"),
    "friction": ("friction_slide", "friction_stick", "friction_leave", "friction_course", "friction_damped",
                 "friction_momentum", "friction_budget", "friction_mirror", "friction_step"),
    "step": ("step", "affine", "domain_motion"),
    "edges": ("edge_sums", "edge_pulled", "edge_driven", "edge_affine"),
    "symmetry": ("mirror", "quarter_turn"),
    "stress": ("stress", "stress_turned", "stress_even", "rigid_turn", "turned_path", "increment", "constants",
               "wave_speed"),
    "history": ("history_sums", "plastic_volume", "plastic_shear", "strength", "cut_off", "void_contact"),
    "plastic": ("return_mapping", "return_memory"),
    "hardening": ("secant", "hardening", "flow_rule", "neutral"),
    "rates": ("rate_path", "work"),
    "smoothing": ("smoothing_means", "smoothing_constants", "smoothing_adjoint", "smoothing_twice", "smoothing_parts",
                  "smoothing_uniform", "smoothing_ratio"),
    "smoothed": ("smoothing_force", "smoothing_refused"),
    "state": ("restart", "step_limit", "stable_step"),
    "unusual": ("inverted_ends", "left_ends", "any_order", "arrays_along", "slabs", "deformation", "undamped"),
}  # fmt: skip


def group_of(test: str) -> str:
    """Group of a test."""
    return next(group for group, names in GROUPS.items() if test in names)
