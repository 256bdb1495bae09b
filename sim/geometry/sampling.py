"""Samples that cover surfaces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sim.geometry.solids import BoxSolid, SheetSolid, Solid
from sim.settings import Refused

if TYPE_CHECKING:
    import trimesh

# Lattice points tried, or samples placed, beyond which memory runs out long before a film would be done.
_MOST_POINTS = 500_000_000


def sample_surface(surface: trimesh.Trimesh | Solid, spacing: float) -> np.ndarray:
    """Samples of a surface [m], shape [n, 3], about one in every spacing^2 [m^2], for Akinci boundaries (2012).

    Boxes and sheets are covered by a lattice with their edges and corners, whose step along each edge divides it and
    is at most 1.2 spacings. Other surfaces, open ones too, get a relaxed Poisson-disk set (`sim.geometry.scatter`)
    with samples on their sharp edges; it is deterministic and kept in the cache.

    Raises `Refused` for a plane, which has no end, and for too many points.
    """
    if isinstance(surface, BoxSolid):
        return _lattice_on_box(surface, spacing)
    if isinstance(surface, SheetSolid):
        return _lattice_on_sheet(surface, spacing)
    mesh = surface.mesh if isinstance(surface, Solid) else surface
    if mesh is None:
        raise Refused("a plane has no end: it can not be sampled", remedy="Use a box, or an analytic wall")
    return _scattered(mesh, spacing)


def _lattice_on_box(box: BoxSolid, spacing: float) -> np.ndarray:
    size = box.size * box.pose.scale
    steps = np.array([_steps(length, spacing) for length in size])
    check_number(float(2 * (steps[0] * steps[1] + steps[1] * steps[2] + steps[2] * steps[0])), spacing)
    sides = []
    for axis in range(3):
        others = [other for other in range(3) if other != axis]
        grid = np.stack(np.meshgrid(*(np.arange(steps[other] + 1) for other in others), indexing="ij"), axis=-1)
        for level in (0, steps[axis]):
            side = np.full((*grid.shape[:2], 3), level)
            side[..., others] = grid
            sides.append(side.reshape(-1, 3))
    index = np.unique(np.concatenate(sides), axis=0)
    return ((index / steps - 0.5) * size) @ box.pose.rotation.T + box.pose.position


def _lattice_on_sheet(sheet: SheetSolid, spacing: float) -> np.ndarray:
    size = sheet.size * sheet.pose.scale
    steps = np.array([_steps(length, spacing) for length in size])
    check_number(float(steps.prod()), spacing)
    grid = np.stack(np.meshgrid(*(np.arange(number + 1) for number in steps), indexing="ij"), axis=-1).reshape(-1, 2)
    flat = (grid / steps - 0.5) * size
    points = np.column_stack([flat[:, 0], np.zeros(len(flat)), flat[:, 1]])
    return points @ sheet.pose.rotation.T + sheet.pose.position


def _steps(length: float, spacing: float) -> int:
    """Equal steps along an edge, nearest to the spacing but at most 1.2 of it."""
    number = max(1, round(length / spacing))
    return number if length / number <= 1.2 * spacing else number + 1


def _scattered(mesh: trimesh.Trimesh, spacing: float) -> np.ndarray:
    from sim.geometry import cache, distance, scatter, thinning, topology

    check_number(topology.surface_area(mesh) / spacing**2, spacing)
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    stored = cache.cached(
        "scatter",
        lambda: {"points": scatter.scatter(mesh, spacing)},
        arguments={"spacing": spacing},
        arrays=[vertices, faces],
        sources=[module.__file__ for module in (scatter, distance, thinning)],
    )
    return stored["points"]


def check_number(number: float, spacing: float) -> None:
    """Raises `Refused` for more points than memory holds."""
    if not spacing > 0:
        raise ValueError(f"spacing must be positive, got {spacing}")
    if number > _MOST_POINTS:
        raise Refused(
            f"{number:.3g} points at a spacing of {spacing:.4g} m are more than memory holds",
            remedy="Make the particle radius larger or the shape smaller",
        )
