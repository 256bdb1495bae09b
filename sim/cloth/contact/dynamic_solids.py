"""Bodies that obey forces, as cloth has them that touches them: each gives way to it as a whole."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.cloth.fabric.arrays import clear, filled, incidence, integers, matrices, numbers, vectors
from sim.cloth.fabric.layout import CoupledBodies
from sim.geometry.components import groups

ROOM = 64
"""Sides of contacts with bodies that there is room for at first."""


@dataclass(frozen=True)
class Meetings:
    """Where bodies touch others, or solids that are moved or at rest, as a step without cloth leaves them."""

    body: np.ndarray
    """Rows of both, -1 of what does not obey forces, shape [n, 2]."""
    arm: np.ndarray
    """From their centres of mass to where they touch [m], shape [n, 2, 3]."""
    normal: np.ndarray
    """Towards the first, shape [n, 3]."""
    gap: np.ndarray
    """[m], shape [n]."""
    friction: np.ndarray
    """Coefficients while sliding and at rest, shape [n, 2]."""
    force: np.ndarray
    """On the first [N], shape [n, 3]."""
    before: np.ndarray
    """The same in the step before, cloth and all."""

    @classmethod
    def none(cls) -> Meetings:
        """Where no body touches anything."""
        return cls(np.zeros((0, 2), int), *(np.zeros((0, *shape)) for shape in ((2, 3), (3,), (), (2,), (3,), (3,))))

    def take(self, rows: np.ndarray) -> Meetings:
        """Those of the given rows, in their order."""
        return Meetings(*(values[rows] for values in vars(self).values()))


@dataclass(frozen=True)
class Bodies:
    """What a step would do to bodies, unless the cloth changes it; so many rows in each."""

    centre: np.ndarray
    """Centres of mass at its end [m], shape [n, 3]."""
    mass: np.ndarray
    """[kg], shape [n]."""
    inertia: np.ndarray
    """About their centres, in the axes of the scene [kg m^2], shape [n, 3, 3]."""
    path_deviation: np.ndarray
    """By how much they are off where their velocities at its end would have taken them [m], shape [n, 3]: what falls
    freely goes on a parabola, what meets something does not."""
    meetings: Meetings


class BodyCoupling:
    """The tables of those bodies. `owner`: of each point of solids the row of its body, -1 where that is moved or at
    rest, shape [m]; `first`: number of the first such point."""

    def __init__(self, owner: np.ndarray, first: int):
        self.owner, self.first = owner, first
        self.count = int(owner.max(initial=-1)) + 1
        rows = 2 * self.count
        self.places = np.zeros((len(owner), 3))
        """Of points of solids, where they go without what is looked for [m]."""
        self._centre = np.zeros((self.count, 3))
        self.mass = np.zeros(self.count)
        """[kg]"""
        self._groups, self._group = self.count, np.arange(self.count)
        self._reach = np.tile([1.0, 0.0], self.count)
        names = ("body_displacement", "body_base", "body_predicted")
        self._arrays = {
            "body_inertia": matrices(rows),
            **{name: vectors(np.zeros((rows, 3))) for name in names},
            "first_body_contact": integers(np.zeros(self.count + 1)),
        }
        self.reach = numbers(self._reach)
        """How far a displacement or turn of 1 takes points of bodies at most."""
        self._make_room(ROOM)
        self.meetings = Meetings.none()
        """Those that what the cloth does to bodies may change."""
        self.all_meetings = self.meetings
        self.taken = np.zeros(0, int)
        """Which they are of all."""
        self.load = np.zeros((self.count, 6))
        """Forces [N] and torques [N m] that bodies are predicted with, and that are looked for anew."""

    def _make_room(self, room: int) -> None:
        """For so many sides of contacts."""
        self._room = room
        self.tables = CoupledBodies(**self._arrays, of_body_contact=integers(np.zeros(room)))

    def predict(self, bodies: Bodies, places: np.ndarray, dt: float) -> None:
        """A step of dt [s] begins, after which points of solids would be at `places` [m], shape [m, 3]."""
        if not self.count:
            return
        self.places, self._centre, self.mass = places, bodies.centre, bodies.mass
        self._path_deviation = bodies.path_deviation
        self.all_meetings, self.meetings, self.taken = bodies.meetings, Meetings.none(), np.zeros(0, int)
        mass_matrix = np.empty((self.count, 2, 3, 3))
        mass_matrix[:, 0] = bodies.mass[:, None, None] * np.eye(3)
        mass_matrix[:, 1] = bodies.inertia
        block = mass_matrix.reshape(-1, 3, 3)
        self._mobility = dt * dt * np.linalg.inv(block)
        self._reach[1::2] = 0.0
        arms = np.linalg.norm(places - self._centre[self.owner], axis=1)
        np.maximum.at(self._reach, 2 * self.owner[self.owner >= 0] + 1, arms[self.owner >= 0])
        filled(self._arrays["body_inertia"], block / (dt * dt))
        filled(self.reach, self._reach)
        clear(self._arrays["body_displacement"])

    def list_contacts(self, key: np.ndarray, weight: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of contacts of the cloth with these points and weights, and of `meetings` after them, the bodies, -1 for
        none, shape [n, 2], sums of weights, [n, 2], and arms [m], [n, 2, 3], as `Contacts` has them; lists all."""
        body, total, arm = self._sides(key, weight)
        if not self.count:
            return body, total, arm
        met = self._meet(np.unique(body[body >= 0]))
        sides = np.where(met.body >= 0, [1.0, -1.0], 0.0)
        arms = sides[:, :, None] * met.arm
        self.load = self.sum(met.body, wrenches(sides, arms, met.force))
        filled(self._arrays["body_predicted"], self._displacements_by(np.zeros((self.count, 6))))
        whole = np.concatenate([body, met.body])
        self._list(whole)
        return whole, np.concatenate([total, sides]), np.concatenate([arm, arms])

    def try_forces(self, wrench: np.ndarray) -> None:
        """Try displacements by forces [N] and torques [N m], shape [n, 6]."""
        filled(self._arrays["body_displacement"], self._displacements_by(wrench))

    def _displacements_by(self, wrench: np.ndarray) -> np.ndarray:
        """Displacements [m] and turns [rad] in a step by forces [N] and torques [N m] in place of those that were
        predicted."""
        displacement = (self._mobility @ (wrench - self.load).reshape(-1, 3, 1))[:, :, 0]
        displacement[::2] += np.where(self._touched[:, None], self._path_deviation, 0.0)
        return displacement

    def _meet(self, touching: np.ndarray) -> Meetings:
        """Find meetings of bodies that the cloth touches, and of all that hang together with them."""
        every = self.all_meetings
        between = every.body[(every.body >= 0).all(axis=1)]
        self._groups, self._group = groups(between[:, 0], between[:, 1], self.count)
        mine = self._touched = np.isin(self._group, self._group[touching])
        self.taken = np.flatnonzero(((every.body >= 0) & mine[every.body]).any(axis=1))
        self.meetings = every.take(self.taken)
        return self.meetings

    def _list(self, body: np.ndarray) -> None:
        first, entry = incidence(np.where(body >= 0, body, self.count), self.count)
        entry = entry[: int(first[-1])]
        if len(entry) > self._room:
            self._make_room(2 * len(entry))
        filled(self._arrays["first_body_contact"], first.astype(np.int32))
        filled(self.tables["of_body_contact"], entry.astype(np.int32))

    def _sides(self, key: np.ndarray, weight: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of contacts of the cloth."""
        body = np.full((len(key), 2), -1)
        total, arm = np.zeros((len(key), 2)), np.zeros((len(key), 2, 3))
        if self.count and len(key):
            corner = key[:, 1:] - self.first
            owner = np.where(corner >= 0, self.owner[np.maximum(corner, 0)], -1)
            body[:, 0] = owner.max(axis=1)
            mine = np.where(owner >= 0, weight, 0.0)
            away = self.places[np.maximum(corner, 0)] - self._centre[body[:, :1]]
            total[:, 0], arm[:, 0] = mine.sum(axis=1), (mine[:, :, None] * away).sum(axis=1)
        return body, total, arm

    def sum(self, body: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Values of the sides of contacts, shape [n, 2, 6], added up by bodies, shape [bodies, 6]."""
        found = np.zeros((self.count, 6))
        np.add.at(found, body[body >= 0], values[body >= 0])
        return found

    def heaviest(self, body: np.ndarray) -> float:
        """The greatest mass that a contact of the cloth bears [kg], of bodies that lie on one another, too, where these
        are the bodies of contacts, shape [n, 2]."""
        if not (self.count and len(body)):
            return 0.0
        number = np.bincount(self._group[body[body >= 0]], minlength=self._groups)
        mass = np.bincount(self._group, self.mass, self._groups)
        return float((mass / np.maximum(number, 1)).max(initial=0.0, where=number > 0))

    def displacements(self) -> tuple[np.ndarray, np.ndarray]:
        """Of bodies displacements [m] and turns [rad] from where they would have gone, both of shape [n, 3]."""
        found = self._arrays["body_displacement"].to_numpy()[: 2 * self.count].reshape(-1, 2, 3)
        return found[:, 0], found[:, 1]

    def moved(self) -> np.ndarray:
        """Where their points, and those of other solids, go with them [m], shape [m, 3]."""
        from scipy.spatial.transform import Rotation

        if not self.count:
            return self.places
        displacement, turn = self.displacements()
        places, mine = self.places.copy(), self.owner >= 0
        owner = self.owner[mine]
        arm = places[mine] - self._centre[owner]
        places[mine] = self._centre[owner] + displacement[owner] + Rotation.from_rotvec(turn)[owner].apply(arm)
        return places

    @property
    def bytes(self) -> int:
        """Memory of the two rows of each body [bytes]."""
        return 8 * self.count * 2 * (9 + 9 + 1)


def wrenches(total: np.ndarray, arm: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Forces and torques on the sides of contacts, shape [n, 2, 6]."""
    return np.concatenate([total[:, :, None] * force[:, None], np.cross(arm, force[:, None])], axis=2)
