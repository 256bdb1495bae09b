"""The contacts of a step, with the forces of the step before."""

from __future__ import annotations

import numpy as np

from sim.rigid.bodies import RigidBodies, matrices
from sim.rigid.collision import all_pairs, contact_table
from sim.rigid.collision.arrays import ContactTables, shapes
from sim.rigid.collision.broad_phase import BroadPhase
from sim.rigid.collision.narrow_phase import find_contacts
from sim.rigid.collision.surfaces import Surfaces
from sim.rigid.spec import Rigid

ALLOWED_OVERLAP = 1e-4
"""Overlap, as a share of the smaller body, that is left alone."""
ROOM = 64
"""Pairs that there is room for at first."""
FEW = 500
"""Bodies up to which each is tried with each."""


class Detection:
    """Finds contacts of bodies; `count` is how many, `pairs` whose, shape [n, 2], `tables` have them.

    `previous`: pairs of bodies, places [m] and forces [N] of the contacts of the step before, as `RigidState` has them.
    """

    def __init__(self, bodies: RigidBodies, settings: Rigid, previous: tuple[np.ndarray, np.ndarray, np.ndarray]):
        self._bodies = bodies
        self._surfaces = Surfaces(bodies.bodies, settings.pairs)
        self._shapes = shapes(bodies.bodies)
        self._kinds = sum({1 << body.shape.kind for body in bodies.bodies})
        self.broad_phase = BroadPhase(bodies.bodies, bodies.dynamic)
        self.tables = ContactTables(ROOM)
        self.count = 0
        self.pairs = np.zeros((0, 2), np.int32)
        self.previous = previous

    def find(self, dt: float) -> int:
        """List contacts of a step of dt [s]; returns how many."""
        self.count = self._find(dt)
        return self.count

    def _find(self, dt: float) -> int:
        bodies = self._bodies
        pairs = self._list_few(dt) if bodies.count <= FEW else self._list_many(dt)
        if not pairs:
            return 0
        self._look_up(pairs)
        tables = self.tables
        near = tables.near
        find_contacts(
            self._kinds, pairs, near.pair_body, tables.margin, self._shapes, bodies.motion, near.number, tables.found
        )
        tables.list_previous(*self.previous)
        return contact_table.gather(
            pairs,
            len(self.previous[0]),
            dt,
            ALLOWED_OVERLAP,
            near,
            tables.found,
            tables.previous,
            bodies.motion,
            tables.pressed,
            tables.gap,
            tables.allowed_overlap,
            tables.bounces,
        )

    def _list_few(self, dt: float) -> int:
        """List pairs of bodies that may touch within the step, and how far off contacts are looked for."""
        bodies, broad = self._bodies, self.broad_phase
        while True:
            tables = self.tables
            pairs = all_pairs.list_near(
                bodies.count,
                broad.solids,
                dt,
                tables.room,
                broad.boxes,
                bodies.properties,
                bodies.motion,
                tables.near,
                tables.margin,
            )
            if pairs <= tables.room:
                return pairs
            self._make_room(pairs)

    def _list_many(self, dt: float) -> int:
        """The same by a sweep."""
        bodies, broad = self._bodies, self.broad_phase
        speed, spin = np.linalg.norm(bodies.velocity, axis=1), np.linalg.norm(bodies.spin, axis=1)
        displacement = dt * (speed + broad.reach * spin)
        pairs = self.near((displacement + broad.skin)[: broad.solids, None])
        pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
        if len(pairs) > self.tables.room:
            self._make_room(len(pairs))
        a, b = pairs.T
        self.tables.near.pair_body[: pairs.size] = pairs.ravel()
        self.tables.margin[: len(pairs)] = displacement[a] + displacement[b] + np.minimum(broad.skin[a], broad.skin[b])
        return len(pairs)

    def _make_room(self, pairs: int) -> None:
        self.tables = ContactTables(2 * pairs)
        self.pairs = self.pairs[:0]

    def _look_up(self, number: int) -> None:
        """Tell what the bodies of so many pairs that are listed are to each other, unless it is known."""
        near = self.tables.near
        pairs = near.pair_body[: 2 * number].reshape(-1, 2)
        if np.array_equal(pairs, self.pairs):
            return
        self.pairs = pairs.copy()
        near.surface[: 3 * number] = self._surfaces.of(self.pairs).ravel()
        near.scale[:number] = self._bodies.size[self.pairs].min(axis=1)

    def near(self, reach: np.ndarray | float) -> np.ndarray:
        """Pairs of bodies, one of them dynamic, whose boxes would overlap if larger by `reach` [m] all around."""
        return self.broad_phase.near(self._bodies.position, matrices(self._bodies.rotation), reach)

    def forces(self, dt: float) -> np.ndarray:
        """On the first body of each contact, by the impulses of a step of dt [s]: [N], shape [count, 3]."""
        table, count = self.tables.table, self.count
        pressing = table["normal_impulse"][:count, None] * table["normal"][:count]
        return (pressing + table["friction_impulse"][:count]) / dt

    @property
    def pair_of_contact(self) -> np.ndarray:
        """Both bodies of each contact, shape [count, 2]."""
        return self.tables.table["body"][: 2 * self.count].reshape(-1, 2)

    def overlaps(self, share: float) -> list[tuple[str, str, float]]:
        """Names of bodies that are inside each other by more than this share of the smaller one's size, and how deep
        [m]."""
        bodies, count = self._bodies, self.find(0.0)
        deepest: dict[tuple[int, int], float] = {}
        for (a, b), gap in zip(self.pair_of_contact.tolist(), self.tables.gap[:count], strict=True):
            deepest[a, b] = max(-float(gap), deepest.get((a, b), 0.0))
        return [
            (bodies.bodies[a].name, bodies.bodies[b].name, depth)
            for (a, b), depth in deepest.items()
            if depth > share * min(bodies.size[a], bodies.size[b])
        ]
