"""Closing of open surfaces."""

from __future__ import annotations

import numpy as np
import trimesh

from sim.geometry.components import groups
from sim.geometry.meshes.openings import openings
from sim.geometry.meshes.topology import Topology, components


def closed_pieces(piece: trimesh.Trimesh, *, lids: bool = False) -> list[trimesh.Trimesh]:
    """The closed pieces that MeshFix makes of one connected piece (Attene 2010); none where it fails. With `lids`
    flat openings get a lid, and it is asked for others."""
    if _is_closed(piece):
        return [piece]
    if lids and all(opening.flat for opening in openings(piece, piece)) and _is_closed(covered := with_lids(piece)):
        return [covered]
    from pymeshfix import PyTMesh

    fixer = PyTMesh()
    fixer.set_quiet(1)
    # MeshFix decides coincidence by absolute tolerances: let it see a mesh of about unit size at the origin.
    centre, scale = piece.bounds.mean(axis=0), float(np.ptp(piece.bounds, axis=0).max())
    fixer.load_array(
        np.ascontiguousarray((piece.vertices - centre) / scale), np.ascontiguousarray(piece.faces, dtype=np.int32)
    )
    fixer.fill_small_boundaries(0, True)
    fixer.clean(10, 3)
    vertices, faces = fixer.return_arrays()
    if len(faces) == 0:
        return []
    mended = trimesh.Trimesh(vertices * scale + centre, faces, process=False)
    return [part for part in components(mended)[0] if _is_closed(part)]


def with_lids(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """The mesh and a fan of triangles over each opening, from its edges to their middle; these come last."""
    points, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    edges = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    there, back = (edge @ [len(points), 1] for edge in (edges, edges[:, ::-1]))
    a, b = edges[~np.isin(back, there)].T
    _, label = groups(a, b, len(points))
    group, label = np.unique(label[a], return_inverse=True)
    middles = np.zeros((len(group), 3))
    np.add.at(middles, label, points[a])
    middles /= np.bincount(label, minlength=len(group))[:, None]
    fans = np.column_stack((b, a, len(points) + label))
    return trimesh.Trimesh(np.concatenate((points, middles)), np.concatenate((faces, fans)), process=False)


def _is_closed(mesh: trimesh.Trimesh) -> bool:
    topology = Topology.of(mesh)
    return topology.watertight and topology.consistent
