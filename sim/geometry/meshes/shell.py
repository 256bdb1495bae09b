"""From a surface to the shell of a thickness around it.

Every face has two sides. Sides that meet before an edge, with nothing between them, are one sheet of the shell there;
so it does not matter which way faces look, how many have an edge in common, or whether the surface has two sides at
all. A vertex of a sheet is where the planes of its faces meet that are moved by half of the thickness; edges with one
face get a flat rim.
"""

from __future__ import annotations

import numpy as np
import trimesh

from sim.geometry.components import groups
from sim.geometry.meshes.closing import with_lids
from sim.geometry.meshes.topology import edges_of

# The least share of a vertex's normals along any direction that counts in full: a mitre is at most 1 / sqrt of it long.
_LEAST = 0.05


def thickened(mesh: trimesh.Trimesh, thickness: float) -> trimesh.Trimesh:
    """The closed mesh, faces outward, of all that is within half of `thickness` of a surface, with flat rims.

    Where the surface is bent more narrowly than that, the result cuts through itself.
    """
    vertices, faces = _halved(np.asarray(mesh.vertices, dtype=np.float64), np.asarray(mesh.faces))
    count = len(faces)
    corners = vertices[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)

    # The corner c of the side s of the face f is number 3 (s count + f) + c; side 0 is where the normal points.
    one, other, rim = _sheets(vertices, faces, normal)
    number, label = groups(one, other, 6 * count)
    sides = label.reshape(2, count, 3)
    weight = np.tile(_angles(corners).ravel(), 2)
    out = np.repeat(np.concatenate((normal, -normal)), 3, axis=0)
    origin = np.zeros((number, 3))
    origin[label] = np.tile(corners.reshape(-1, 3), (2, 1))
    points = origin + thickness / 2 * _mitres(label, number, weight, out)

    # The rim of an edge a b of a face goes from b to a on its front and back again behind.
    face, corner = np.divmod(rim, 3)
    after = (corner + 1) % 3
    a, b, a_behind, b_behind = (
        sides[0, face, corner],
        sides[0, face, after],
        sides[1, face, corner],
        sides[1, face, after],
    )
    rims = np.concatenate((np.column_stack((b, a, a_behind)), np.column_stack((b, a_behind, b_behind))))
    # Where front and back are one sheet, as at the end of a slit, the rim has no width.
    rims = rims[(rims != np.roll(rims, 1, axis=1)).all(axis=1)]
    # Where an edge of three faces and more ends, their rims leave an opening.
    faces = np.concatenate((sides[0], sides[1][:, ::-1], rims))
    return with_lids(trimesh.Trimesh(points, faces, process=False))


def _halved(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same surface with edges of three faces and more cut in two, or the shell of a fin that ends at both ends of
    such an edge would have an edge in common with that of the faces beside it."""
    edges, _, edge_of = edges_of(faces)
    for a, b in edges[np.bincount(edge_of) > 2]:
        row, corner = np.nonzero(
            ((faces == a) | (faces == b)) & ((np.roll(faces, -1, 1) == a) | (np.roll(faces, -1, 1) == b))
        )
        first, second = faces[row].copy(), faces[row].copy()
        first[np.arange(len(row)), (corner + 1) % 3] = len(vertices)
        second[np.arange(len(row)), corner] = len(vertices)
        vertices = np.vstack((vertices, (vertices[a] + vertices[b]) / 2))
        faces = np.concatenate((np.delete(faces, row, axis=0), first, second))
    return vertices, faces


def _sheets(vertices: np.ndarray, faces: np.ndarray, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pairs of corners that are one vertex of a sheet, both of shape [n]; and the edges of faces, 3 face + corner, that
    no other face has."""
    edges, ascends, edge_of = edges_of(faces)
    face, corner = np.divmod(np.arange(len(edge_of)), 3)
    low, high = np.where(ascends, corner, (corner + 1) % 3), np.where(ascends, (corner + 1) % 3, corner)
    along = vertices[edges[:, 1]] - vertices[edges[:, 0]]
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)

    # Around an edge faces are sorted by angle; the normal of one in which the edge ascends points to where it grows.
    across, up = _frames(along)
    into = np.cross(np.where(ascends[:, None], normal[face], -normal[face]), along[edge_of])
    angle = np.arctan2((into * up[edge_of]).sum(axis=1), (into * across[edge_of]).sum(axis=1))
    order = np.lexsort((angle, edge_of))
    counts = np.bincount(edge_of, minlength=len(edges))
    start = np.cumsum(counts) - counts
    place = np.arange(len(order)) - np.repeat(start, counts)
    following = order[np.repeat(start, counts) + (place + 1) % np.repeat(counts, counts)]
    joined = np.repeat(counts, counts) > 1
    this, that = order[joined], following[joined]
    ahead = np.where(ascends[this], 0, 1) * len(faces) + face[this]
    behind = np.where(ascends[that], 1, 0) * len(faces) + face[that]
    one = np.concatenate((3 * ahead + low[this], 3 * ahead + high[this]))
    other = np.concatenate((3 * behind + low[that], 3 * behind + high[that]))
    return one, other, np.flatnonzero(counts[edge_of] == 1)


def _frames(along: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors across each of `along`, right-handed with it, all of shape [n, 3]."""
    least = np.eye(3)[np.abs(along).argmin(axis=1)]
    across = np.cross(along, least)
    across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-300)
    return across, np.cross(along, across)


def _angles(corners: np.ndarray) -> np.ndarray:
    """Angles of triangles, shape [n, 3, 3], at their corners [rad], shape [n, 3]."""
    ahead, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    return np.arctan2(np.linalg.norm(np.cross(ahead, back), axis=2), (ahead * back).sum(axis=2))


def _mitres(label: np.ndarray, number: int, weight: np.ndarray, out: np.ndarray) -> np.ndarray:
    """The vectors d of least squares with n d = 1 for the unit normals n of each vertex, shape [number, 3]."""
    total = np.maximum(np.bincount(label, weights=weight, minlength=number), 1e-300)
    share = weight / total[label]
    matrix, right = np.zeros((number, 3, 3)), np.zeros((number, 3))
    np.add.at(matrix, label, share[:, None, None] * out[:, :, None] * out[:, None, :])
    np.add.at(right, label, share[:, None] * out)
    values, axes = np.linalg.eigh(matrix)
    along = np.einsum("nij,ni->nj", axes, right) / np.maximum(values, _LEAST)
    return np.einsum("nij,nj->ni", axes, along)
