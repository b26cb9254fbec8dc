"""Sentences about frame indifference: what came out, and what one should know of each part."""

from collections.abc import Mapping
from typing import Any

from mpm_verify.cases.objectivity.findings import ObjectivityRemark as Code
from mpm_verify.reports.sentences.numbers import percent, span
from mpm_verify.reports.sentences.remarks import Words, missed, unread

Numbers = Mapping[str, Any]


def turns(n: Numbers) -> str:
    """Sentence for a study whose checks all pass."""
    return (
        "The stress of the block turns with it: horizontal and vertical stress swap, and the shear stress in the axes "
        f"of the laboratory reaches {n['peak']:.3f} of the vertical stress at 45 degrees, where the closed form has "
        f"{n['exact']:.3f}. All {n['controls']:g} negative controls are seen, the formulas as printed in the "
        f"paper among them; but {n['unseen']:g} of them not in Figure 2."
    )


def swap(n: Numbers) -> str:
    """Paragraph on what Figure 2 is, and the largest shear stress."""
    return (
        "Gravity grows for one second and the block is compressed between rollers; then box, block and gravity turn by "
        "90 degrees in another. The closed form is the stress at the end of the ramp turned with the block: horizontal "
        "and vertical stress swap, and in between the shear stress in the axes of the laboratory rises to "
        f"{n['exact']:.3f} of the vertical stress, at 45 degrees; the small block reaches {n['peak']:.3f}. The stress "
        "swaps because gravity turns with the block. Under a fixed gravity the turned block would still press on what "
        "is below it, and nothing would swap."
    )


def co_rotated(n: Numbers) -> str:
    """Paragraph on where the paper's sentence on shear stresses holds."""
    return (
        "The paper says that the small shear stresses which are generated quickly dissipate. That holds for the "
        "co-rotated components, the stress as the turning block sees it: the mean shear stress of the printed block "
        f"rises to {percent(n['early'])} of the vertical stress as the turn begins and is {percent(n['end'])} at its "
        "end. It cannot hold for the components in fixed axes: a code that shows small shear stresses there at 45 "
        "degrees has not turned the stress."
    )


def inertia(n: Numbers) -> str:
    """Paragraph on what is inertia, and what is the grid's."""
    return (
        f"A turn of 90 degrees in a second is not slow for a block of {n['L']:g} m: ω² L / g is {n['fraction']:.2g}. "
        f"On average over the turn the mean vertical stress misses its static value by {percent(n['printed'])}; the "
        "same box at rest, with the centrifugal and Coriolis forces of the turning box, misses it by "
        f"{percent(n['rest'])}. So the miss is inertia, and not a rotation gone wrong. A block of a hundredth of the "
        f"size, whose inertial fraction is {percent(n['small_fraction'])}, misses by {percent(abs(n['small']))}, which "
        "is the grid's."
    )


def ripple(n: Numbers) -> str:
    """Paragraph on the block's own vibration."""
    return (
        f"The ripple is the block's own vibration, of period 4 L / c = {n['period']:.2g} s; the ramp starts it, only "
        "the grid damps it, and its size falls with the block's. Linear waves in a column under growing gravity give "
        f"it in closed form, the thin line in the figure of the block of {n['L']:g} m."
    )


def particles(n: Numbers) -> str:
    """Paragraph on what single particles see."""
    return (
        f"Single particles see co-rotated shear stresses of up to {percent(n['largest'])}, at any size: a linear "
        "stress is held by particles of constant stress, and what that misses depends on how the grid lies. It falls "
        "with the cell size, and the mean does not see it."
    )


def controls(n: Numbers) -> str:
    """Paragraph on the controls that Figure 2 cannot see, with the order at which a turn with strain shows them."""
    text = (
        "A negative control is a rate that is wrong, kept to be seen failing; it can be run as the rate of any "
        "material in rate form."
    )
    if not n:
        return f"{text} Figure 2 sees all of them."
    orders = span(min(n.values()), max(n.values()))
    return (
        f"{text} Figure 2 cannot see all of them. The block is not strained while it turns, so D may stand in any "
        f"frame: those that leave D where it was ({', '.join(n)}) give the right figure. They show in a turn with "
        f"strain, with an order of {orders}. And a frame that stretches (stretched_frame) depends on the strain at "
        "which the block is turned."
    )


def printed(n: Numbers) -> str:
    """Paragraph on the formulas of the paper."""
    return (
        "The formulas as printed, FᵀσF at both ends, do not reproduce Figure 2: they miss it by up to "
        f"{percent(n['miss'])} of the vertical stress. The shear stress flickers and quickly dies out, and so do the "
        "normal stresses, which the paper's figure keeps. So they are a slip of the pen, or the figure was made "
        "otherwise."
    )


def orders(n: Numbers) -> str:
    """Paragraph on the orders of the rates, and what costs one."""
    return (
        "F(t) = R(π t/2) diag(1 - t/5, 1), t from 0 to 1: the body is compressed along its own axis while it turns. "
        f"Rates are of second order ({span(n['least'], n['most'])} here). D in the frame of either end of the "
        "step, or added as it is, costs an order; a wrong rotation of the stress converges to a wrong stress."
    )


def not_unique(n: Numbers) -> str:
    """Paragraph on how near the rates are to each other."""
    return (
        f"F = [[1, g], [0, 1]] with the rate of sigma = 2 G D: all {n['rates']:g} rates are objective, and they give "
        "different stresses once rotation is large. Jaumann oscillates, Truesdell grows with the square, the "
        "logarithmic rate returns 2 G times the deviator of the logarithmic strain. At a shear of "
        f"{n['shear']:g} their shear stresses are within {percent(n['spread'])} of each other. A verification of "
        "objectivity does not choose between them."
    )


REMARKS: dict[str, Words] = {
    Code.TURNS: turns,
    Code.MISSED: missed,
    Code.SWAP: swap,
    Code.CO_ROTATED: co_rotated,
    Code.INERTIA: inertia,
    Code.RIPPLE: ripple,
    Code.PARTICLES: particles,
    Code.CONTROLS: controls,
    Code.PRINTED: printed,
    Code.ORDERS: orders,
    Code.INCREMENT: lambda n: (
        "The strain increment is (F1 - F0) ((F0 + F1)/2)⁻¹. With F0 alone instead of the mean, which is what a "
        "velocity gradient in the old configuration gives, every rate is of first order: each step by an angle a adds "
        "a volume strain of −a²."
    ),
    Code.NOT_UNIQUE: not_unique,
    Code.UNREAD: unread,
    Code.PAPER: lambda n: "paper",
    Code.UNIT_SQUARE: lambda n: "paper: unit square; the small block is a hundredth of it",
    Code.GROWN: lambda n: "paper, section 3; grown from 0 in the first second",
    Code.TABLE_1: lambda n: "not given; that of the paper's Table 1",
    Code.NOT_GIVEN: lambda n: "not given",
    Code.END_OF_RAMP: lambda n: "mean vertical stress at the end of the ramp, rho0 g L / 2",
    Code.OF_THE_SMALL: lambda n: "of the small block a hundredth of it",
}
