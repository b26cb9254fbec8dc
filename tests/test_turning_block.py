"""The block in a box that turns: the box alone, the block without load, and the run against its closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from mpm_verify.cases.objectivity.exact import ramped_column, turn
from mpm_verify.cases.objectivity.turning_block import (
    OMEGA,
    RAMP,
    Block,
    Box,
    angle_at,
    execute,
    setup,
    spin,
)
from mpm_verify.solver.state import Particles
from mpm_verify.solver.step import advance

BLOCK = Block()


def unloaded(particles: Particles, t: float) -> None:
    """No gravity: what strains the block is its own inertia."""
    particles.b[:] = 0.0


def static(block: Block) -> tuple[float, float]:
    """Mean horizontal and vertical stress over |sigma_v| at the end of the ramp."""
    return -block.nu / (1 - block.nu), -1.0


def test_the_box_is_aligned_before_and_after() -> None:
    """Its walls are the nodes on and behind three sides; after a quarter turn, on and behind the turned ones."""
    model = setup(BLOCK)
    nodes, box = model.grid.nodes, Box(1.0, 0.125, True)
    start, end = box.reaches(nodes, 0.0), box.reaches(nodes, np.pi / 2)
    slack = 1e-9
    np.testing.assert_array_equal(start[:, 0], nodes[:, 0] < slack)
    np.testing.assert_array_equal(start[:, 1], nodes[:, 0] > 1 - slack)
    np.testing.assert_array_equal(start[:, 2], nodes[:, 1] < slack)
    np.testing.assert_array_equal(end[:, 2], nodes[:, 0] > 1 - slack)  # the bottom has come to the right
    np.testing.assert_array_equal(end[:, 1], nodes[:, 1] > 1 - slack)


@pytest.mark.parametrize("angle", [0.0, 0.3, np.pi / 4, 1.2])
def test_no_free_node_reaches_beyond_a_wall(angle: float) -> None:
    """Corners of the hat's square that lie behind a wall make the node the wall's, and no others do."""
    model = setup(BLOCK)
    dx, nodes = model.grid.dx, model.grid.nodes
    corners = nodes[:, None] + dx * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
    own = (corners - 0.5) @ turn(angle) + 0.5
    slack = 1e-6
    behind = (own[..., 0] < -slack) | (own[..., 0] > 1 + slack) | (own[..., 1] < -slack)
    np.testing.assert_array_equal(Box(1.0, dx, True).reaches(nodes, angle).any(axis=1), behind.any(axis=1))


def turned_without_load(block: Block) -> tuple[float, float, float]:
    """Distance of positions from the rotation at the end of a quarter turn, and of F, in the median and at most."""
    model = setup(block)
    for step in range(1, 2 * block.steps + 1):
        if step == block.steps + 1:
            spin(model, block)
        advance(model, unloaded)
    p, Q = model.particles, turn(np.pi / 2)
    F = np.abs(p.F - Q).max(axis=(1, 2))
    return float(np.abs(p.x - (p.X - 0.5) @ Q.T - 0.5).max()), float(np.median(F)), float(F.max())


def test_without_load_the_block_turns_about_its_middle_without_strain() -> None:
    """Inertia alone strains it, by up to rho w^2 L^2 / M, and so a hundred times less with a hundredth of the density.

    At the free edge the error is of another kind: nodes beyond it take the velocity of the particles inside, as lumped
    mass does, and not that of the rotation.
    """
    for rho0 in (2650.0, 26.5):
        bound = rho0 * OMEGA**2 / BLOCK.E
        positions, median, largest = turned_without_load(replace(BLOCK, rho0=rho0))
        assert positions < 0.25 * bound
        assert bound / 100 < median < 0.5 * bound
        assert largest < 0.01


def test_the_printed_block_swaps_its_stresses() -> None:
    """Within what inertia and its own vibration allow; the shear stress is that of the closed form, not small."""
    block = Block()
    curves, failed = execute(block)
    assert not failed
    mean = curves["mean"]
    horizontal, vertical = static(block)
    assert mean["t"][-1] == pytest.approx(2.0)
    assert mean["xx"][-1] == pytest.approx(vertical, abs=0.05)
    assert mean["yy"][-1] == pytest.approx(horizontal, abs=0.05)
    assert mean["xy"].max() == pytest.approx((horizontal - vertical) / 2, abs=0.02)
    late = mean["t"] > RAMP
    own = np.abs(mean["own_xy"][late])  # generated as the turn begins, gone when it ends
    assert 0.01 < own[: len(own) // 4].max() < 0.02
    assert own[-len(own) // 4 :].max() < 0.002
    np.testing.assert_allclose(mean["zz"], mean["own_xx"], atol=0.02)


@pytest.mark.slow
def test_a_smaller_block_is_closer_and_the_rest_is_inertia() -> None:
    """The mean vertical stress misses by the inertial fraction, which the same box at rest shows without any turn."""
    away = {}
    for name, block in (("turned", Block()), ("at rest", Block(frame=True)), ("small", Block(L=0.25))):
        mean = execute(block)[0]["mean"]
        away[name] = mean["own_yy"][mean["t"] > RAMP].mean() + 1
    assert 0.01 < away["turned"] < 0.02
    assert away["at rest"] == pytest.approx(away["turned"], abs=0.002)
    assert abs(away["small"]) < 0.4 * away["turned"]


def test_a_wrong_rate_is_seen() -> None:
    """The same rotation at both ends leaves the stress where it was."""
    mean = execute(Block(rate="same_rotation"))[0]["mean"]
    assert mean["yy"][-1] == pytest.approx(-1.0, abs=0.1)
    assert np.abs(mean["xy"]).max() < 0.1


def test_angles() -> None:
    assert angle_at(0.5) == 0
    assert angle_at(1.5) == pytest.approx(np.pi / 4)
    assert Block().inertial_fraction == pytest.approx(0.2467, rel=1e-3)
    assert Block(L=0.01).inertial_fraction == pytest.approx(0.002467, rel=1e-3)


@pytest.mark.parametrize(("cells", "ppc"), [(3, 4), (200, 4), (8, 5), (8, 0)])
def test_no_such_block(cells: int, ppc: int) -> None:
    with pytest.raises(ValueError, match=r"must be from 4 to 128|is not a square number"):
        Block(cells=cells, ppc=ppc)


def test_the_ripple_of_the_ramp_is_the_blocks_own_vibration() -> None:
    """The closed form meets the initial conditions and the run; the static line is 4 % off, the wave 0.2 %."""
    t = np.array([0.0, 1e-3])
    wave = ramped_column(t, 16.0, 1.0)
    assert wave[0] == 0
    assert wave[1] == pytest.approx(-(16.0**2) * t[1] ** 3 / 3, rel=1e-3)  # the top still falls freely, by g t^3 / 6
    assert ramped_column(np.array([1.0]), 1e4, 1.0)[0] == pytest.approx(-1, abs=1e-3)
    block = Block()
    mean = execute(block)[0]["mean"]
    ramp = mean["t"] <= RAMP
    exact = ramped_column(mean["t"][ramp], block.material.wave_speed(), block.L)
    assert np.abs(mean["yy"][ramp] - exact).max() < 0.003
    assert np.abs(mean["yy"][ramp] + mean["t"][ramp]).max() > 0.03
