"""The solids that the fluid meets, on the device: shapes in their own frames, and where these are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.device.arrays import integer_array, numpy_real, real, vec2, vec4
from sim.device.compiler import ti
from sim.fluid.boundary.calibration import curvature_shift
from sim.fluid.layout import Solids
from sim.geometry.distance.narrow_band import BLOCK, NarrowBand
from sim.geometry.distance.sdf import PLANE
from sim.geometry.primitives import Primitive

MOTION = 18
"""Numbers that say how a body has moved: rotation (9, by rows), position, velocity and angular velocity (3 each): its
point x is now at rotation (x - pivot) + position."""
POSE = 21
"""Numbers that say where the own frame of a solid is: rotation (9, by rows), origin, velocity and angular velocity (3
each), and the point that moves with this velocity."""


@dataclass(frozen=True)
class BoundarySolid:
    """shape, as it is placed in the world; band: of a mesh; pivot: own origin [m] of a body that moves, shape [3].

    hollow: the fluid is inside. thin: whether particles on two sides of it come within the support radius.
    free: whether it obeys forces. thickness [m]: diameter of the largest ball
    inside.
    """

    shape: Primitive
    band: NarrowBand | None = None
    pivot: np.ndarray | None = None
    hollow: bool = False
    thin: bool = False
    free: bool = False
    thickness: float = np.inf


def half_space(normal: np.ndarray, offset: float) -> BoundarySolid:
    """The solid below the plane normal . x = offset [m]."""
    side = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    side /= np.linalg.norm(side)
    turn = np.column_stack((side, normal, np.cross(side, normal)))
    return BoundarySolid(Primitive(PLANE, np.zeros(3), offset * normal, turn, np.full(3, np.inf)))


SLIM = 2.0
"""Spacings under which a body is slim."""


class Shapes:
    """Tables of all solids, relative to `origin` [m]; those with a pivot have a row in `move`, in their order.

    spacing: of the fluid [m]. all_hold: whether those that obey forces hold fluid along their surfaces, too.
    """

    def __init__(
        self, solids: Sequence[BoundarySolid], origin: np.ndarray, spacing: float, h: float, *, all_hold: bool = False
    ):
        self.solids = list(solids)
        self.count = len(self.solids)
        self.kinds = sum(1 << kind for kind in {solid.shape.kind for solid in self.solids})
        """A bit for each kind that there is."""
        self.moving = [index for index, solid in enumerate(self.solids) if solid.pivot is not None]
        self.bodies = sum(solid.shape.kind != PLANE for solid in self.solids)
        self.meshes = any(solid.band is not None for solid in self.solids)
        self.thin = any(solid.thin for solid in self.solids)
        self.kind = integer_array(np.array([solid.shape.kind for solid in self.solids] or [0]))
        self.firm = integer_array(np.array([not solid.free for solid in self.solids] or [True]))
        """1 where it obeys no forces."""
        self.holds = integer_array(np.array([all_hold or not solid.free for solid in self.solids] or [True]))
        """Whether it holds what is along it."""
        self.slim = integer_array(np.array([solid.thickness < SLIM * spacing for solid in self.solids] or [False]))
        """1 where it is too thin to weigh much against the pressure around it."""
        signs = np.array([-1.0 if solid.hollow else 1.0 for solid in self.solids] or [1.0])
        sizes = np.array([solid.shape.size for solid in self.solids]).reshape(-1, 3)
        self.size = self._vectors(np.column_stack((sizes, signs[: self.count])))
        self._fill_bands()
        self.pose = ti.ndarray(ti.f64, (max(self.count, 1), POSE))
        self.boxes = ti.ndarray(ti.f64, (max(self.count, 1), 6))
        self.tables = Solids(
            vec2(*curvature_shift(spacing, h)),
            self.pose,
            self.boxes,
            self.kind,
            self.size,
            self.firm,
            self.holds,
            self.slim,
            self.frame,
            self.lattice,
            self.table,
            self.nodes,
            self.bend,
        )
        self._poses = np.zeros((self.count, POSE))
        for index, solid in enumerate(self.solids):
            self._poses[index, :9] = solid.shape.turn.ravel()
            self._poses[index, 9:12] = solid.shape.origin - origin
        self._half = np.array([solid.shape.half for solid in self.solids]).reshape(-1, 3)
        self._gravity, self._level = np.zeros(3), 0.0
        self.speed = 0.0
        """Of the fastest point of a surface [m/s] of a solid that has not fallen below all others."""
        self._upload()

    def set_floor(self, gravity: np.ndarray, level: float) -> None:
        """Say where the potential of gravity is that of the lowest point of the scene, -level [m^2/s^2]."""
        self._gravity, self._level = gravity, level

    def move(self, motions: np.ndarray) -> None:
        """Bring those that move to where these motions take them; shape [moving, MOTION]."""
        for row, index in zip(motions, self.moving, strict=True):
            solid, pose = self.solids[index], self._poses[index]
            rotation = row[:9].reshape(3, 3)
            pose[:9] = (rotation @ solid.shape.turn).ravel()
            pose[9:12] = rotation @ (solid.shape.origin - solid.pivot) + row[9:12]
            pose[12:18] = row[12:18]
            pose[18:21] = row[9:12]
        if self.moving:
            moved = self._poses[self.moving]
            reach = np.linalg.norm(self._half[self.moving], axis=1)
            reach += np.linalg.norm(moved[:, 9:12] - moved[:, 18:21], axis=1)
            speeds = np.linalg.norm(moved[:, 12:15], axis=1) + reach * np.linalg.norm(moved[:, 15:18], axis=1)
            highest = moved[:, 9:12] @ self._gravity - reach * np.linalg.norm(self._gravity)
            self.speed = float(speeds[highest + self._level <= 0.0].max(initial=0.0))
            self._upload()

    def _upload(self) -> None:
        if not self.count:
            return
        turns = self._poses[:, :9].reshape(-1, 3, 3)
        with np.errstate(invalid="ignore"):
            half = np.nan_to_num(np.abs(turns) @ self._half[:, :, None], nan=np.inf)[:, :, 0]
        boxes = np.concatenate((self._poses[:, 9:12] - half, self._poses[:, 9:12] + half), axis=1)
        self.pose.from_numpy(self._poses)
        self.boxes.from_numpy(boxes)

    def _fill_bands(self) -> None:
        frames, tables, nodes, bends = np.zeros((max(self.count, 1), 4)), [], [], []
        shapes = np.zeros((max(self.count, 1), 4), np.int32)
        first_block, first_entry = 0, 0
        for index, solid in enumerate(self.solids):
            band = solid.band
            if band is None:
                continue
            frames[index] = *band.low, band.cell
            shapes[index] = first_entry, *band.table.shape
            tables.append(np.where(band.table < 0, -1, band.table + first_block).ravel())
            nodes.append(band.nodes)
            bends.append(band.curvature)
            first_block += len(band.nodes) // BLOCK**3
            first_entry += band.table.size
        self.frame = ti.ndarray(ti.f64, frames.shape)
        self.frame.from_numpy(frames)
        self.lattice = integer_array(shapes)
        self.table = integer_array(np.concatenate(tables) if tables else np.full(1, -1))
        self.nodes = self._vectors(np.concatenate(nodes) if nodes else np.zeros((1, 4)))
        self.bend = ti.ndarray(real, self.nodes.shape[0])
        self.bend.from_numpy(np.concatenate([*bends, *([] if bends else [np.zeros(1)])]).astype(numpy_real))

    @staticmethod
    def _vectors(values: np.ndarray) -> ti.Ndarray:
        array = ti.ndarray(vec4, max(len(values), 1))
        if len(values):
            array.from_numpy(values.astype(numpy_real))
        return array

    @property
    def bytes(self) -> int:
        """Memory of the tables of solids, and of the distances around meshes [bytes]."""
        numbers = self.nodes.shape[0] * 5 * np.dtype(numpy_real).itemsize + 4 * self.table.shape[0]
        return numbers + 8 * (POSE + 6 + 4 + 4) * self.count
