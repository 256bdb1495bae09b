"""The arrays of shapes and contacts that kernels take."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import taichi as ti

from sim.rigid.body import Body
from sim.rigid.collision.manifold import MOST, Found
from sim.rigid.collision.narrow_phase import Shapes
from sim.rigid.dynamics.contact_solver import Contacts


def shape_arrays(bodies: Sequence[Body]) -> dict[str, Any]:
    """The members of `Shapes`."""
    features = [body.shape.features for body in bodies]
    counts = [len(feature.kind) for feature in features]
    centres = [point + body.shift for body in bodies for point in body.shape.features.centre]
    return {
        "kind": integers([body.shape.kind for body in bodies]),
        "size": vectors([body.shape.size for body in bodies]),
        "hollow": integers([body.shape.hollow for body in bodies]),
        "reach": numbers([body.size for body in bodies]),
        "first_feature": integers(np.concatenate(([0], np.cumsum(counts)))),
        "feature": integers([kind for feature in features for kind in feature.kind]),
        "centre": vectors(centres),
        "direction": vectors([direction for feature in features for direction in feature.direction]),
        "rounding": numbers([rounding for feature in features for rounding in feature.rounding]),
        "cone": np.array([cone for feature in features for cone in feature.cone]).reshape(-1, 4),
        **_grids(bodies),
    }


def _grids(bodies: Sequence[Body]) -> dict[str, Any]:
    """Distances of all meshes one after the other, in an array that stays on the device."""
    layout, frame, values, start = [], [], [], 0
    for body in bodies:
        grid = body.shape.grid
        if grid is None:
            layout += [0] * 4
            frame += [0.0] * 4
        else:
            layout += [start, *grid.values.shape]
            frame += [*(grid.low + body.shift), grid.cell]
            values.append(grid.values.ravel())
            start += grid.values.size
    array = ti.ndarray(ti.f32, max(start, 1))
    if values:
        array.from_numpy(np.concatenate(values))
    return {"grid": integers(layout), "frame": numbers(frame), "values": array}


def shapes(bodies: Sequence[Body]) -> Shapes:
    """Those of all bodies, in their order."""
    return Shapes(**shape_arrays(bodies))


class ContactTables:
    """Room for the contacts of `room` pairs: as they are found, and as they are solved, three times.

    `pressed` is what happens in the step; `bouncing` has other limits; `parting` other limits and impulses, and no
    friction. Places, normals and effective masses are the same.
    """

    def __init__(self, room: int):
        self.room = room
        most = room * MOST
        self.number = integers(np.zeros(room))
        """How many were found of each pair."""
        self.found = Found(at=_rows(most), out=_rows(most), apart=np.zeros(most), bend=np.zeros(most))
        self.gap, self.restitution, self.slack = np.zeros(most), np.zeros(most), np.zeros(most)
        self.extra, self.slow, self.blow, self.bounce = (np.zeros(most) for _ in range(4))
        self.struck = integers(np.zeros(most))
        self.table = {name: np.zeros(most) for name in ("limit", "friction", "grip", "push", "along", "across")}
        self.table |= {name: _rows(most) for name in ("place", "normal", "carried", "drag", "gain", "course")}
        self.table["body"] = integers(np.zeros(2 * most))
        self.pressed = Contacts(**self.table)
        self.target = np.zeros(most)
        self.bouncing = Contacts(**(self.table | {"limit": self.target}))
        none = np.zeros(most)
        self.apart, self.thrust, self.slip = np.zeros(most), np.zeros(most), _rows(most)
        own = {"limit": self.apart, "push": self.thrust, "drag": self.slip, "friction": none, "grip": none}
        own["carried"] = _rows(most)
        self.parting = Contacts(**(self.table | own))

    def pressing(self, count: int) -> dict[str, np.ndarray]:
        """The members of `pressed`, of the first `count` contacts."""
        return {name: array[: 2 * count if name == "body" else count] for name, array in self.table.items()}

    @property
    def bytes(self) -> int:
        """Memory of the tables, estimated as twice that of `pressed` [bytes]."""
        return sum(array.nbytes for array in self.table.values()) * 2


def integers(values: Any) -> np.ndarray:
    """Flat, of 32 bits."""
    return np.array(values, dtype=np.int32).reshape(-1)


def numbers(values: Any) -> np.ndarray:
    """Flat, in double precision."""
    return np.array(values, dtype=np.float64).reshape(-1)


def vectors(values: Any) -> np.ndarray:
    """Rows of three, in double precision."""
    return np.array(values, dtype=np.float64).reshape(-1, 3)


def _rows(count: int) -> np.ndarray:
    return np.zeros((count, 3))
