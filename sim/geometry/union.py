"""The surface of all that a closed mesh encloses, where pieces of it overlap or it cuts through itself.

Every face is cut along the lines where others pass through it (a tree of half-planes, Fuchs, Kedem and Naylor 1980), so
that winding numbers on both sides are the same all over a part; parts that have the solid on one side only are its
surface (Zhou, Grinspun, Zorin and Jacobson 2016, "Mesh arrangements for solid geometry"). This is done in floating
point: what comes out counts only if it is closed and encloses what it should.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import trimesh
from scipy.spatial import cKDTree

from sim.geometry.closing import closed_pieces
from sim.geometry.overlap import (
    COUNTED_WRONGLY,
    columns_over,
    overlapping_pieces,
    volume_counted_wrongly,
    volume_inside_out,
)
from sim.geometry.topology import Topology, components, joined, signed_volume
from sim.geometry.winding import WindingNumber, expand
from sim.groups import groups

# Lengths over that of the mesh: points are one that are nearer, and winding numbers are looked up this far off a face.
_ONE = 1e-9
_BESIDE = 1e-10
# Pieces are moved by this where faces lie in one another, which no cut decides.
_MOVED = 1e-7
_ATTEMPTS = 4
# Share of the enclosed volume by which the union may differ.
_EXACT = 1e-5
_PAIRS_AT_ONCE = 2_000_000


def united(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """The closed surface of all that a closed mesh encloses: of where its winding number is positive.

    The mesh itself where its volume is counted right as it is, where a part of it is inside out, or where no such
    surface is found.
    """
    volume = signed_volume(mesh)
    if not overlapping_pieces(mesh) and volume_counted_wrongly(mesh) <= COUNTED_WRONGLY * volume:
        return mesh
    if volume_inside_out(mesh) > COUNTED_WRONGLY * volume:
        return mesh
    return _found(mesh) or mesh


def _found(mesh: trimesh.Trimesh) -> trimesh.Trimesh | None:
    centre, scale = mesh.bounds.mean(axis=0), float(np.ptp(mesh.bounds, axis=0).max())
    vertices = (np.asarray(mesh.vertices) - centre) / scale
    columns = columns_over(mesh.bounds)
    wanted = WindingNumber(mesh).length_within(columns)
    for attempt in range(_ATTEMPTS):
        moved = vertices + (_MOVED * _shifts(mesh, attempt) if attempt else 0.0)
        pieces = _closed(_surface(trimesh.Trimesh(moved, mesh.faces, process=False)))
        if not pieces:
            continue
        found = joined(pieces)
        found = trimesh.Trimesh(found.vertices * scale + centre, found.faces, process=False)
        number = WindingNumber(found)
        off = np.abs(number.length_within(columns) - wanted) + number.counted_wrongly(columns)
        if off.sum() <= _EXACT * wanted.sum():
            return found
    return None


def _shifts(mesh: trimesh.Trimesh, attempt: int) -> np.ndarray:
    """A vector for every vertex, the same over a piece, shape [n, 3]."""
    number, label = groups(*mesh.edges.T, len(mesh.vertices))
    return np.random.default_rng(attempt).uniform(-1, 1, (number, 3))[label]


def _closed(mesh: trimesh.Trimesh) -> list[trimesh.Trimesh]:
    topology = Topology.of(mesh)
    if topology.watertight and topology.consistent:
        return [mesh]
    return [closed for piece in components(mesh)[0] for closed in closed_pieces(piece)]


def _surface(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """The parts of faces that have the solid on one side only, of a mesh of unit size."""
    corners = np.asarray(mesh.vertices)[mesh.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    offset = (normal * corners[:, 0]).sum(axis=1)
    face, cutter, segment = _meetings(np.asarray(mesh.faces), corners, normal, offset)
    number = WindingNumber(mesh)

    def is_outer(middle: np.ndarray, of: np.ndarray) -> np.ndarray:
        beside = _BESIDE * normal[of]
        return (number.at(middle + beside) <= 0) & (number.at(middle - beside) > 0)

    parts, part_of = [], []
    order = np.argsort(face, kind="stable")
    for rows in np.split(order, np.flatnonzero(np.diff(face[order])) + 1) if len(order) else ():
        own = face[rows[0]]
        cut = list(_cut(corners[own], normal[cutter[rows]], offset[cutter[rows]], segment[rows]))
        parts += cut
        part_of += [own] * len(cut)
    outer = is_outer(np.array([part.mean(axis=0) for part in parts]).reshape(-1, 3), np.array(part_of, dtype=int))
    whole = np.setdiff1d(np.arange(len(corners)), face)
    whole = whole[is_outer(corners[whole].mean(axis=1), whole)]
    return _sewn(corners[whole], [part for part, kept in zip(parts, outer, strict=True) if kept])


def _meetings(
    faces: np.ndarray, corners: np.ndarray, normal: np.ndarray, offset: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Faces, those that pass through them, shape [n] each, and along which segments, shape [n, 2, 3]."""
    found = [(np.zeros(0, int), np.zeros(0, int), np.zeros((0, 2, 3)))]
    for one, other in _near(corners):
        # Neighbours meet in what they have in common.
        common = (faces[one][:, :, None] == faces[other][:, None, :]).sum(axis=(1, 2))
        one, other = one[common < 2], other[common < 2]
        above = np.einsum("nkx,nx->nk", corners[one], normal[other]) - offset[other][:, None]
        below = np.einsum("nkx,nx->nk", corners[other], normal[one]) - offset[one][:, None]
        crossing = _straddles(above) & _straddles(below)
        one, other, above, below = (values[crossing] for values in (one, other, above, below))
        along = np.cross(normal[one], normal[other])
        along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
        ends = [_ends(corners[own], height, along) for own, height in ((one, above), (other, below))]
        first = np.where((ends[0][0] > ends[1][0])[:, None], ends[0][2], ends[1][2])
        last = np.where((ends[0][1] < ends[1][1])[:, None], ends[0][3], ends[1][3])
        meet = ((last - first) * along).sum(axis=1) > _ONE
        segment = np.stack((first, last), axis=1)[meet]
        found += [(one[meet], other[meet], segment), (other[meet], one[meet], segment)]
    face, cutter, segment = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return face, cutter, segment


