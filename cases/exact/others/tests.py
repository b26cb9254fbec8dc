"""Motions of the tests of somebody else's solver, by name."""

from dataclasses import dataclass

from mpm_verify.cases.exact.others.motion import Matrix, Motion, Vector


@dataclass(frozen=True)
class Case:
    """Case: its motion, and which state is put on the particles."""

    motion: Motion
    state: str = ""


STRAINED: Matrix = ((1.06, 0.17), (-0.08, 0.97))
RATE: Matrix = ((0.008, 0.012), (-0.009, -0.005))
DRIFT: Vector = (0.03, 0.02)
PULL: Vector = (0.0113, -0.0297)
ANGLE = 0.012  # of the turn in a step
FEW = (6, 5)  # cells of a body of which all particles are judged


def product(one: Matrix, other: Matrix) -> Matrix:
    """Product of two matrices."""
    (a, b), (c, d) = one
    (e, f), (g, h) = other
    return (a * e + b * g, a * f + b * h), (c * e + d * g, c * f + d * h)


SPIN: Matrix = ((0.0, -ANGLE), (ANGLE, 0.0))
TURNING = product(SPIN, STRAINED)
CASES = {
    "translate": Case(Motion(V=(0.3137, -0.2293), cells=FEW, steps=12)),
    "throw": Case(Motion(V=(0.2137, -0.1193), G=PULL, cells=FEW, steps=12)),
    "throw_growing": Case(Motion(V=(0.2137, -0.1193), G=PULL, J=(0.004, 0.006), cells=FEW, steps=12)),
    "sums": Case(Motion(F=STRAINED, V=DRIFT, G=PULL, cells=FEW, steps=8), "shaken"),
    "keep": Case(Motion(V=DRIFT, cells=FEW), "kept"),
    "rest": Case(Motion(F=STRAINED)),
    "affine_unstrained": Case(Motion(M=RATE, V=DRIFT)),
    "affine_strained": Case(Motion(F=STRAINED, M=RATE, V=DRIFT)),
    "turn": Case(Motion(F=STRAINED, M=TURNING, A=product(SPIN, TURNING), V=DRIFT)),
    "force": Case(Motion(F=STRAINED, A=((0.006, 0.01), (-0.008, 0.004)), G=PULL)),
    "divergence_x": Case(Motion(), "graded_x"),
    "divergence_y": Case(Motion(), "graded_y"),
    "path_shear": Case(Motion(F=((1.0, 0.6), (0.0, 1.0)), M=RATE)),
    "path_press": Case(Motion(F=((0.57, -0.58), (0.48, 0.69)), M=RATE)),
    "path_stretch": Case(Motion(F=((0.64, 1.13), (-1.25, 0.21)), M=RATE)),
}
