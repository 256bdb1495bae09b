"""The arrays of shapes and contacts that kernels take."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from sim.device.compiler import ti
from sim.rigid.body import Body
from sim.rigid.collision.manifold import MOST, Found
from sim.rigid.collision.narrow_phase import Shapes
from sim.rigid.layout import Bounces, Contacts, Pairs, PreviousContacts


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
        self.near = Pairs(
            pair_body=integers(np.zeros(2 * room)),
            number=integers(np.zeros(room)),
            first=integers(np.zeros(room)),
            surface=np.zeros(3 * room),
            scale=np.zeros(room),
        )
        self.found = Found(at=_rows(most), out=_rows(most), apart=np.zeros(most), bend=np.zeros(most))
        self.margin = np.zeros(room)
        self.outcome = np.zeros(2)
        """Of the sweeps over contacts: how many, and what the last one changed [m/s]."""
        self.gap, self.allowed_overlap = np.zeros(most), np.zeros(most)
        self.new_place, self.new_force = _rows(most), _rows(most)
        self.struck, self.target_velocity = integers(np.zeros(most)), np.zeros(most)
        names = ("restitution", "extra", "slow", "bounce", "blow")
        self.bounces = Bounces(
            **{name: np.zeros(most) for name in names}, struck=self.struck, target_velocity=self.target_velocity
        )
        numbers_of = ("limit", "kinetic_friction", "static_friction", "normal_impulse", "normal_mass", "tangent_mass")
        vectors_of = ("place", "normal", "arc_velocity", "friction_impulse", "normal_response", "impulse_change")
        self.table = {name: np.zeros(most) for name in numbers_of} | {name: _rows(most) for name in vectors_of}
        self.table["search_direction"] = _rows(most)
        self.table["body"] = integers(np.zeros(2 * most))
        self.pressed = Contacts(**self.table)
        self.bouncing = Contacts(**(self.table | {"limit": self.target_velocity}))
        self.parting_speed, self.parting_impulse, none = np.zeros(most), np.zeros(most), np.zeros(most)
        self.parting_friction = _rows(most)
        own = {"limit": self.parting_speed, "normal_impulse": self.parting_impulse}
        own |= {"friction_impulse": self.parting_friction, "kinetic_friction": none, "static_friction": none}
        self.parting = Contacts(**(self.table | own | {"arc_velocity": _rows(most)}))
        self._make_room_for_previous(most)

    def _make_room_for_previous(self, room: int) -> None:
        self._previous_room = room
        self.previous = PreviousContacts(
            first_previous=integers(np.zeros(2 * self.room)),
            previous_body=integers(np.zeros(2 * room)),
            previous_place=_rows(room),
            previous_force=_rows(room),
        )

    def list_previous(self, pairs: np.ndarray, place: np.ndarray, force: np.ndarray) -> None:
        """Take contacts of the step before: pairs of bodies, shape [n, 2], in order; places [m] and forces [N], shape
        [n, 3]."""
        count = len(place)
        if count > self._previous_room:
            self._make_room_for_previous(2 * count)
        self.previous.previous_body[: 2 * count] = pairs.ravel()
        self.previous.previous_place[:count] = place
        self.previous.previous_force[:count] = force

    def members(self, count: int) -> dict[str, np.ndarray]:
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
