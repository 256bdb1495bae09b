"""Particles that fill solids and samples that cover surfaces."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from sim.geometry.solids import BoxSolid, SheetSolid, Solid
from sim.settings import Refused

if TYPE_CHECKING:
    import trimesh

# Lattice points tried, or samples placed, beyond which memory runs out long before a film would be done.
_MOST_POINTS = 500_000_000
# Share of the spacing by which an edge may miss a multiple of it: lengths are typed with few digits.
_EDGE_TOLERANCE = 1e-3


def sample_volume(solid: Solid, spacing: float) -> np.ndarray:
    """Particle positions [m], shape [n, 3], that fill a solid with one particle a cube of `spacing` [m].

    A cubic lattice, centred in the solid: along the edges of a box, which it fills with as many whole layers as fit
    (the first half a spacing from the face), and along the world's axes in the bounding box of any other shape, of
    which the points inside are kept. n spacing^3 is then the volume of a box whose edges are multiples of the
    spacing, and converges to the volume of other shapes. Sorted by x, then y, then z (of the box's own frame).

    Raises `Refused` for a shape without volume, one in which not a single particle fits, or too many points.
    """
    if not solid.closed or not math.isfinite(solid.volume):
        raise Refused(
            "the shape has no volume to fill",
            remedy="Use a closed shape: box, sphere, cylinder, capsule, torus or a closed mesh",
        )
    if isinstance(solid, BoxSolid):
        layers = np.floor(solid.size * solid.pose.scale / spacing + _EDGE_TOLERANCE)
        _check_number(float(layers.prod()), spacing)
        centred = [(np.arange(int(number)) - (number - 1) / 2) * spacing for number in layers]
        points = np.stack(np.meshgrid(*centred, indexing="ij"), axis=-1).reshape(-1, 3)
        points = points @ solid.pose.rotation.T + solid.pose.position
    else:
        low, high = solid.bounds
        layers = np.maximum(1, np.ceil((high - low) / spacing - _EDGE_TOLERANCE))
        _check_number(float(layers.prod()), spacing)
        shape = tuple(int(number) for number in layers)
        origin = (low + high) / 2 - (layers - 1) / 2 * spacing
        points = origin + spacing * np.argwhere(solid.contains_lattice(origin, spacing, shape))
    if len(points) == 0:
        raise Refused(
            f"no particle fits into the shape: it is thinner than the spacing of {spacing:.4g} m",
            remedy="Make the shape larger or the particle radius smaller",
        )
    return points


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
    _check_number(float(2 * (steps[0] * steps[1] + steps[1] * steps[2] + steps[2] * steps[0])), spacing)
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
    _check_number(float(steps.prod()), spacing)
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

    _check_number(topology.surface_area(mesh) / spacing**2, spacing)
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    stored = cache.cached(
        "scatter",
        lambda: {"points": scatter.scatter(mesh, spacing)},
        arguments={"spacing": spacing},
        arrays=[vertices, faces],
        sources=[module.__file__ for module in (scatter, distance, thinning)],
    )
    return stored["points"]


def _check_number(number: float, spacing: float) -> None:
    if not spacing > 0:
        raise ValueError(f"spacing must be positive, got {spacing}")
    if number > _MOST_POINTS:
        raise Refused(
            f"{number:.3g} points at a spacing of {spacing:.4g} m are more than memory holds",
            remedy="Make the particle radius larger or the shape smaller",
        )
