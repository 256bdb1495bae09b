"""Where there is room for fluid among solids and sheets, and how far off these are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sim.bodies.obstacles import Obstacle, Obstacles
from sim.coupling.fluid_solids import allowed
from sim.geometry.distance.clearance import Gap
from sim.geometry.distance.closest_points import MeshDistance
from sim.geometry.solids import MeshSolid

if TYPE_CHECKING:
    from sim.cloth.fabric.state import ClothState
    from sim.cloth.model import PlacedSheet

MATERIALS = ("fluid",)
"""Of a scene, for this to be loaded."""


BENT = 0.5
"""Cosine of the angle between two faces up to which they meet in an edge."""


@dataclass(frozen=True)
class Room:
    """What solids and sheets leave at one time [s]; `state` is what cloth did until then, if it began before."""

    obstacles: Obstacles
    sheets: list[PlacedSheet]
    state: ClothState | None
    time: float

    def free(self, points: np.ndarray, clearance: float) -> np.ndarray:
        """Whether fluid can start at points [m], shape [n, 3], `clearance` [m] off all solids and sheets; shape [n]."""
        free = allowed(self.obstacles, points, clearance, self.time)
        if self.sheets:
            from sim.coupling.fluid_cloth.wet_cloth import off_sheets

            free[free] = off_sheets(self.sheets, self.state, points[free], clearance)
        return free

    def gaps(self, points: np.ndarray, reach: float) -> list[Gap]:
        """The gaps of points [m], shape [n, 3], to sheets and solids that are nearer than `reach` [m] or around them;
        behind a sheet is no solid, so its gaps are never negative."""
        found = [self._to_sheet(item, points, reach) for item in self.sheets]
        for wall in self.obstacles.walls:
            width = points @ wall.normal - wall.offset
            rows = np.flatnonzero(width < reach)
            found.append(Gap(rows, width[rows], np.tile(wall.normal, (len(rows), 1))))
        return found + [self._to_solid(item, points, reach) for item in self.obstacles.placed]

    def faces(self, points: np.ndarray, reach: float) -> list[Gap]:
        """The same as `gaps`, and where faces of a mesh meet in a hollow edge or corner those to the others, too."""
        found, placed = self.gaps(points, reach), self.obstacles.placed
        for item, first in zip(placed, found[len(found) - len(placed) :], strict=True):
            if isinstance(item.solid, MeshSolid):
                second = self._beyond_an_edge(item, points, reach, (first,))
                found += [second, self._beyond_an_edge(item, points, reach, (first, second))]
        return found

    def _beyond_an_edge(self, item: Obstacle, points: np.ndarray, reach: float, before: tuple[Gap, ...]) -> Gap:
        """The gaps to what is nearest from where points come to that are moved off the faces found `before`."""
        met = before[-1].rows
        taken = [gap.away[np.searchsorted(gap.rows, met)] for gap in before]
        seen = self._to_solid(item, points[met] + reach * np.sum(taken, axis=0), 2 * reach)
        turned = [np.einsum("ij,ij->i", away[seen.rows], seen.away) for away in taken]
        width = seen.width - reach * np.sum(turned, axis=0)
        near = np.all(np.array(turned) < BENT, axis=0) & (np.abs(width) < reach)
        return Gap(met[seen.rows[near]], width[near], seen.away[near])

    def _to_solid(self, item: Obstacle, points: np.ndarray, reach: float) -> Gap:
        movement = item.movement(self.time)
        placed = movement.carry_back(points) if movement else points
        rows = np.arange(len(points)) if item.hollow else _within(item.solid.bounds, placed, reach)
        distance, slope = item.solid.distance_and_slope(placed[rows], reach)
        if item.hollow:
            distance, slope = -distance, -slope
        near = distance < reach
        away = slope[near] @ movement.rotation.T if movement else slope[near]
        return Gap(rows[near], distance[near], away)

    def _to_sheet(self, item: PlacedSheet, points: np.ndarray, reach: float) -> Gap:
        import trimesh

        now = self.state.of(item.name) if self.state else None
        places = item.begins if now is None else now[0]
        rows = _within(np.array([places.min(axis=0), places.max(axis=0)]), points, reach)
        surface = trimesh.Trimesh(places, item.fabric.triangles, process=False)
        distance = MeshDistance(surface)
        rows = rows[distance.within(points[rows], reach)]
        foot, width, face = distance.closest(points[rows])
        away = (points[rows] - foot) / np.maximum(width, 1e-300)[:, None]
        on = width < 1e-9 * reach
        away[on] = surface.face_normals[face[on]]
        near = width < reach
        return Gap(rows[near], width[near], away[near])


def _within(bounds: np.ndarray, points: np.ndarray, reach: float) -> np.ndarray:
    """The indices of points that are nearer than `reach` [m] to a box."""
    low, high = bounds
    return np.flatnonzero(np.all((points > low - reach) & (points < high + reach), axis=1))
