"""Evenly spread samples of a triangle mesh.

Sharp edges and corners come first, then Poisson disks are thrown until none fits (Bridson 2007, Corsini et al.
2012: candidates spread by area, each kept unless an earlier one lies within the disk), then neighbours push each
other apart on the surface (Turk 1992), which evens out the gaps that disks leave.
"""

from __future__ import annotations

import numpy as np
import trimesh
from scipy.spatial import cKDTree

from sim.geometry.distance import closest_on_triangles
from sim.geometry.thinning import first_come

# Radius of the disks over the spacing: a saturated set of them has about one sample in spacing^2.
_DISK = 0.775
# Closest that samples of sharp edges may come, over the spacing.
EDGE_DISK = 0.75
SHARP = np.deg2rad(40.0)
_CANDIDATES = 2.0
_ROUNDS = 8
# Steps of the repulsion over the spacing: large ones to fill gaps, small ones to settle.
_STEPS = np.linspace(0.8, 0.2, 12)
# Reach of the repulsion over the spacing: past the first ring of neighbours, short of the second.
_REACH = 1.6
_NEIGHBOURS = 10


def scatter(mesh: trimesh.Trimesh, spacing: float) -> np.ndarray:
    """Samples [m], shape [n, 3], about one in spacing^2 [m^2]; the same for the same mesh and spacing."""
    random = np.random.default_rng(2012)
    corners = np.asarray(mesh.vertices, dtype=np.float64)[mesh.faces]
    fixed = _on_sharp_edges(mesh, spacing)
    points, pool, pool_face = _throw(corners, fixed, spacing, random)
    return _relax(points, len(fixed), corners, pool, pool_face, spacing)


def _throw(corners: np.ndarray, fixed: np.ndarray, spacing: float, random: np.random.Generator):
    """Disks until (almost) no more fit, after the fixed ones; and all candidates tried, with their faces."""
    twice_area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    upto = np.cumsum(twice_area)
    number = max(32, int(_CANDIDATES * upto[-1] / 2 / spacing**2))
    radius = _DISK * spacing
    points, pool, pool_face = fixed, [], []
    for _ in range(_ROUNDS):
        # Stratified by area: one candidate in each of equal portions of the surface.
        at = (random.permutation(number) + random.random(number)) / number * upto[-1]
        face = np.minimum(np.searchsorted(upto, at, side="right"), len(corners) - 1)
        u, v = np.sqrt(random.random(number)), random.random(number)
        weight = np.column_stack([1 - u, u * (1 - v), u * v])
        candidate = np.einsum("nw,nwx->nx", weight, corners[face])
        pool.append(candidate)
        pool_face.append(face)
        if len(points):
            gap, _ = cKDTree(points).query(candidate, distance_upper_bound=radius)
            candidate = candidate[np.isinf(gap)]
        if len(candidate):
            points = np.concatenate([points, candidate[first_come(candidate, radius)]])
    return points, np.concatenate(pool), np.concatenate(pool_face)


def _relax(
    points: np.ndarray, fixed: int, corners: np.ndarray, pool: np.ndarray, pool_face: np.ndarray, spacing: float
) -> np.ndarray:
    """Push neighbours apart and put them back on the surface; the first `fixed` points stay."""
    neighbours = min(_NEIGHBOURS, len(points) - 1)
    if neighbours < 1 or fixed == len(points):
        return points
    surface = cKDTree(pool)
    points = points.copy()
    moving = slice(fixed, None)
    for factor in _STEPS:
        distance, near = cKDTree(points).query(points[moving], k=neighbours + 1)
        away = points[moving, None] - points[near[:, 1:]]
        gap = np.maximum(distance[:, 1:], 1e-12 * spacing)
        push = np.maximum(0.0, 1.0 - gap / (_REACH * spacing)) ** 2 / gap
        step = factor * spacing * np.einsum("nk,nkx->nx", push, away)
        length = np.linalg.norm(step, axis=1, keepdims=True)
        step *= np.minimum(1.0, 0.25 * spacing / np.maximum(length, 1e-300))
        points[moving] = _onto_surface(points[moving] + step, surface, pool_face, corners)
    return points


def _onto_surface(points: np.ndarray, surface: cKDTree, pool_face: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """The nearest points on the triangles of the nearest candidates."""
    near = min(4, surface.n)
    _, candidate = surface.query(points, k=near)
    face = pool_face[candidate.reshape(len(points), near)]
    feet = closest_on_triangles(np.repeat(points, near, axis=0), corners[face.reshape(-1)]).reshape(-1, near, 3)
    best = np.linalg.norm(feet - points[:, None], axis=2).argmin(axis=1)
    return feet[np.arange(len(points)), best]


def _on_sharp_edges(mesh: trimesh.Trimesh, spacing: float) -> np.ndarray:
    """Samples of the corners and along the edges that are sharp or open, shape [n, 3]."""
    corners, chains = _chains(mesh)
    vertices = np.asarray(mesh.vertices, dtype=np.float64)
    samples = [vertices[corners]]
    for chain in chains:
        line = vertices[chain]
        along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
        number = max(1, round(along[-1] / spacing))
        number += along[-1] / number > 1.2 * spacing
        at = np.linspace(0.0, along[-1], number + 1)
        at = at[:-1] if chain[0] == chain[-1] else at[1:-1]
        samples.append(np.column_stack([np.interp(at, along, line[:, axis]) for axis in range(3)]))
    points = np.concatenate(samples)
    return points[first_come(points, EDGE_DISK * spacing)] if len(points) else points


def _chains(mesh: trimesh.Trimesh) -> tuple[list[int], list[list[int]]]:
    """Corner vertices, and polylines of sharp or open edges from corner to corner or around, as vertex indices."""
    sharp = mesh.face_adjacency_edges[mesh.face_adjacency_angles > SHARP]
    edges = np.sort(mesh.edges, axis=1)
    unique, counts = np.unique(edges, axis=0, return_counts=True)
    marked = np.unique(np.vstack([np.sort(sharp, axis=1), unique[counts == 1]]), axis=0)
    around: dict[int, list[int]] = {}
    for a, b in marked.tolist():
        around.setdefault(a, []).append(b)
        around.setdefault(b, []).append(a)
    vertices = np.asarray(mesh.vertices, dtype=np.float64)

    def is_corner(vertex: int) -> bool:
        ends = around[vertex]
        if len(ends) != 2:
            return True
        one, other = vertices[ends] - vertices[vertex]
        straightness = -one @ other / max(float(np.linalg.norm(one) * np.linalg.norm(other)), 1e-300)
        return straightness < np.cos(SHARP)

    corners = [vertex for vertex in around if is_corner(vertex)]
    left = {tuple(edge) for edge in marked.tolist()}
    stops = set(corners)
    chains = []
    # From the corners first; what is left are closed loops.
    for start in [*corners, *around]:
        for neighbour in around[start]:
            if (min(start, neighbour), max(start, neighbour)) not in left:
                continue
            chain = [start, neighbour]
            left.discard((min(chain), max(chain)))
            while chain[-1] not in stops and chain[-1] != start:
                ahead = next(vertex for vertex in around[chain[-1]] if vertex != chain[-2])
                left.discard((min(chain[-1], ahead), max(chain[-1], ahead)))
                chain.append(ahead)
            chains.append(chain)
    return corners, chains
