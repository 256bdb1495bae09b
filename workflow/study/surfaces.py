"""Quantities of a reconstructed surface."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import trimesh

from scene.settings import Refused
from workflow.study import formula
from workflow.study.spec import Formula, Quantity

MOST = 20_000
"""Vertices for which a formula is computed: evenly taken from more."""


def measure(quantity: Quantity, folder: Path) -> float:
    """Volume [m^3], area [m^2], or RMS of the distance [m] of the one surface in a folder; raises Refused."""
    mesh = trimesh.load_mesh(next(iter(sorted(folder.glob("surface_*.ply")))), process=False)
    if not len(mesh.faces):
        raise Refused("there is no surface", location=("frame",), remedy="choose a frame with particles")
    if quantity.distance is not None:
        return _distance(quantity.distance, mesh.vertices)
    return float(mesh.volume if quantity.column == "volume" else mesh.area)


def _distance(distance: Formula, vertices: np.ndarray) -> float:
    chosen = vertices[:: math.ceil(len(vertices) / MOST)]
    try:
        found = [formula.evaluate(distance, dict(zip("xyz", place, strict=True))) for place in chosen.tolist()]
    except Refused as refused:
        raise refused.at("quantity", "distance") from None
    return math.sqrt(sum(value * value for value in found) / len(found))
