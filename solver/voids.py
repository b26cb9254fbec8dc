"""Void-strain memory: cohesionless grains that have parted carry no stress until they touch again.

At the apex the material is free of stress and opens: the volume strain of that opening is the void strain. While it is
above zero, strain increments change it and nothing else; the increment that closes it acts from contact on alone.
Without that memory a material in rate form builds up pressure as soon as it is compressed, however far its grains have
been apart, and a particle that came back from a thousandfold volume would do so with V = J V0. After the volume
correction of Tampubolon et al. 2017, doi:10.1145/3072959.3073651, for materials that are functions of F.
"""

from dataclasses import replace
from typing import Any

from mpm_verify.solver._jit import kernel


@kernel(inline=True)
def close_void(b, de, void):
    """Take from the strain increment of particle b what its void strain takes up; return the void strain left."""
    volume = de[3 * b] + de[3 * b + 1]
    total = void + volume
    contact = 0.0 if total >= 0.0 else total / volume  # fraction of the increment that comes after it; NaN goes on
    de[3 * b] *= contact
    de[3 * b + 1] *= contact
    de[3 * b + 2] *= contact
    return total if total >= 0.0 else 0.0


def check_void(void: float, c: float) -> None:
    """Raise ValueError unless `void` is 0 or 1, and 0 with cohesion c."""
    if void not in (0, 1):
        raise ValueError(f"void = {void} must be 0 or 1")
    if void and c:
        raise ValueError(f"void=1 must have c = 0: what has cohesion does not part at the apex, not c = {c}")


def remembering(material: Any) -> Any:
    """Material with void-strain memory, where it has one and no cohesion; itself otherwise."""
    return replace(material, void=1.0) if "void" in material.memory and not material.cohesion else material
