"""Contacts on the device: those of the cloth, and after them those of bodies that it may change."""

from __future__ import annotations

import numpy as np

from sim.cloth.contact.contact_set import ContactSet
from sim.cloth.contact.dynamic_solids import Meetings
from sim.cloth.fabric.arrays import filled, incidence, integers, numbers, vectors
from sim.cloth.fabric.layout import Contacts, ProjectedContacts
from sim.device.compiler import ti

ROOM = 64
"""Contacts that there is room for at first."""


class ContactTables:
    """The arrays of contacts of a cloth of so many points, as Newton's method and as small steps take them."""

    def __init__(self, points: int):
        self._points = points
        self._make_room(ROOM)

    def fill(
        self,
        cloth: ContactSet,
        friction: np.ndarray,
        met: Meetings,
        met_force: np.ndarray,
        sides: tuple[np.ndarray, np.ndarray, np.ndarray],
    ) -> None:
        """Take n contacts of the cloth, with coefficients of friction while sliding and at rest, shape [n, 2], and m of
        bodies, whose forces are `met_force` [N], shape [m, 3]; sides: bodies, sums of weights and arms of all, as
        `BodyCoupling.list_contacts` has them."""
        own, count = len(cloth.key), len(cloth.key) + len(met_force)
        if count > self.room:
            self._make_room(2 * count)
        push = np.maximum((met_force * met.normal).sum(axis=1), 0.0)
        normal_force = np.concatenate([cloth.normal_force, push])
        limit = np.concatenate([cloth.limit, -np.maximum(met.gap, 0.0)])
        first, entry = incidence(cloth.key[:, 1:], self._points)
        body, body_weight, body_arm = sides
        filled(self.thickness, np.concatenate([cloth.thickness, np.ones(count - own)]))
        for name, values in (
            ("corner", np.concatenate([cloth.key[:, 1:].ravel(), np.full(4 * (count - own), -1)])),
            ("weight", np.concatenate([cloth.weight, np.zeros((count - own, 4))])),
            ("body", body.ravel()),
            ("body_weight", body_weight.ravel()),
            ("body_arm", body_arm.reshape(-1, 3)),
            ("normal", np.concatenate([cloth.normal, met.normal])),
            ("law", np.column_stack([limit, np.concatenate([friction, met.friction]), normal_force])),
            ("normal_force", normal_force),
            ("friction_force", np.concatenate([cloth.friction_force, met_force - push[:, None] * met.normal])),
            ("first_contact", first),
            ("of_contact", entry),
        ):
            filled(self._arrays[name], values.astype(np.int32) if values.dtype.kind == "i" else values)

    def multipliers(self, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Forces of the first `count` contacts along the normal, shape [count], and of friction, [count, 3] [N]."""
        return tuple(self._arrays[name].to_numpy()[:count] for name in ("normal_force", "friction_force"))

    def forces(self, count: int) -> np.ndarray:
        """Of the first `count` contacts in the step [N], shape [count, 3]."""
        return self._arrays["contact_force"].to_numpy()[:count]

    def _make_room(self, room: int) -> None:
        self.room = room
        one, three = np.zeros(room), np.zeros((room, 3))
        solved = ("tangent_stiffness", "trial_force", "relative_displacement", "force_change")
        self._arrays = {
            "corner": integers(np.zeros(4 * room)),
            "body": integers(np.full(2 * room, -1)),
            "body_weight": numbers(np.zeros(2 * room)),
            "body_arm": vectors(np.zeros((2 * room, 3))),
            **{name: ti.Vector.ndarray(4, ti.f64, room) for name in ("weight", "law")},
            **{name: vectors(three) for name in ("normal", "friction_force", "contact_force", *solved)},
            **{name: numbers(one) for name in ("stiffness", "normal_force")},
            "active": integers(np.ones(room)),
            "first_contact": integers(np.zeros(self._points + 1)),
            "of_contact": integers(np.zeros(4 * room)),
        }
        self.newton = Contacts(**{name: self._arrays[name] for name in Contacts.members})
        small = self._arrays | {
            "active_limit": self._arrays["tangent_stiffness"],
            "before_step": self._arrays["trial_force"],
        }
        self.projected = ProjectedContacts(**{name: small[name] for name in ProjectedContacts.members})
        self.thickness = numbers(one)

    @property
    def bytes(self) -> int:
        """Memory of all arrays, about [bytes]."""
        return 4 * self.room * 8 * 8
