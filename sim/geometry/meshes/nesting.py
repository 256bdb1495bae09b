"""Pieces of a mesh inside one another: which of them are hollows, and which way each has to face."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np

from sim.geometry.meshes.topology import Topology, flipped, signed_volume

if TYPE_CHECKING:
    import trimesh


def turned_outward(
    solid: list[tuple[trimesh.Trimesh, trimesh.Trimesh]],
) -> tuple[list[trimesh.Trimesh], int, int, set[int]]:
    """Turn every piece outward, except hollows: pieces inside another that face the other way than it.

    Returns the pieces, how many were turned, how many are hollows, and the indices of those left out because they
    lie inside another piece and face the same way, which adds nothing to the solid.
    """
    signs = [np.sign(_facing(source, closed)) for source, closed in solid]
    parents = _parents([closed for _, closed in solid])
    redundant: set[int] = set()

    @functools.cache
    def is_material(index: int) -> bool:
        parent = parents[index]
        if parent is None:
            return True
        return is_material(parent) if signs[index] == signs[parent] else not is_material(parent)

    oriented, inverted, cavities = [], 0, 0
    for index, (_, closed) in enumerate(solid):
        parent, material = parents[index], is_material(index)
        if parent is not None and material == is_material(parent):
            redundant.add(index)
            continue
        cavities += int(not material)
        inverted += int((signs[index] > 0) != material)
        outward = signed_volume(closed) > 0
        oriented.append(closed if outward == material else flipped(closed))
    return oriented, inverted, cavities, redundant


def _facing(source: trimesh.Trimesh, closed: trimesh.Trimesh) -> float:
    """Positive where the piece faced outward as it was given: volume of the cone from its own middle."""
    if not Topology.of(source).consistent:
        return 1.0
    about = source.copy()
    about.vertices = about.vertices - closed.bounds.mean(axis=0)
    return signed_volume(about)


def _parents(pieces: list[trimesh.Trimesh]) -> list[int | None]:
    """For every piece, the smallest other piece that holds it whole."""
    from sim.geometry.meshes.winding import WindingNumber

    volumes = [abs(signed_volume(piece)) for piece in pieces]
    bounds = [piece.bounds for piece in pieces]
    tests: dict[int, WindingNumber] = {}
    parents: list[int | None] = []
    for index, piece in enumerate(pieces):
        holders = [
            other
            for other in range(len(pieces))
            if other != index
            and volumes[other] > volumes[index]
            and (bounds[other][0] <= bounds[index][0]).all()
            and (bounds[other][1] >= bounds[index][1]).all()
        ]
        for other in sorted(holders, key=lambda candidate: volumes[candidate]):
            if other not in tests:
                tests[other] = WindingNumber(pieces[other])
            if (tests[other].at(piece.vertices) != 0).all():
                parents.append(other)
                break
        else:
            parents.append(None)
    return parents
