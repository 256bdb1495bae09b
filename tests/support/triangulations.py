"""Flat meshes of a rectangle, turned and irregular, for tests of what must not depend on the mesh."""

from __future__ import annotations

from pathlib import Path

import numpy as np

MESHES = ("one diagonal", "both diagonals", "aligned", "turned by 17", "turned by 30", "irregular")
"""Right triangles; equilateral ones, as far as the border lets them; and points anywhere."""


def triangulated(kind: str, length: float, width: float, cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Points in the plane [m], shape [n, 2], and triangles, shape [t, 3], of a strip from 0 to `length` and 0 to
    `width` with so many cells along its length."""
    from scipy.spatial import Delaunay

    across = max(2, round(width * cells / length))
    x, y = np.linspace(0, length, cells + 1), np.linspace(0, width, across + 1)
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    if kind.endswith("diagonal") or kind.endswith("diagonals"):
        return grid.reshape(-1, 2), _right(cells, across, in_turns=kind == "both diagonals")
    edge, inner = length / cells, grid[1:-1, 1:-1].reshape(-1, 2)
    border = np.concatenate([grid[:, 0], grid[:, -1], grid[0, 1:-1], grid[-1, 1:-1]])
    if kind == "irregular":
        inner = inner + np.random.default_rng(0).uniform(-0.3, 0.3, inner.shape) * edge
    else:
        angle = np.radians(float(kind.split()[-1])) if "turned" in kind else 0.0
        inner = _equilateral(edge, angle, length, width)
    points = np.concatenate([border, inner])
    return points, _facing_up(points, Delaunay(points).simplices, edge)


def _facing_up(points: np.ndarray, triangles: np.ndarray, edge: float) -> np.ndarray:
    """All in the same sense, without those that have no area."""
    one, other = (points[triangles[:, k]] - points[triangles[:, 0]] for k in (1, 2))
    area = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    triangles[area < 0] = triangles[area < 0][:, [0, 2, 1]]
    return triangles[np.abs(area) > 1e-9 * edge**2]


def _right(cells: int, across: int, *, in_turns: bool) -> np.ndarray:
    index = np.arange((cells + 1) * (across + 1)).reshape(cells + 1, across + 1)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    rising = np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)], -2)
    falling = np.stack([np.stack([a, b, d], -1), np.stack([b, c, d], -1)], -2)
    odd = (np.add.outer(np.arange(cells), np.arange(across)) % 2 == 1)[..., None, None]
    return (np.where(odd, falling, rising) if in_turns else rising).reshape(-1, 3)


def _equilateral(edge: float, angle: float, length: float, width: float) -> np.ndarray:
    reach = int(2 * (length + width) / edge)
    i, j = np.meshgrid(np.arange(-reach, reach + 1), np.arange(-reach, reach + 1))
    flat = np.column_stack([(i + j / 2).ravel(), (j * np.sqrt(3) / 2).ravel()]) * edge
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    points = flat @ turn.T + [length / 2, width / 2]
    room = np.minimum(points, [length, width] - points).min(axis=1)
    return points[room > edge / 2]


def disc(kind: str, radius: float, edge: float) -> tuple[np.ndarray, np.ndarray]:
    """Points in the plane [m], shape [n, 2], and triangles, shape [t, 3], of a disc around 0."""
    from scipy.spatial import Delaunay

    turn = np.linspace(0, 2 * np.pi, round(2 * np.pi * radius / edge), endpoint=False)
    if "turned" in kind or kind == "aligned":
        angle = np.radians(float(kind.split()[-1])) if "turned" in kind else 0.0
        inner = _equilateral(edge, angle, 2 * radius, 2 * radius) - radius
    else:
        steps = np.arange(-np.ceil(radius / edge), np.ceil(radius / edge) + 1) * edge
        inner = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
        if kind == "irregular":
            inner = inner + np.random.default_rng(0).uniform(-0.3, 0.3, inner.shape) * edge
    inner = inner[np.linalg.norm(inner, axis=1) < radius - 0.6 * edge]
    points = np.concatenate([radius * np.column_stack([np.cos(turn), np.sin(turn)]), inner])
    return points, _facing_up(points, Delaunay(points).simplices, edge)


def with_clamp(points: np.ndarray, triangles: np.ndarray, edge: float) -> tuple[np.ndarray, np.ndarray]:
    """The same strip with a row of cells before its beginning: two straight rows of points to hold, however irregular
    the rest is."""
    row = np.flatnonzero(np.abs(points[:, 0]) < 1e-9)
    row = row[np.argsort(points[row, 1])]
    before = len(points) + np.arange(len(row))
    a, b, c, d = before[:-1], row[:-1], row[1:], before[1:]
    points = np.concatenate([points, points[row] - [edge, 0]])
    return points, np.concatenate([triangles, np.stack([a, b, c], -1), np.stack([a, c, d], -1)])


def write(points: np.ndarray, triangles: np.ndarray, file: Path) -> Path:
    """Points of the plane as x and z, or of space, shape [n, 3], to a mesh file."""
    import trimesh

    if points.shape[1] == 2:
        points, triangles = np.column_stack([points[:, 0], 0 * points[:, 0], points[:, 1]]), triangles[:, [0, 2, 1]]
    trimesh.Trimesh(points, triangles, process=False).export(file)
    return file