def _straddles(height: np.ndarray) -> np.ndarray:
    return (height.min(axis=1) < -_ONE) & (height.max(axis=1) > _ONE)


def _ends(corners: np.ndarray, height: np.ndarray, along: np.ndarray) -> tuple[np.ndarray, ...]:
    """Where triangles, shape [n, 3, 3], whose corners have `height` above a plane cross it: how far along the line of
    the crossing both ends are, shape [n] each, and the ends, shape [n, 3] each."""
    ahead, next_height = np.roll(corners, -1, axis=1), np.roll(height, -1, axis=1)
    crossed = (height >= 0) != (next_height >= 0)
    share = height / np.where(crossed, height - next_height, 1.0)
    points = corners + share[:, :, None] * (ahead - corners)
    place = np.einsum("nkx,nx->nk", points, along)
    low, high = np.where(crossed, place, np.inf), np.where(crossed, place, -np.inf)
    row = np.arange(len(corners))
    return low.min(axis=1), high.max(axis=1), points[row, low.argmin(axis=1)], points[row, high.argmax(axis=1)]


def _near(corners: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Pairs of triangles whose boxes overlap, each once, in portions."""
    low, high = corners.min(axis=1), corners.max(axis=1)
    cell = max(float((high - low).max(axis=1).mean()), 1e-6)
    while True:
        first, last = (np.floor((ends - low.min(axis=0)) / cell).astype(np.int64) for ends in (low, high))
        spans = last - first + 1
        if spans.prod(axis=1).sum() < 20 * len(corners) + 100_000:
            break
        cell *= 1.5
    face, local = expand(np.zeros(len(spans), dtype=np.int64), spans.prod(axis=1))
    y, z = spans[face, 1], spans[face, 2]
    index = first[face] + np.column_stack((local // (y * z), local // z % y, local % z))
    shape = last.max(axis=0) + 1
    key = (index[:, 0] * shape[1] + index[:, 1]) * shape[2] + index[:, 2]
    order = np.argsort(key, kind="stable")
    face, index, key = face[order], index[order], key[order]
    _, start, counts = np.unique(key, return_index=True, return_counts=True)
    # Every member of a cell with those that come after it.
    member = np.arange(len(face)) - np.repeat(start, counts)
    after = np.repeat(counts, counts) - member - 1
    portion = np.cumsum(after) // _PAIRS_AT_ONCE
    for rows in np.split(np.arange(len(face)), np.flatnonzero(np.diff(portion)) + 1):
        left, right = expand(rows + 1, after[rows])
        cell_of = index[rows[left]]
        one, other = face[rows[left]], face[right]
        overlap = ((low[one] <= high[other]) & (low[other] <= high[one])).all(axis=1)
        # A pair that has several cells in common counts in the first of them.
        overlap &= (np.maximum(first[one], first[other]) == cell_of).all(axis=1)
        yield one[overlap], other[overlap]


def _cut(triangle: np.ndarray, normal: np.ndarray, offset: np.ndarray, segment: np.ndarray) -> Iterator[np.ndarray]:
    """The convex parts of a triangle between segments in it, which lie in planes; shape [k, 3] each."""
    left = [(triangle, np.arange(len(segment)), segment)]
    while left:
        part, planes, ends = left.pop()
        if len(planes) == 0:
            yield part
            continue
        plane = planes[0]
        here, there = part @ normal[plane] - offset[plane], ends @ normal[plane] - offset[plane]
        for side in (1, -1):
            inside = _half(part, side * here)
            if len(inside) < 3:
                continue
            rest = (side * there[1:] > _ONE).any(axis=1)
            left.append((inside, planes[1:][rest], _clipped(ends[1:][rest], side * there[1:][rest])))


def _half(part: np.ndarray, height: np.ndarray) -> np.ndarray:
    """The part of a convex polygon, shape [k, 3], where the height of its corners is positive."""
    if height.max() <= _ONE:
        return part[:0]
    if height.min() >= -_ONE:
        return part
    kept = []
    for k, after in enumerate([*range(1, len(part)), 0]):
        if height[k] >= -_ONE:
            kept.append(part[k])
        if min(height[k], height[after]) < -_ONE and max(height[k], height[after]) > _ONE:
            kept.append(part[k] + height[k] / (height[k] - height[after]) * (part[after] - part[k]))
    return np.array(kept)


def _clipped(ends: np.ndarray, height: np.ndarray) -> np.ndarray:
    """The parts of segments, shape [n, 2, 3], where the height of their ends is positive."""
    share = height[:, 0] / np.where(height[:, 0] != height[:, 1], height[:, 0] - height[:, 1], 1.0)
    middle = ends[:, 0] + np.clip(share, 0, 1)[:, None] * (ends[:, 1] - ends[:, 0])
    return np.where((height < 0)[:, :, None], middle[:, None], ends)


def _sewn(whole: np.ndarray, parts: list[np.ndarray]) -> trimesh.Trimesh:
    """Triangles, shape [n, 3, 3], and those of convex polygons, with the corners of others that lie on their edges."""
    sizes = [len(part) for part in parts]
    vertices, vertex = _merged(np.concatenate((whole.reshape(-1, 3), *parts)))
    faces, rest = vertex[: 3 * len(whole)].reshape(-1, 3), vertex[3 * len(whole) :]
    loops = []
    for loop in np.split(rest, np.cumsum(sizes)[:-1]) if sizes else ():
        loop = loop[loop != np.roll(loop, 1)]
        if len(loop) >= 3 and _width(vertices[loop]) > _ONE:
            loops.append(loop)
    between = _on_edges(vertices, faces, loops)
    with_corners = np.zeros(len(faces), dtype=bool)
    if between:
        keys = np.array(list(between)) @ [len(vertices), 1]
        edges = np.sort(np.stack((faces, np.roll(faces, -1, axis=1)), axis=-1), axis=-1)
        with_corners = np.isin(edges @ [len(vertices), 1], keys).any(axis=1)
    triangles, middles = faces[~with_corners].tolist(), []
    for loop in [*faces[with_corners], *loops]:
        outline = []
        for a, b in zip(loop.tolist(), np.roll(loop, -1).tolist(), strict=True):
            inner = between.get((min(a, b), max(a, b)), [])
            outline += [a, *(inner if a < b else inner[::-1])]
        if len(outline) == 3:
            triangles.append(outline)
            continue
        middle = len(vertices) + len(middles)
        middles.append(vertices[loop].mean(axis=0))
        triangles += [[a, b, middle] for a, b in zip(outline, outline[1:] + outline[:1], strict=True)]
    return trimesh.Trimesh(
        np.concatenate((vertices, np.array(middles).reshape(-1, 3))),
        np.array(triangles, dtype=np.int64).reshape(-1, 3),
        process=False,
    )


def _merged(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points of which those within `_ONE` of one another are one, and which each is."""
    distinct, inverse = np.unique(points, axis=0, return_inverse=True)
    near = cKDTree(distinct).query_pairs(_ONE, output_type="ndarray") if len(distinct) else np.zeros((0, 2), int)
    _, label = groups(near[:, 0], near[:, 1], len(distinct))
    _, first = np.unique(label, return_index=True)
    return distinct[first], label[inverse.reshape(-1)]


def _width(polygon: np.ndarray) -> float:
    """Twice the area of a polygon, shape [k, 3], over its longest edge."""
    spokes = polygon - polygon[0]
    area = np.linalg.norm(np.cross(spokes[1:-1], spokes[2:]).sum(axis=0))
    return float(area / np.linalg.norm(np.roll(polygon, -1, axis=0) - polygon, axis=1).max())


def _on_edges(vertices: np.ndarray, faces: np.ndarray, loops: list[np.ndarray]) -> dict[tuple[int, int], list[int]]:
    """For edges (a, b), a < b, of triangles and polygons the vertices that lie on them, from a to b."""
    edges = [faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)]
    edges += [np.column_stack((loop, np.roll(loop, -1))) for loop in loops]
    edges = np.sort(np.concatenate(edges), axis=1)
    edges, counts = np.unique(edges, axis=0, return_counts=True)
    # Where two polygons have an edge in common, nothing is missing.
    edges = edges[counts != 2]
    if len(edges) == 0:
        return {}
    corners = np.unique(edges)
    start, along = vertices[edges[:, 0]], vertices[edges[:, 1]] - vertices[edges[:, 0]]
    length = np.linalg.norm(along, axis=1)
    near = cKDTree(vertices[corners]).query_ball_point(start + along / 2, length / 2 + _ONE)
    found = {}
    for (a, b), origin, way, reach, candidates in zip(edges.tolist(), start, along, length, near, strict=True):
        others = corners[candidates]
        others = others[(others != a) & (others != b)]
        place = (vertices[others] - origin) @ way / reach**2
        off = np.linalg.norm(vertices[others] - origin - place[:, None] * way, axis=1)
        on = (off <= 2 * _ONE) & (place > 0) & (place < 1)
        if on.any():
            found[a, b] = others[on][np.argsort(place[on])].tolist()
    return found
