"""How far the action reaches, in space: what the camera frames, and the ground that it stands on."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.bodies.planes import PlaneWall

if TYPE_CHECKING:
    from sim.run.placing.placed_scene import PlacedScene

LEVEL = 0.999
"""Cosine of the angle between a normal and the vertical up to which a plane is a floor."""
STEEP = 0.1
"""Likewise, down to which something lands on a plane."""


def filmed(placed: PlacedScene) -> dict[str, Any]:
    """What pictures need to know before they are drawn: `extent`, the box around all that is placed and around where
    it falls on planes (min, max [m]), and `ground`: the height of the level plane that nothing is below [m], and that
    at which the middle of the thinnest cloth lies over it [m]; null where there is none."""
    points = np.concatenate([placed.bounds, *_landings(placed)])
    obstacles = placed.obstacles
    floors = [wall.offset for wall in obstacles.walls if wall.normal[1] > LEVEL and wall.body not in obstacles.boxes]
    thinnest = min((item.sheet.thickness for item in placed.sheets), default=None)
    return {
        "extent": {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()},
        "ground": {
            "height": max(floors, default=None),
            "cloth": None if thinnest is None else thinnest / 2,
        },
    }


def _landings(placed: PlacedScene) -> Iterator[np.ndarray]:
    """Where what is free to fall meets the first plane under it [m]: the lower corners of its boxes."""
    strength = float(np.linalg.norm(placed.gravity))
    if strength == 0.0:
        return
    boxes = [inflow.bounds for inflow in placed.inflows]
    boxes += [sheet.bounds for sheet in placed.sheets if not sheet.held.any()]
    boxes += [item.bounds for item in placed.obstacles.dynamic.values()]
    for box in boxes:
        corners = np.stack(np.meshgrid(*np.transpose(box), indexing="ij"), axis=-1).reshape(8, 3)
        yield from _under(corners, placed.gravity / strength, placed.obstacles.walls)


def _under(points: np.ndarray, down: np.ndarray, walls: list[PlaneWall]) -> Iterator[np.ndarray]:
    """Where each of the points falls on the first of the planes that it falls on, shape [1, 3] each."""
    for point in points:
        ways = [
            (wall.offset - float(point @ wall.normal)) / float(down @ wall.normal)
            for wall in walls
            if float(down @ wall.normal) < -STEEP
        ]
        ways = [way for way in ways if way > 0.0]
        if ways:
            yield (point + min(ways) * down)[None]
