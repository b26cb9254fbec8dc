"""Defects of edges that are pulled or driven, planted one at a time in solver/surface.py."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from mpm_verify.solver.surface import Surface

Patch = pytest.MonkeyPatch


def made(change: Callable[[Any], None]) -> Callable[[Patch], None]:
    """Surface that is changed once it is made."""
    original = Surface.__post_init__

    def plant(patch: Patch) -> None:
        def begin(self: Any) -> None:
            original(self)
            change(self)

        patch.setattr(Surface, "__post_init__", begin)

    return plant


def normal_inwards(surface: Any) -> None:
    surface.N = -surface.N


def tangent(surface: Any) -> None:
    surface.N = surface.N[:, ::-1].copy()


def last_face_skipped(surface: Any) -> None:
    surface.area[-2:] = 0.0


def deformed_area(patch: Patch) -> None:
    """P N on the area that the edge has now."""
    original = Surface.traction

    def traction(self: Any, model: Any) -> Any:
        F = model.particles.F[np.repeat(self.rows(model.particles), 2)]
        J, back = np.linalg.det(F), np.linalg.inv(F)
        cofactor = J[:, None] * np.einsum("sba,sb->sa", back, self.N)
        return original(self, model) * np.hypot(*cofactor.T)[:, None]

    patch.setattr(Surface, "traction", traction)


def late(patch: Patch) -> None:
    """Data of the edge of the step before."""
    original = Surface.traction

    def traction(self: Any, model: Any) -> Any:
        model.steps -= 1
        found = original(self, model)
        model.steps += 1
        return found

    patch.setattr(Surface, "traction", traction)


def points_stay(patch: Patch) -> None:
    patch.setattr(Surface, "move", lambda self, model: None)


def corners_swapped(patch: Patch) -> None:
    """Each point nearer to the corner that it is farther from."""
    original = Surface.at_corners

    def at_corners(self: Any, model: Any, force: Any) -> Any:
        return original(self, model, np.ascontiguousarray(force.reshape(-1, 2, 2)[:, ::-1].reshape(-1, 2)))

    patch.setattr(Surface, "at_corners", at_corners)


def first_order_of_rows(patch: Patch) -> None:
    """Boundary particles by their rows in the initial layout, whatever order they are in now."""
    patch.setattr(Surface, "rows", lambda self, particles: self.faces.particle)


EDGES = {  # what is planted, and the tests that have to see it
    "edge normal inwards": (made(normal_inwards), ("edge_sums", "edge_pulled", "edge_driven", "edge_affine")),
    "edge normal of x and y swapped": (made(tangent), ("edge_sums", "edge_pulled", "edge_affine")),
    "a face of the edge skipped": (made(last_face_skipped), ("edge_sums", "edge_pulled")),
    "traction on the deformed area": (deformed_area, ("edge_sums", "edge_pulled")),
    "edge a step late": (late, ("edge_sums", "edge_driven", "edge_affine")),
    "points of the edge stay": (points_stay, ("edge_driven",)),
    "corners of a face swapped": (corners_swapped, ("edge_sums",)),
    "rows of the first order": (first_order_of_rows, ("edge_sums", "edge_pulled")),
}
