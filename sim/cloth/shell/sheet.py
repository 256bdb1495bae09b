"""The shell of one sheet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scene.settings import Refused
from sim.cloth.fabric.fabric import Fabric
from sim.cloth.shell.curvature import Bending, find_bending
from sim.cloth.shell.membrane import Membrane, find_membrane
from sim.cloth.spec import ClothSheet
from sim.geometry.pose import Pose

THIN = 1e-9
"""Triangles with less area than this share of the mean have no stiffness that could be computed."""


@dataclass(frozen=True)
class SheetShell:
    """How it resists stretching and bending, and where its points are at rest [m], shape [n, 3]."""

    membrane: Membrane
    bending: Bending
    places: np.ndarray


def find_shell(sheet: ClothSheet, fabric: Fabric) -> SheetShell:
    """Of a sheet as placed.

    Raises Refused, located within the sheet, where its triangles form no surface.
    """
    places, warp = sheet.rest_scale * fabric.points, Pose.of(sheet).rotation @ np.array(sheet.woven.warp)
    try:
        _refuse_thin(places, fabric.triangles)
        bending = find_bending(sheet, places, fabric.triangles, warp)
    except Refused as refused:
        raise refused.at("shape") from None
    return SheetShell(find_membrane(sheet, places, fabric.triangles, warp), bending, places)


def _refuse_thin(points: np.ndarray, triangles: np.ndarray) -> None:
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    thin = np.flatnonzero(area <= THIN * area.mean())
    if len(thin):
        place = np.round((a + b + c)[thin[0]] / 3, 4).tolist()
        raise Refused(
            f"{len(thin)} triangles have no area, one of them at {place}",
            remedy="remove them from the mesh, or take cloth.model: springs",
        )
