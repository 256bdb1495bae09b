"""The surface of all that a closed mesh encloses, where pieces of it overlap or it cuts through itself."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import trimesh
from manifold3d import Manifold, Mesh64, OpType

from sim.geometry.meshes.overlap import (
    COUNTED_WRONGLY,
    columns_over,
    overlapping_pieces,
    volume_counted_wrongly,
    volume_inside_out,
)
from sim.geometry.meshes.topology import Topology, components, flipped, signed_volume
from sim.geometry.meshes.winding import WindingNumber

# Share of the enclosed volume by which the union may differ.
_EXACT = 1e-5
# A part that counts less than this share of the volume wrongly does not cut through itself.
_SIMPLE = 1e-7
# How often a piece that cuts through itself is cut in two, at most, and where along its longest side: off the middle,
# where what is symmetric meets itself.
_CUTS = 9
_CUT_AT = 0.4


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
    found = _found(mesh)
    return found if found is not None and _encloses_the_same(found, mesh) else mesh


def _found(mesh: trimesh.Trimesh) -> trimesh.Trimesh | None:
    """The union of the pieces, each less the hollows in it; None where a hollow is in no piece, or a piece is not
    manifold."""
    # Lengths below 1e-12 of the largest coordinate are rounding to the library.
    centre = mesh.bounds.mean(axis=0)
    pieces, _ = components(trimesh.Trimesh(mesh.vertices - centre, mesh.faces, process=False))
    solids = [piece for piece in pieces if signed_volume(piece) > 0]
    hollows = [flipped(piece) for piece in pieces if signed_volume(piece) <= 0]
    around = [_smallest_around(hollow, solids) for hollow in hollows]
    if None in around:
        return None
    least = _SIMPLE * signed_volume(mesh)
    filled = [
        Manifold.batch_boolean(
            [
                _filled(solid, least),
                *(_filled(hollow, least) for hollow, of in zip(hollows, around, strict=True) if of == index),
            ],
            OpType.Subtract,
        )
        for index, solid in enumerate(solids)
    ]
    whole = Manifold.batch_boolean(filled, OpType.Add)
    if whole.is_empty():
        return None
    found = _triangles(whole)
    return trimesh.Trimesh(found.vertices + centre, found.faces, process=False)


def _smallest_around(hollow: trimesh.Trimesh, solids: list[trimesh.Trimesh]) -> int | None:
    holders = [
        index for index, solid in enumerate(solids) if (WindingNumber(solid).at(np.asarray(hollow.vertices)) > 0).all()
    ]
    return min(holders, key=lambda index: signed_volume(solids[index]), default=None)


def _filled(piece: trimesh.Trimesh, least: float) -> Manifold:
    """What a piece encloses, once; `least` is the volume that may count wrongly."""
    vertices, faces = np.asarray(piece.vertices, dtype=np.float64), np.asarray(piece.faces, dtype=np.uint64)
    whole = Manifold(Mesh64(np.ascontiguousarray(vertices), np.ascontiguousarray(faces)))
    return Manifold.batch_boolean(list(_simple_parts(whole, least, _CUTS)), OpType.Add)


def _simple_parts(solid: Manifold, least: float, cuts: int) -> Iterator[Manifold]:
    """Parts of a solid that do not cut through themselves: what passes through what falls apart if cut often enough."""
    mesh = _triangles(solid)
    if cuts == 0 or solid.is_empty() or volume_counted_wrongly(mesh) <= least:
        yield solid
        return
    axis = int(np.ptp(mesh.bounds, axis=0).argmax())
    low, high = mesh.bounds[:, axis]
    for side in solid.split_by_plane(tuple(np.eye(3)[axis]), low + _CUT_AT * (high - low)):
        for part in side.decompose():
            yield from _simple_parts(part, least, cuts - 1)


def _triangles(solid: Manifold) -> trimesh.Trimesh:
    mesh = solid.to_mesh64()
    return trimesh.Trimesh(mesh.vert_properties[:, :3], mesh.tri_verts.astype(np.int64), process=False)


def _encloses_the_same(found: trimesh.Trimesh, mesh: trimesh.Trimesh) -> bool:
    """Whether a surface is closed and encloses, once, what a mesh encloses at least once."""
    topology = Topology.of(found)
    if not (topology.watertight and topology.consistent):
        return False
    columns, number = columns_over(mesh.bounds), WindingNumber(found)
    wanted = WindingNumber(mesh).length_within(columns)
    off = np.abs(number.length_within(columns) - wanted) + number.counted_wrongly(columns)
    return bool(off.sum() <= _EXACT * wanted.sum())
