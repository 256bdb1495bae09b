"""The bounces of a step, which give back no more energy than they took.

Restitution is that of velocities (`restitution`). With friction it can ask for more energy than there was, where a blow
reverses sliding, while the velocity along the normal has to be what it was before (Stronge 1991). Bodies that hang
together by contacts then bounce by as much less as takes the gain away.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sim.geometry.components import groups
from sim.rigid.collision.arrays import integers
from sim.rigid.dynamics import contact_solver, restitution
from sim.rigid.layout import Motion
from sim.rigid.spec import Rigid

if TYPE_CHECKING:
    from sim.rigid.bodies import RigidBodies
    from sim.rigid.collision.detection import Detection

MOST_ROUNDS = 100
"""Of blows that pass from pair to pair."""
HALVINGS = 10
"""Of the interval in which the share is sought by which bodies bounce less."""
EQUAL = 1e-6
"""Share of the energies by which they differ from rounding."""


class Rebounds:
    """Lets `bodies` bounce whose `contacts` were struck; gravity: its magnitude [m/s^2]; met: the motion of the bodies
    from where they were when contacts were found."""

    def __init__(self, bodies: RigidBodies, contacts: Detection, settings: Rigid, gravity: float, met: Motion):
        self.bodies = bodies
        self.contacts = contacts
        self.settings = settings
        self.gravity = gravity
        self._met = met
        self._blow = np.zeros((3, bodies.count, 3))
        self._blown = bodies.moving_as(*self._blow)
        self._braked = integers(np.zeros(bodies.count))

    def strike(self, dt: float, braked: np.ndarray) -> None:
        """Bounce at the end of a step dt [s]; `braked`: bodies that may have been stopped by something else, too."""
        bodies, count, tables = self.bodies, self.contacts.count, self.contacts.tables
        self._braked[:] = braked
        struck = restitution.approach(
            count,
            dt,
            self.gravity,
            tables.gap,
            self._braked,
            bodies.step_velocities,
            self._met,
            tables.pressed,
            tables.bounces,
        )
        if not struck:
            return
        self._blow[0], self._blow[1] = bodies.old_velocity, bodies.old_spin
        pairs = len(self.contacts.pairs)
        restitution.rebound(pairs, MOST_ROUNDS, tables.near, self._blown, tables.pressed, tables.bounces)
        self._solve()
        self._give_back_no_more_than_was_taken()
        hit = np.repeat(tables.struck[:count] == 2, 2)
        bodies.velocity_lag[tables.table["body"][: 2 * count][hit]] = 0.0

    def _solve(self) -> None:
        most, error = self.settings.max_iterations, self.settings.contact_error
        tables = self.contacts.tables
        contact_solver.solve(self.contacts.count, 0, most, error, self.bodies.motion, tables.bouncing, tables.outcome)

    def _give_back_no_more_than_was_taken(self) -> None:
        """Find by bisection how much less the bodies of each group bounce that have gained energy."""
        bodies, count, tables = self.bodies, self.contacts.count, self.contacts.tables
        pair = tables.table["body"][: 2 * count].reshape(-1, 2)
        dynamic = bodies.dynamic[pair]
        both = dynamic.all(axis=1)
        number, group = groups(pair[both, 0], pair[both, 1], bodies.count)
        of_contact = group[np.where(dynamic[:, 0], pair[:, 0], pair[:, 1])]
        before = np.bincount(group, self._energy_before(), number)

        def gains() -> np.ndarray:
            after, done = self._energy_after(), self._work_done(pair)
            gained = np.bincount(group, after - done, number) - before
            return gained > EQUAL * (before + np.bincount(group, after, number))

        gaining = gains()
        if not gaining.any():
            return
        struck = tables.struck[:count] == 2
        whole = tables.target_velocity[:count].copy()
        low, high = np.where(gaining, 0.0, 1.0), np.ones(number)

        def bounce(share: np.ndarray) -> None:
            tables.target_velocity[:count] = np.where(struck, share[of_contact], 1.0) * whole
            self._solve()

        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            bounce(middle)
            too_much = gains()
            low, high = np.where(too_much, low, middle), np.where(too_much, middle, high)
        bounce(low)

    def _energy_before(self) -> np.ndarray:
        """Kinetic energy [J] of each body before the step or at its end if nothing were met, the greater one."""
        bodies = self.bodies
        found = np.zeros((2, bodies.count))
        for row, (velocity, spin) in enumerate(
            ((bodies.old_velocity, bodies.old_spin), (bodies.free_velocity, bodies.free_spin))
        ):
            momentum = np.linalg.solve(bodies.inverse_inertia[bodies.dynamic], spin[bodies.dynamic, :, None])[..., 0]
            found[row, bodies.dynamic] = self._kinetic(velocity[bodies.dynamic], spin[bodies.dynamic], momentum)
        return found.max(axis=0)

    def _energy_after(self) -> np.ndarray:
        """Kinetic energy [J] of each body."""
        bodies = self.bodies
        momentum = bodies.momentum[bodies.dynamic]
        spin = np.einsum("nij,nj->ni", bodies.inverse_inertia[bodies.dynamic], momentum)
        found = np.zeros(bodies.count)
        found[bodies.dynamic] = self._kinetic(bodies.velocity[bodies.dynamic], spin, momentum)
        return found

    def _work_done(self, pair: np.ndarray) -> np.ndarray:
        """What bodies that do not obey forces have done in the step to each that does, by contacts of these pairs
        [J]."""
        bodies, table, count = self.bodies, self.contacts.tables.table, len(pair)
        found = np.zeros(bodies.count)
        impulse = table["normal_impulse"][:count, None] * table["normal"][:count] + table["friction_impulse"][:count]
        for mine, other, sign in ((0, 1, 1.0), (1, 0, -1.0)):
            led = np.flatnonzero(bodies.dynamic[pair[:, mine]] & ~bodies.dynamic[pair[:, other]])
            leader = pair[led, other]
            arm = table["place"][led] - bodies.position[leader]
            speed = bodies.velocity[leader] + np.cross(bodies.spin[leader], arm)
            np.add.at(found, pair[led, mine], sign * (impulse[led] * speed).sum(axis=1))
        return found

    def _kinetic(self, velocity: np.ndarray, spin: np.ndarray, momentum: np.ndarray) -> np.ndarray:
        mass = self.bodies.mass[self.bodies.dynamic]
        return 0.5 * (mass * (velocity**2).sum(axis=1) + (spin * momentum).sum(axis=1))
