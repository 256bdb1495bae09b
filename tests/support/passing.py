"""Whether anything passed through anything: every pair of a point and a triangle, and of two edges, on straight ways.

Independent of the simulation's own search: the times at which four points lie in one plane are the roots of a cubic
(Provot 1997), found here by numpy's polynomials in double precision; then it is looked whether they meet.
"""

from __future__ import annotations

import numpy as np


def passed(before: np.ndarray, after: np.ndarray, triangles: np.ndarray, moving: np.ndarray | None = None) -> int:
    """How many pairs meet while points go from `before` to `after` [m], shape [n, 3]; `moving`: which points are cloth,
    without them no pair counts (default: all)."""
    moving = np.ones(len(before), bool) if moving is None else moving
    edges = edges_of(triangles)
    points = np.unique(triangles)[:, None]
    count = 0
    for one, other, inside in ((points, triangles, _in_triangle), (edges, edges, _on_edges)):
        pairs = _near_moving(before, after, one, other, moving)
        corners = np.concatenate([one[pairs[:, 0]], other[pairs[:, 1]]], axis=1)
        if inside is _on_edges:
            corners = corners[pairs[:, 0] < pairs[:, 1]]
        distinct = np.array([len(set(row)) == 4 for row in corners.tolist()], bool).reshape(-1)
        corners = corners[distinct & moving[corners].any(axis=1)] if len(corners) else corners
        count += _meetings(before, after, corners, inside)
    return count


def went_through(before: np.ndarray, after: np.ndarray, triangles: np.ndarray, single: int) -> int:
    """How many of the last `single` points, which belong to nothing, go through a triangle on their way."""
    if not single:
        return 0
    points = np.arange(len(before) - single, len(before))[:, None]
    pairs = _near(before, after, points, triangles)
    corners = np.concatenate([points[pairs[:, 0]], triangles[pairs[:, 1]]], axis=1)
    return _meetings(before, after, corners, _in_triangle)


def edges_of(triangles: np.ndarray) -> np.ndarray:
    """Each edge once, shape [e, 2]."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(np.sort(edges, 1), axis=0)


def _boxes(before: np.ndarray, after: np.ndarray, members: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    both = np.concatenate([before[members], after[members]], axis=1)
    return both.min(axis=1), both.max(axis=1)


def _near_moving(
    before: np.ndarray, after: np.ndarray, one: np.ndarray, other: np.ndarray, moving: np.ndarray
) -> np.ndarray:
    """As `_near`, without pairs of which nothing moves."""
    found = [np.zeros((0, 2), int)]
    for cloth, against in ((True, np.arange(len(other))), (False, np.flatnonzero(moving[other].any(axis=1)))):
        rows = np.flatnonzero(moving[one].any(axis=1) == cloth)
        if len(rows) and len(against):
            pairs = _near(before, after, one[rows], other[against])
            found.append(np.column_stack([rows[pairs[:, 0]], against[pairs[:, 1]]]))
    return np.concatenate(found)


def _near(before: np.ndarray, after: np.ndarray, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Pairs of primitives whose swept boxes overlap: sweep along the axis on which they are spread most."""
    low, high = _boxes(before, after, one)
    other_low, other_high = _boxes(before, after, other)
    axis = int(np.argmax(np.ptp(low, axis=0)))
    order = np.argsort(other_low[:, axis], kind="stable")
    width = float((other_high - other_low)[:, axis].max(initial=0.0))
    first = np.searchsorted(other_low[order, axis], low[:, axis] - width)
    last = np.searchsorted(other_low[order, axis], high[:, axis], side="right")
    found = []
    for k in range(len(one)):
        close = order[first[k] : last[k]]
        meet = (other_low[close] <= high[k]).all(axis=1) & (low[k] <= other_high[close]).all(axis=1)
        found.append(np.column_stack([np.full(int(meet.sum()), k), close[meet]]))
    return np.concatenate(found)


def _meetings(before: np.ndarray, after: np.ndarray, corners: np.ndarray, inside) -> int:
    if not len(corners):
        return 0
    x, v = before[corners], after[corners] - before[corners]
    x, v = x[:, 1:] - x[:, :1], v[:, 1:] - v[:, :1]
    triple = lambda a, b, c: (np.cross(a, b) * c).sum(axis=1)  # noqa: E731
    cubic = np.stack(
        [
            triple(v[:, 0], v[:, 1], v[:, 2]),
            triple(x[:, 0], v[:, 1], v[:, 2]) + triple(v[:, 0], x[:, 1], v[:, 2]) + triple(v[:, 0], v[:, 1], x[:, 2]),
            triple(v[:, 0], x[:, 1], x[:, 2]) + triple(x[:, 0], v[:, 1], x[:, 2]) + triple(x[:, 0], x[:, 1], v[:, 2]),
            triple(x[:, 0], x[:, 1], x[:, 2]),
        ],
        axis=1,
    )
    # A cubic has no root where all its Bernstein coefficients have one sign.
    a, b, c, d = cubic.T
    bernstein = np.stack([d, d + c / 3, d + 2 * c / 3 + b / 3, a + b + c + d])
    possible = np.flatnonzero((bernstein.min(axis=0) <= 0) & (bernstein.max(axis=0) >= 0))
    count = 0
    for k in possible:
        roots = np.roots(cubic[k]) if np.any(cubic[k][:-1]) else np.array([])
        times = roots[(np.abs(roots.imag) < 1e-9) & (roots.real >= 0) & (roots.real <= 1)].real
        places = before[corners[k]] + times[:, None, None] * (after - before)[corners[k]]
        count += any(inside(*place) for place in places)
    return count


def _in_triangle(p: np.ndarray, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> bool:
    u, v, w = b - a, c - a, p - a
    normal = np.cross(u, v)
    size = normal @ normal
    if size == 0:
        return False
    second, third = np.cross(w, v) @ normal / size, np.cross(u, w) @ normal / size
    return bool(second >= 0 and third >= 0 and second + third <= 1)


def _on_edges(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> bool:
    u, v, r = b - a, d - c, a - c
    uu, vv, uv = u @ u, v @ v, u @ v
    cross = uu * vv - uv * uv
    if cross <= 1e-14 * uu * vv:
        return False
    s, t = (uv * (v @ r) - (u @ r) * vv) / cross, (uu * (v @ r) - uv * (u @ r)) / cross
    return bool(0 <= s <= 1 and 0 <= t <= 1)
