"""Counts and simple operations on triangle meshes that hold for broken ones as well."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
import trimesh
from scipy.spatial import cKDTree

from scene.settings import Refused
from sim.geometry.components import groups


@dataclass(frozen=True)
class Topology:
    """How the faces of a mesh hang together."""

    vertices: int
    faces: int
    boundary_edges: int
    """Edges with one face."""
    non_manifold_edges: int
    """Edges with three faces or more."""
    holes: int
    """Connected groups of boundary edges."""
    consistent: bool
    """Whether the two faces of every edge run along it in opposite directions."""

    @property
    def watertight(self) -> bool:
        """Every edge has two faces."""
        return self.faces > 0 and self.boundary_edges == 0 and self.non_manifold_edges == 0

    @classmethod
    def of(cls, mesh: trimesh.Trimesh) -> Self:
        """Counted by the indices of faces: two vertices at one place stay two, and those without a face do not
        count."""
        used = len(np.unique(mesh.faces))
        edges, first, faces_of = edges_of(mesh.faces)
        forward = np.bincount(faces_of, weights=first, minlength=len(edges))
        counts = np.bincount(faces_of, minlength=len(edges))
        boundary = edges[counts == 1]
        return cls(
            vertices=used,
            faces=len(mesh.faces),
            boundary_edges=len(boundary),
            non_manifold_edges=int((counts > 2).sum()),
            holes=_groups(boundary, len(mesh.vertices)),
            consistent=bool((forward[counts == 2] == 1).all()),
        )


@dataclass(frozen=True)
class Cleaning:
    """What `cleaned` did."""

    faces: int
    """Faces removed: without area, or that repeat another."""
    seams: int
    """Vertices joined with others that are almost where they are."""


def cleaned(mesh: trimesh.Trimesh, *, name: str) -> tuple[trimesh.Trimesh, Cleaning]:
    """The mesh with equal vertices merged, seams joined and faces without area or repeated removed, and what went.

    A seam is where two open edges are less than `SEAM` of the mesh's size apart: files round their numbers.

    Raises `Refused` for vertices that are not finite, indices out of range, or no faces.
    """
    vertices = np.array(mesh.vertices, dtype=np.float64).reshape(-1, 3)
    faces = np.array(mesh.faces, dtype=np.int64).reshape(-1, 3)
    if len(faces) == 0:
        raise Refused(f"mesh {name!r} has no faces", remedy="Give a triangle mesh, not a point cloud or curves")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise Refused(
            f"mesh {name!r} has faces that name vertices which do not exist ({len(vertices)} vertices, "
            f"indices {faces.min()} to {faces.max()})",
            remedy="The file is damaged: export it again",
        )
    used = np.unique(faces)
    bad = used[~np.isfinite(vertices[used]).all(axis=1)]
    if len(bad):
        raise Refused(
            f"mesh {name!r} has {len(bad)} vertices that are not finite numbers, the first is vertex {bad[0]}",
            remedy="The file is damaged: export it again",
        )
    largest = float(np.abs(vertices[used]).max())
    if largest > _LARGEST_COORDINATE:
        raise Refused(
            f"mesh {name!r} has coordinates up to {largest:.3g}, whose products overflow",
            remedy="The file is damaged: export it again",
        )
    vertices, inverse = np.unique(vertices[used], axis=0, return_inverse=True)
    lookup = np.full(used.max() + 1, -1, dtype=np.int64)
    lookup[used] = inverse.reshape(-1)
    kept = _sound(lookup[faces])
    target = _across_seams(vertices, kept)
    kept = _sound(target[kept])
    if len(kept) == 0:
        raise Refused(f"mesh {name!r} has no face with an area", remedy="Give a mesh that encloses a volume")
    done = Cleaning(len(faces) - len(kept), int((target != np.arange(len(target))).sum()))
    return _submesh(trimesh.Trimesh(vertices, kept, process=False), np.arange(len(kept))), done


def _sound(faces: np.ndarray) -> np.ndarray:
    """The faces with three corners, the first of those that have the same."""
    corners = np.sort(faces, axis=1)
    distinct = (corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2])
    _, first = np.unique(corners, axis=0, return_index=True)
    unique = np.zeros(len(faces), dtype=bool)
    unique[first] = True
    return faces[distinct & unique]


def _across_seams(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """For every vertex the one that takes its place, shape [n]: itself but on open edges within `SEAM` of another."""
    target = np.arange(len(vertices))
    edges, _, edge_of = edges_of(faces)
    rim = np.unique(edges[np.bincount(edge_of, minlength=len(edges)) == 1])
    if len(rim) == 0:
        return target
    reach = SEAM * float(np.ptp(vertices, axis=0).max())
    distance, near = cKDTree(vertices[rim]).query(vertices[rim], k=min(_COPIES, len(rim)), distance_upper_bound=reach)
    one, place = np.nonzero(np.isfinite(distance))
    _, label = groups(one, near[one, place], len(rim))
    _, first = np.unique(label, return_index=True)
    target[rim] = rim[first[label]]
    return target


# Numbers in single precision and those of six decimals are rounded by about this share of the largest.
SEAM = 1e-6
# Copies of a vertex that are looked for around one of them.
_COPIES = 16
# Moments of inertia are fifth powers of a length and must stay below 1e308.
_LARGEST_COORDINATE = 1e50
# The fewest faces that enclose a volume: a tetrahedron.
FEWEST_FACES = 4


def components(mesh: trimesh.Trimesh) -> tuple[list[trimesh.Trimesh], int]:
    """Pieces that hang together by edges with exactly two faces, the one with most faces first, and their number.

    Pieces of less than `FEWEST_FACES` faces are counted only.
    """
    edges, _, edge_of = edges_of(mesh.faces)
    face_of = np.arange(len(edge_of)) // 3
    order = np.argsort(edge_of, kind="stable")
    counts = np.bincount(edge_of, minlength=len(edges))
    start = (np.cumsum(counts) - counts)[counts == 2]
    a, b = face_of[order[start]], face_of[order[start + 1]]
    number, label = groups(a, b, len(mesh.faces))
    if number == 1:
        return [mesh], 1
    sizes = np.bincount(label)
    by_label = np.split(np.argsort(label, kind="stable"), np.cumsum(sizes)[:-1])
    large = [piece for piece in np.argsort(-sizes, kind="stable") if sizes[piece] >= FEWEST_FACES]
    return [_submesh(mesh, by_label[piece]) for piece in large], int(number)


def joined(meshes: list[trimesh.Trimesh]) -> trimesh.Trimesh:
    """One mesh of several, without merging their vertices."""
    offsets = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    return trimesh.Trimesh(
        np.vstack([mesh.vertices for mesh in meshes]),
        np.vstack([mesh.faces + offset for mesh, offset in zip(meshes, offsets[:-1], strict=True)]),
        process=False,
    )


def flipped(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """The same surface, facing the other way."""
    return trimesh.Trimesh(mesh.vertices, mesh.faces[:, ::-1], process=False)


def signed_volume(mesh: trimesh.Trimesh) -> float:
    """Volume by the divergence theorem, sum of a . (b x c) / 6; negative when the faces point inward."""
    corners = mesh.vertices[mesh.faces]
    # About the mesh's own middle: far from the origin the terms would cancel to rounding.
    a, b, c = np.moveaxis(corners - corners.mean(axis=(0, 1)), 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def surface_area(mesh: trimesh.Trimesh) -> float:
    """Sum of the triangles' areas."""
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def edges_of(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Undirected edges, and for the three edges of every face whether it ascends and which edge it is."""
    directed = np.asarray(faces, dtype=np.int64)[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    size = int(directed.max(initial=0)) + 1
    low, high = directed.min(axis=1), directed.max(axis=1)
    key, edge_of = np.unique(low * size + high, return_inverse=True)
    return np.column_stack([key // size, key % size]), directed[:, 0] < directed[:, 1], edge_of.reshape(-1)


def _groups(edges: np.ndarray, size: int) -> int:
    if len(edges) == 0:
        return 0
    _, label = groups(edges[:, 0], edges[:, 1], size)
    return len(np.unique(label[edges[:, 0]]))


def _submesh(mesh: trimesh.Trimesh, chosen: np.ndarray) -> trimesh.Trimesh:
    used, faces = np.unique(mesh.faces[np.sort(chosen)], return_inverse=True)
    return trimesh.Trimesh(mesh.vertices[used], faces.reshape(-1, 3), process=False)
