"""What the report says of frame indifference in plain words, with the numbers of the runs."""

from collections.abc import Mapping

from mpm_verify.cases.objectivity.turning_block import RAMP, Block
from mpm_verify.solver.state import Floats

Curve = Mapping[str, Floats]


def percent(share: float) -> str:
    """A share with two digits."""
    return f"{100 * share:.2g} %"


def plain(*paragraphs: str) -> tuple[str, ...]:
    """Paragraphs on one line each."""
    return tuple(" ".join(text.split()) for text in paragraphs)


def words(block: Block, printed: Curve, small: Curve, rest: Curve) -> dict[str, tuple[str, ...]]:
    """Paragraphs for each part of the page."""
    late = {name: curve["t"] > RAMP for name, curve in (("printed", printed), ("small", small), ("rest", rest))}
    quarter = max(1, int(late["printed"].sum()) // 4)
    early = abs(printed["own_xy"][late["printed"]][:quarter]).max()
    gone = abs(printed["own_xy"][late["printed"]][-quarter:]).max()
    local = max(float(small["shear"][late["small"]].max()), float(printed["shear"][late["printed"]].max()))
    away = [
        float(curve["own_yy"][late[name]].mean()) + 1
        for name, curve in (("printed", printed), ("rest", rest), ("small", small))
    ]
    peak = float(small["xy"].max())
    return {
        "Figure 2, the CPDI run": plain(
            f"""Gravity grows for one second and the block is compressed between rollers; then box, block and gravity
            turn by 90 degrees in another. The closed form is the stress at the end of the ramp turned with the
            block: horizontal and vertical stress swap, and in between the shear stress in the axes of the
            laboratory rises to {0.5 * (1 - block.nu / (1 - block.nu)):.3f} of the vertical stress, at 45 degrees;
            the small block reaches {peak:.3f}.""",
            f"""The paper says that the small shear stresses which are generated quickly dissipate. That holds for the
            co-rotated components, the stress as the turning block sees it: the mean shear stress of the printed
            block rises to {percent(early)} of the vertical stress as the turn begins and is {percent(gone)} at its
            end. It cannot hold for the components in fixed axes: a code that shows small shear stresses there at 45
            degrees has not turned the stress.""",
            """The stress swaps because gravity turns with the block. Under a fixed gravity the turned block would still
            press on what is below it, and nothing would swap.""",
        ),
        "Inertial share": plain(
            f"""A turn of 90 degrees in a second is not slow for a block of {block.L:g} m: ω² L / g is
            {block.share:.2g}. On average over the turn the mean vertical stress misses its static value by
            {percent(away[0])}; the same box at rest, with the centrifugal and Coriolis forces of the turning one,
            misses it by {percent(away[1])}. So the miss is inertia, and not a rotation gone wrong. A block of a
            hundredth of the size, whose share is {percent(block.share / 100)}, misses by
            {percent(abs(away[2]))}, which is the grid's.""",
            """The ripple is the block's own vibration, of period 4 L / c; the ramp starts it, only the grid damps it,
            and its size falls with the block's. Linear waves in a column under growing gravity give it in closed form,
            the thin line in the figure of the block of 1 m.""",
            f"""Single particles see co-rotated shear stresses of up to {percent(local)}, at any size: a linear stress
            is held by particles of constant stress, and what that misses depends on how the grid lies. It falls
            with the cell size, and the mean does not see it.""",
        ),
        "Negative controls": plain(
            """Each of these is wrong, is kept to be seen failing, and can be run as the rate of any law in rate
            form.""",
            """Figure 2 cannot see all of them. The block is not strained while it turns, so D may stand in any frame:
            the readings that leave D where it was (strain_start, strain_end, strain_fixed) give the right figure.
            They show in a turn with strain, at first order. And a frame that stretches (stretched_frame) depends on
            the strain at which the block is turned.""",
            """The formulas as printed, FᵀσF at both ends, do not reproduce Figure 2: the shear stress flickers
            and quickly dies out, and so do the normal stresses, which the paper's figure keeps. So they are a slip of
            the pen, or the figure was made otherwise.""",
        ),
        "Orders in time": plain(
            """F(t) = R(π t/2) diag(1 - t/5, 1), t from 0 to 1: the body is compressed along its own axis while it
            turns. Rates are of second order. D in the frame of either end of the step, or added as it is, costs an
            order; a wrong rotation of the stress converges to a wrong stress.""",
            """The strain increment is (F1 - F0) ((F0 + F1)/2)⁻¹. With F0 alone in place of the mean, which is what a
            velocity gradient in the old configuration gives, every rate is of first order: each step by an angle a
            adds a volume strain of −a².""",
        ),
        "Rates in simple shear": plain(
            """F = [[1, g], [0, 1]] with the rate of sigma = 2 G D: all four rates are objective, and they give
            different stresses once rotation is large. Jaumann oscillates, Truesdell grows with the square, the
            logarithmic rate returns 2 G times the deviator of the logarithmic strain. Up to a shear of 0.5 their
            shear stresses agree within 5 %. A verification of objectivity does not choose between them.""",
        ),
    }
