"""Signed distances to a mesh on a sparse grid around its surface, for particles that meet it."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from sim.geometry import cache
from sim.geometry.distance import closest_points
from sim.geometry.meshes import winding

if TYPE_CHECKING:
    import trimesh

BLOCK = 4
"""Nodes of a block along each axis."""
OPPOSITE = -0.5
"""Cosine of the angle between two normals beyond which they belong to the two sides of a thin wall."""

TURNED = 0.5
"""The same beyond which what a node sees does not count in the mean about a point before a hollow edge. Faces that are
turned less are two (`sim.fluid.boundary.half_spaces.of_mesh.BENT`), but with that cosine shares jump twice as often
beside edges."""


@dataclass(frozen=True)
class NarrowBand:
    """Nodes `cell` [m] apart, in blocks of BLOCK^3 of them; node (0, 0, 0) of block (0, 0, 0) is at `low` [m].

    table: where in `nodes` a block begins, in blocks, or -1, shape [x, y, z];
    nodes: unit normal away from the nearest point of the surface and signed distance [m], shape [n, 4];
    curvature: mean curvature of the level set of the distance there [1/m], shape [n].
    """

    low: np.ndarray
    cell: float
    table: np.ndarray
    nodes: np.ndarray
    curvature: np.ndarray


def narrow_band(mesh: trimesh.Trimesh, cell: float, reach: float) -> NarrowBand:
    """The nodes of all cells that come within `reach` [m] of the surface of a closed mesh; kept in the cache."""
    vertices, faces = np.asarray(mesh.vertices, dtype=np.float64), np.asarray(mesh.faces)
    stored = cache.cached(
        "narrow_band",
        lambda: _measured(mesh, cell, reach),
        arguments={"cell": cell, "reach": reach},
        arrays=[vertices, faces],
        sources=[__file__, closest_points.__file__, winding.__file__],
        packages=("libigl", "numpy", "scipy", "trimesh"),
    )
    return NarrowBand(stored["low"], cell, stored["table"], stored["nodes"], stored["curvature"])


def _measured(mesh: trimesh.Trimesh, cell: float, reach: float) -> cache.Arrays:
    side = BLOCK * cell
    low = mesh.bounds[0] - reach - side
    shape = np.ceil((mesh.bounds[1] + reach + side - low) / side).astype(int)
    blocks = _near_blocks(mesh, low, side, shape, reach + cell)
    table = np.full(shape, -1, np.int32)
    table[tuple(blocks.T)] = np.arange(len(blocks))
    inner = np.array(list(itertools.product(range(BLOCK), repeat=3)))
    index = (BLOCK * blocks[:, None] + inner).reshape(-1, 3)
    points = low + cell * index
    foot, away, face = closest_points.MeshDistance(mesh).closest(points)
    outside = winding.WindingNumber(mesh).at(points) <= 0
    signed = np.where(outside, away, -away)
    on_surface = away < 1e-6 * cell
    normal = (points - foot) / np.where(on_surface, 1.0, signed)[:, None]
    normal[on_surface] = mesh.face_normals[face[on_surface]]
    nodes = np.column_stack((normal, signed)).astype(np.float32)
    return {"low": low, "table": table, "nodes": nodes, "curvature": _curvature(table, index, normal, signed, cell)}


def _near_blocks(mesh: trimesh.Trimesh, low: np.ndarray, side: float, shape: np.ndarray, reach: float) -> np.ndarray:
    """Indices of the blocks that come within `reach` [m] of the surface, shape [n, 3], in order."""
    points, _, radius = closest_points.cover(np.asarray(mesh.triangles), int(4 * mesh.area / side**2) + 1)
    within = reach + radius + np.sqrt(3) / 2 * side
    steps = int(np.ceil(within / side))
    own = np.unique(np.floor((points - low) / side).astype(int), axis=0)
    around = np.array(list(itertools.product(range(-steps, steps + 1), repeat=3)))
    candidates = np.unique((own[:, None] + around).reshape(-1, 3), axis=0)
    candidates = candidates[np.all((candidates >= 0) & (candidates < shape), axis=1)]
    nearest, _ = cKDTree(points).query(low + side * (candidates + 0.5), distance_upper_bound=within)
    return candidates[np.isfinite(nearest)]


def _curvature(table: np.ndarray, index: np.ndarray, normal: np.ndarray, signed: np.ndarray, cell: float) -> np.ndarray:
    """Half the Laplacian of the distance by central differences [1/m], shape [n].

    Across a thin wall the distance is that to its other side: what lies there counts as if the wall went on straight,
    and so does what lies beyond a hollow edge.
    """
    laplacian = np.zeros(len(index))
    most = BLOCK * np.array(table.shape)
    for axis, step in itertools.product(range(3), (-1, 1)):
        way = step * np.eye(3, dtype=int)[axis]
        beside = index + way
        inside = np.all((beside >= 0) & (beside < most), axis=1)
        block = np.where(inside, table[tuple((np.clip(beside, 0, most - 1) // BLOCK).T)], -1)
        inner = beside % BLOCK
        row = block * BLOCK**3 + (inner[:, 0] * BLOCK + inner[:, 1]) * BLOCK + inner[:, 2]
        row = np.where(block < 0, np.arange(len(index)), row)
        straight, like = signed + cell * normal @ way, (normal[row] * normal).sum(axis=1)
        bulges = np.where(signed > 0, signed[row] > straight, signed[row] < straight)
        known = (block >= 0) & (like > np.where(bulges, OPPOSITE, TURNED))
        laplacian += np.where(known, signed[row], straight) - signed
    return (laplacian / cell**2 / 2).astype(np.float32)
