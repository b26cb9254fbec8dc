"""Void-strain memory: cohesionless grains that have parted carry no stress until they touch again.

At the apex the law is free of stress and opens: the volume strain of that opening is the void strain. While it is above
zero, strain increments change it and nothing else; the increment that closes it acts from contact on alone. Without
that memory a law in rate form builds up pressure as soon as it is compressed, however far its grains have been apart,
and a particle that came back from a thousandfold volume would do so with V = J V0. After the volume correction of
Tampubolon et al., ACM Trans. Graph. 36 (2017) 105, for laws of F.
"""

from mpm_verify.solver._jit import kernel


@kernel(inline=True)
def close_void(b, de, void):
    """Take from the strain increment of particle b what its void strain takes up; the void strain that is left."""
    volume = de[3 * b] + de[3 * b + 1]
    total = void + volume
    share = 0.0 if total >= 0.0 else total / volume  # of the increment, that comes after contact; NaN goes on
    de[3 * b] *= share
    de[3 * b + 1] *= share
    de[3 * b + 2] *= share
    return total if total >= 0.0 else 0.0


def check_void(void: float, c: float) -> None:
    """Raises ValueError."""
    if void not in (0, 1):
        raise ValueError(f"void = {void} must be 0 or 1")
    if void and c:
        raise ValueError(f"void=1 must have c = 0: what has cohesion does not part at the apex, not c = {c}")
