"""Void-strain memory: grains that have parted carry no stress until they touch again.

At the apex the material is free of stress and opens: the volume strain of that opening is the void strain. While it is
above zero, strain increments change it and nothing else; the increment that closes it acts from contact on alone.
Without that memory a material in rate form builds up pressure as soon as it is compressed, however far its grains have
been apart, and a particle that came back from a thousandfold volume would do so with V = J V0. So it is of soil with
cohesion that a tension cut-off at zero lets part in all directions of the plane; a crack, one of them, stays plastic
and does not close. After the volume correction of Tampubolon et al. 2017,
doi:10.1145/3072959.3073651, for materials that are functions of F.
"""

from dataclasses import replace
from typing import Any

from mpm_verify.solver._jit import kernel


@kernel(inline=True)
def close_void(b, de, void):
    """Take from the strain increment of particle b what its void strain takes up; return the void strain left.

    What rounding left below zero is no void.
    """
    if void < 0.0:
        return 0.0
    volume = de[3 * b] + de[3 * b + 1]
    total = void + volume
    contact = 0.0 if total >= 0.0 else total / volume  # fraction of the increment that comes after it; NaN goes on
    de[3 * b] *= contact
    de[3 * b + 1] *= contact
    de[3 * b + 2] *= contact
    return total if total >= 0.0 else 0.0


def parts_free(c: float, sigma_t: float | None) -> bool:
    """Whether soil of cohesion c with the tension cut-off sigma_t, None for none, parts with no stress left."""
    return not c or sigma_t == 0


def check_void(void: float, c: float, sigma_t: float | None = None) -> None:
    """Raise ValueError unless `void` is 0 or 1, and 0 where soil parts under tension."""
    if void not in (0, 1):
        raise ValueError(f"void = {void} must be 0 or 1")
    if void and not parts_free(c, sigma_t):
        held = "" if sigma_t is None else f" or sigma_t = 0, not sigma_t = {sigma_t}"
        raise ValueError(f"void=1 must have c = 0{held}: what holds tension does not part free of it, c = {c}")


def remembering(material: Any) -> Any:
    """Material with void-strain memory, where it has one and parts free of stress; itself otherwise."""
    free = "void" in material.memory and parts_free(material.cohesion, getattr(material, "sigma_t", None))
    return replace(material, void=1.0) if free else material
