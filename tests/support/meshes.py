"""Meshes in files, sound and broken, for tests of bodies."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

Mesh = tuple[np.ndarray, np.ndarray]
"""Vertices [m], shape [n, 3], and triangles, shape [faces, 3]."""


def write(path: Path, mesh: Mesh | trimesh.Trimesh) -> Path:
    """As OFF, number for number: trimesh would mend what is broken here."""
    vertices, faces = (mesh.vertices, mesh.faces) if isinstance(mesh, trimesh.Trimesh) else mesh
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(repr(float(x)) for x in vertex) for vertex in vertices]
    lines += ["3 " + " ".join(map(str, face)) for face in faces]
    path.write_text("\n".join(lines) + "\n")
    return path


def body(path: Path, **settings: Any) -> dict[str, Any]:
    """A dynamic body with the mesh of a file."""
    return {"motion": "dynamic", "shape": {"type": "mesh", "file": str(path)}, **settings}


def broken_boxes(size: tuple[float, float, float]) -> dict[str, tuple[Mesh, str]]:
    """Meshes whose solid is a box with edges `size` [m], by what is wrong with them, and what is said when mended."""
    box = trimesh.creation.box(size)
    v, f = np.asarray(box.vertices), np.asarray(box.faces)
    a, b, c = f[0]
    more = np.vstack((v, (v[a] + v[b]) / 2))
    near = np.linalg.norm(size) / 20
    fine = box.subdivide().subdivide()
    return {
        "inside out": ((v, f[:, ::-1]), "turned 1 piece inside out"),
        "some faces turned": ((v, np.where(np.arange(12)[:, None] % 3, f, f[:, ::-1])), "disagreed"),
        "a triangle missing": ((np.asarray(fine.vertices), np.asarray(fine.faces)[1:]), "closed 1 hole"),
        "a seam": (with_a_seam(v, f, 1e-10), "joined 8 vertices across seams"),
        "repeated and without area": (
            (np.vstack((v, v)), np.vstack((f, f[:1] + 8, [[a, a, b], [a, a + 8, c]]))),
            "removed 3 degenerate or repeated faces",
        ),
        "a corner on an edge": ((more, np.vstack((f[1:], [[a, 8, c], [8, b, c], [a, b, 8]]))), ""),
        "triangles apart": ((v[f].reshape(-1, 3), np.arange(36).reshape(-1, 3)), ""),
        "a fin": ((np.vstack((v, v[a] + near)), np.vstack((f, [[a, b, 8]]))), "removed 1 non-manifold edge"),
        "a box within": ((np.vstack((v, v / 2)), np.vstack((f, f + 8))), "dropped 1 of 2 separate pieces"),
        "a corner nowhere": ((np.vstack((v, [[np.nan] * 3])), f), ""),
    }


def with_a_seam(vertices: np.ndarray, faces: np.ndarray, width: float) -> Mesh:
    """The same, of which the upper half has vertices of its own, each `width` of the size or less off."""
    upper = vertices[faces][:, :, 1].mean(axis=1) > 0
    off = np.random.default_rng(1).uniform(-width, width, vertices.shape) / np.sqrt(3) * np.ptp(vertices, axis=0).max()
    return np.vstack((vertices, vertices + off)), np.where(upper[:, None], faces + len(vertices), faces)


def figure_of_eight(radius: float = 0.2, tube: float = 0.03) -> Mesh:
    """A closed tube of radius `tube` [m] along a lying eight of half length `radius` [m]: it crosses itself."""
    t = 2 * np.pi * np.arange(96) / 96
    spine = radius * np.column_stack((np.sin(t), 0 * t, np.sin(t) * np.cos(t)))
    ahead = np.column_stack((np.cos(t), 0 * t, np.cos(2 * t)))
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    up = np.array([0.0, 1.0, 0.0])
    angle = 2 * np.pi * np.arange(12) / 12
    ring = np.cos(angle)[:, None, None] * np.cross(ahead, up) + np.sin(angle)[:, None, None] * up
    vertices = (spine + tube * ring).transpose(1, 0, 2).reshape(-1, 3)
    i, j = (index.ravel() for index in np.meshgrid(np.arange(96), np.arange(12), indexing="ij"))
    corner = [((i + di) % 96) * 12 + (j + dj) % 12 for di, dj in ((0, 0), (0, 1), (1, 1), (1, 0))]
    faces = np.vstack((np.column_stack(corner[:3]), np.column_stack((corner[0], corner[2], corner[3]))))
    return _outward(vertices, faces)


def bow_tie(size: tuple[float, float, float]) -> Mesh:
    """A box the bottom of which comes through its top on one half: there it is inside out."""
    box = trimesh.creation.box(size).subdivide().subdivide()
    vertices = np.array(box.vertices)
    along = vertices[:, 2] / size[2] + 0.5
    vertices[:, 1] *= 1 - 1.6 * along
    return vertices, np.asarray(box.faces)


def _outward(vertices: np.ndarray, faces: np.ndarray) -> Mesh:
    volume = np.einsum("ij,ij->", vertices[faces[:, 0]], np.cross(vertices[faces[:, 1]], vertices[faces[:, 2]]))
    return vertices, faces if volume > 0 else faces[:, ::-1]


def without_mass() -> dict[str, tuple[Callable[[], Mesh], str]]:
    """Meshes of which no dynamic body can be made, and what has to be said of them."""
    flat = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1.0]]), np.array([[0, 2, 1], [0, 3, 2]])
    box = trimesh.creation.box((0.2, 0.1, 0.3))
    v, f = np.asarray(box.vertices), np.asarray(box.faces)
    nowhere = v.copy()
    nowhere[3, 1] = np.nan
    endless = v.copy()
    endless[3, 1] = np.inf
    return {
        "flat": (lambda: flat, "is flat"),
        "flat on both sides": (lambda: (flat[0], np.vstack((flat[1], flat[1][:, ::-1]))), "is flat"),
        "thinner than rounding": (lambda: (v * [1, 1e-8, 1], f), "encloses no volume"),
        "nan": (lambda: (nowhere, f), "not finite"),
        "infinite": (lambda: (endless, f), "not finite"),
        "open as a tray": (lambda: (v, f[box.face_normals[:, 1] < 0.5]), "is open"),
        "a bow tie": (lambda: bow_tie((0.2, 0.1, 0.3)), "cuts through itself"),
    }


def open_edges(triangles: np.ndarray) -> int:
    """Edges that are not crossed once in each direction."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    size = edges.max() + 1
    there, back = np.sort(edges[:, 0] * size + edges[:, 1]), np.sort(edges[:, 1] * size + edges[:, 0])
    return int(np.count_nonzero(there != back))
