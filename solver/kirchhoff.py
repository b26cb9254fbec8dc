"""Kirchhoff stress tau = J sigma in place of the Cauchy stress while a rate carries it through a step."""

from collections.abc import Iterator
from contextlib import contextmanager

from mpm_verify.solver.state import Floats, Particles


@contextmanager
def weighted(particles: Particles, convects: bool) -> Iterator[None]:
    """Hold tau in particles.sigma, and count its work, within the block that updates the stress from F_old to F.

    Parameters
    ----------
    particles
        Particles with F_old of the start of the step and F of its end.
    convects
        Whether the rate divides by the change of volume itself: then its own sigma is tau in the middle of the step,
        where the material sees it, over the volume ratio there.
    """
    p = particles
    start, end = volume(p.F_old), volume(p.F.reshape(-1, 4))
    middle = volume(0.5 * (p.F_old + p.F.reshape(-1, 4)))
    before, after = (middle, middle) if convects else (start, end)
    done = p.work.copy()
    p.sigma *= before[:, None]
    yield
    p.sigma /= after[:, None]
    p.work[:] = done + (p.work - done) / (0.5 * (start + end))[:, None]  # it took tau for a Cauchy stress


def volume(F: Floats) -> Floats:
    """Volume ratio det F (P,) of F (P,4)."""
    J: Floats = F[:, 0] * F[:, 3] - F[:, 1] * F[:, 2]
    return J
