"""Stress update of a step: the words, without what computes, for commands that only check them.

Velocities at the nodes have the time levels n-1/2 before the step and n+1/2 after it:

    usl   update-stress-last: F and sigma from the velocities after the step, which the particles take in the same pass
    musl  modified update-stress-last: the particles' new velocities are mapped to the nodes again, F comes from those
    usf   update-stress-first: F and sigma from the velocities before the step, ahead of the forces

Positions, and corners of domains, move with those after the step in all three. In time all have a first-order error
in the start, which a staggered one takes away. In usf the velocities at n-1/2 take F from n-1 to n ahead of the
forces, so F and sigma have to start at -dt, and lie a step behind x after each step; with F at 0 it is of first
order. Energy: usl damps short waves, the more the longer the step; musl and usf conserve it, with FLIP, and so keep
the noise of cell crossings too.
Source: Bardenhagen 2002, doi:10.1006/jcph.2002.7103; usl and musl: Sulsky, Zhou & Schreyer 1995,
doi:10.1016/0010-4655(94)00170-7.
"""

from typing import Literal, get_args

Stress = Literal["usl", "musl", "usf"]


def check_stress_update(word: str) -> None:
    """Raise ValueError for a word that is no stress update."""
    if word not in get_args(Stress):
        raise ValueError(f"no stress update {word!r}; choose from {', '.join(get_args(Stress))}")
