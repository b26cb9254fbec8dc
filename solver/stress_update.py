"""When a step updates the stress: the words, without what computes, for commands that only check them.

Velocities at the nodes are v_i before the step (n-1/2) and after it (n+1/2):

    usl   update-stress-last: F and sigma from v_i after the step, which the particles take in the same pass
    musl  modified update-stress-last: the particles' new velocities are mapped to the nodes again, F comes from those
    usf   update-stress-first: F and sigma from v_i before the step, ahead of the forces

Places, and corners of domains, move with v_i after the step in all three. In time, usl and musl have a first-order
error in the start, which a staggered one takes away. In usf the first stress is that of t = dt, and later a gradient
taken at x^n multiplies F^(n-1), so it is of first order with either start. Energy: usl damps short waves, the more the
longer the step; musl and usf conserve it, with FLIP, and so keep the noise of cell crossings too.
Source: Bardenhagen, J. Comput. Phys. 180 (2002) 383; usl and musl: Sulsky, Zhou & Schreyer, Comput. Phys. Commun. 87
(1995) 236.
"""

from typing import Literal, get_args

Stress = Literal["usl", "musl", "usf"]


def check_stress_update(word: str) -> None:
    """Raise ValueError for a word that is no order."""
    if word not in get_args(Stress):
        raise ValueError(f"no stress update {word!r}; choose from {', '.join(get_args(Stress))}")
