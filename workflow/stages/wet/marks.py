"""What fluid touches is wet, and dries at a constant rate, as porous things do while water reaches their surface from
within (Sherwood 1929, the period of constant rate).

Of bodies, containers and floors it is kept at points of a cubic lattice in their own axes, of cloth at its vertices.
Where a particle touches, at the point of the surface next to it, all corners of the lattice's cell around that point
are wet: what is interpolated between them is 1 there, and 0 farther than two cells away.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from sim.bodies.wall import Wall
from workflow.stages.surface.solids import Solid

TOUCHING = 1.0
"""Particles nearer than this to a surface touch it, in spacings: a layer at rest is half a spacing away."""
LEVEL = 0.999
"""Cosine of the angle between a normal and the vertical up to which a plane is a floor."""
WET_POINT = np.dtype([(name, "<f4") for name in ("x", "y", "z", "wet")])
"""A point of `wet_body_crate_00042.ply`: in the axes of the body at its centre of mass, of others in those of the world
[m]; `wet` is from 0, dry, to 1."""
_CORNERS = np.stack(np.meshgrid(*[(0, 1)] * 3, indexing="ij"), axis=-1).reshape(8, 3)


@dataclass(frozen=True)
class Marks:
    """Points that are wet."""

    node: np.ndarray
    """Coordinates in the lattice, whole numbers in order, shape [n, 3]."""
    wet: np.ndarray
    """From above 0 to 1, shape [n]."""

    @classmethod
    def none(cls) -> Marks:
        """Of what is dry."""
        return cls(np.empty((0, 3), np.int64), np.empty(0, np.float32))

    @classmethod
    def read(cls, points: np.ndarray, cell: float) -> Marks:
        """From WET_POINTs of a lattice of cells [m]."""
        place = np.stack([points[axis] for axis in "xyz"], axis=1).astype(np.float64)
        return cls(np.rint(place / cell).astype(np.int64), points["wet"])

    def points(self, cell: float) -> np.ndarray:
        """As WET_POINTs; shape [n]."""
        found = np.empty(len(self.wet), WET_POINT)
        for axis, column in zip("xyz", self.node.T, strict=True):
            found[axis] = cell * column
        found["wet"] = self.wet
        return found

    def later(self, feet: np.ndarray, cell: float, loss: float) -> Marks:
        """After some time in which what was wet has dried by `loss` [1], at whose end there is fluid at points of the
        surface [m], shape [k, 3]."""
        below = np.floor(feet / cell).astype(np.int64)
        fresh = np.unique((below[:, None] + _CORNERS).reshape(-1, 3), axis=0)
        wet = dried(self.wet, loss)
        node = np.concatenate([self.node[wet > 0], fresh])
        both = np.concatenate([wet[wet > 0], np.ones(len(fresh), np.float32)])
        node, place = np.unique(node, axis=0, return_inverse=True)
        most = np.zeros(len(node), np.float32)
        np.maximum.at(most, place.ravel(), both)
        return Marks(node, most)


def dried(wet: np.ndarray, loss: float) -> np.ndarray:
    """What is left of wetness, float32."""
    return np.maximum(wet.astype(np.float32) - np.float32(loss), np.float32(0.0))


def feet_on_solid(fluid: np.ndarray, solid: Solid, spacing: float) -> np.ndarray:
    """The points of a solid, in its own axes [m], next to particles at `fluid` [m] that touch it; shape [k, 3]."""
    local = (fluid - solid.position) @ solid.turn
    _, foot = solid.body.touching(local, TOUCHING * spacing)
    return foot


def floors(walls: Sequence[Wall]) -> list[float]:
    """Heights of level planes [m], the lowest first."""
    return sorted({wall.offset for wall in walls if wall.normal[1] > LEVEL})


def feet_on_floor(fluid: np.ndarray, height: float, spacing: float) -> np.ndarray:
    """The points of a floor [m] under particles at `fluid` [m] that touch it; shape [k, 3]."""
    near = fluid[np.abs(fluid[:, 1] - height) < TOUCHING * spacing]
    return near * (1.0, 0.0, 1.0) + (0.0, height, 0.0)


def wet_cloth(vertices: np.ndarray, before: np.ndarray, fluid: np.ndarray, spacing: float, loss: float) -> np.ndarray:
    """Wetness of the vertices of a sheet [m], shape [n, 3], after that of `before`, shape [n], has dried by `loss` [1]
    and particles at `fluid` [m] touch it; float32, shape [n]."""
    wet = dried(before, loss)
    if len(fluid):
        away, _ = KDTree(fluid).query(vertices, distance_upper_bound=TOUCHING * spacing)
        wet[np.isfinite(away)] = 1.0
    return wet


def lattices(before: Mapping[str, Marks], feet: Mapping[str, np.ndarray], cell: float, loss: float) -> dict[str, Marks]:
    """The marks of all parts of a frame from those of the frame before; what is new begins dry."""
    return {name: before.get(name, Marks.none()).later(there, cell, loss) for name, there in feet.items()}
