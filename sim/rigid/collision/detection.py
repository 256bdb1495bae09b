"""The contacts of a step, with the forces of the step before."""

from __future__ import annotations

import numpy as np

from sim.rigid.bodies import RigidBodies, matrices
from sim.rigid.collision import contact_table
from sim.rigid.collision.arrays import ContactTables, shapes
from sim.rigid.collision.broad_phase import BroadPhase
from sim.rigid.collision.narrow_phase import find_contacts
from sim.rigid.collision.surfaces import Surfaces
from sim.rigid.spec import Rigid

SKIN = 1e-3
"""Contacts are followed from this share of the smaller body's size on, beyond what bodies go in a step."""
ALLOWED_OVERLAP = 1e-4
"""Overlap, as a share of the smaller body, that is left alone."""
ROOM = 64
"""Pairs that there is room for at first."""


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
        self.pairs = np.zeros((0, 2), np.int64)
        self.number = np.zeros(0, np.int32)
        """How many contacts each pair has."""
        self.previous = previous

    def find(self, dt: float) -> int:
        """List contacts of a step of dt [s]; returns how many."""
        self.count = self._find(dt)
        return self.count

    def _find(self, dt: float) -> int:
        bodies = self._bodies
        self.pairs, margin = self._near(dt)
        pairs = len(self.pairs)
        if not pairs:
            return 0
        if pairs > self.tables.room:
            self.tables = ContactTables(2 * pairs)
        tables = self.tables
        scale = np.minimum(bodies.size[self.pairs[:, 0]], bodies.size[self.pairs[:, 1]])
        tables.list_pairs(self.pairs, self._surfaces.of(self.pairs), scale, margin)
        near = tables.near
        find_contacts(
            self._kinds, pairs, near.pair_body, tables.margin, self._shapes, bodies.motion, near.number, tables.found
        )
        self.number = tables.number_contacts(pairs).copy()
        count = int(self.number.sum())
        if not count:
            return 0
        before, place, force = self.previous
        tables.list_previous(self._same(before), place, force)
        contact_table.gather(
            pairs,
            dt,
            near,
            tables.found,
            tables.previous,
            bodies.motion,
            tables.pressed,
            tables.gap,
            tables.bounces,
        )
        tables.allowed_overlap[:count] = np.repeat(ALLOWED_OVERLAP * scale, self.number)
        return count

    def _near(self, dt: float) -> tuple[np.ndarray, np.ndarray]:
        """Pairs of bodies that may touch within the step, sorted, and how far off contacts are looked for [m]."""
        bodies, broad = self._bodies, self.broad_phase
        speed, spin = np.linalg.norm(bodies.velocity, axis=1), np.linalg.norm(bodies.spin, axis=1)
        displacement = dt * (speed + broad.reach * spin)
        skin = SKIN * bodies.size
        pairs = self.near((displacement + skin)[: broad.solids, None])
        pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
        a, b = pairs.T
        return pairs, displacement[a] + displacement[b] + np.minimum(skin[a], skin[b])

    def near(self, reach: np.ndarray | float) -> np.ndarray:
        """Pairs of bodies, one of them dynamic, whose boxes would overlap if larger by `reach` [m] all around."""
        return self.broad_phase.near(self._bodies.position, matrices(self._bodies.rotation), reach)

    def _same(self, before: np.ndarray) -> np.ndarray:
        """Where the contacts of the pairs begin and end among those of the pairs `before`, shape [pairs, 2]."""
        then, now = (pairs[:, 0].astype(np.int64) * self._bodies.count + pairs[:, 1] for pairs in (before, self.pairs))
        return np.column_stack([np.searchsorted(then, now, side=side) for side in ("left", "right")])

    def forces(self, dt: float) -> np.ndarray:
        """On the first body of each contact, by the impulses of a step of dt [s]: [N], shape [count, 3]."""
        table, count = self.tables.table, self.count
        pressing = table["normal_impulse"][:count, None] * table["normal"][:count]
        return (pressing + table["friction_impulse"][:count]) / dt

    @property
    def pair_of_contact(self) -> np.ndarray:
        """Both bodies of each contact, shape [count, 2]."""
        return np.repeat(self.pairs, self.number, axis=0)

    def overlaps(self, share: float) -> list[tuple[str, str, float]]:
        """Names of bodies that are inside each other by more than this share of the smaller one's size, and how deep
        [m]."""
        bodies, count = self._bodies, self._find(0.0)
        if not count:
            return []
        deepest: dict[tuple[int, int], float] = {}
        for (a, b), gap in zip(self.pair_of_contact, self.tables.gap[:count], strict=True):
            deepest[a, b] = max(-float(gap), deepest.get((a, b), 0.0))
        return [
            (bodies.bodies[a].name, bodies.bodies[b].name, depth)
            for (a, b), depth in deepest.items()
            if depth > share * min(bodies.size[a], bodies.size[b])
        ]
