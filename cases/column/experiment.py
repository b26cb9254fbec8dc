"""Experiment as bands, since its curves are not at hand and its scaling is quoted in two forms.

Lube, Huppert, Sparks & Freundt, Phys. Rev. E 72 (2005) 041301 and Phys. Fluids 19 (2007) 043301: dry grains in a
channel, collapsing to one side. For tall columns, a = h0/d0 above 3, the run-out (d - d0)/d0 grows as a^(2/3).
Secondary texts quote its factor as 1.9 (four of them, not independent of each other) and as 2.2 (one); the band is
between them. The height of the deposit at the wall is d0 a^(2/5), and d0 a^(1/3) in the similar experiments of
Lajeunesse et al. (Phys. Fluids 17 (2005) 103302). Grains stop after 2.5 to 3.3 sqrt(h0/g). Side walls of glass and
the time that a gate takes are in these numbers and not in a run in plane strain. No primary text was at hand.
"""

from dataclasses import dataclass

from mpm_verify.cases.column.run import ColumnRun

ASPECTS = 3.0, 9.5  # of the columns that were measured
Band = tuple[float, float]


@dataclass(frozen=True)
class Experiment:
    """Bands of the front at rest and of the height at the wall [m], and of the time of rest in sqrt(h0/g)."""

    front: Band
    height: Band
    rest: Band = (2.5, 3.3)


def experiment(run: ColumnRun) -> Experiment | None:
    """Bands of the experiment for a column of this width and aspect; None beyond the aspects that were measured."""
    a, d0 = run.aspect, run.width
    if not ASPECTS[0] <= a <= ASPECTS[1]:
        return None
    front = (d0 * (1 + 1.9 * a ** (2 / 3)), d0 * (1 + 2.2 * a ** (2 / 3)))
    return Experiment(front, (d0 * a ** (1 / 3), d0 * a**0.4))
