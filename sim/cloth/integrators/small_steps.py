"""Integrators that take many small steps in one, in each of which contacts hold.

What comes near is looked for along the whole of a step: before it, where points would go at their speed, and after it.
Where that finds a new contact, the step is made again with it.
"""

from __future__ import annotations

import math

import numpy as np

from sim.cloth.contact import projection_with_bodies
from sim.cloth.contact.collision import Collisions
from sim.cloth.fabric.arrays import integers, matrices, numbers, vectors
from sim.cloth.fabric.layout import StepMotion
from sim.cloth.fabric.mesh import ClothMesh
from sim.cloth.fabric.pin_places import put
from sim.cloth.integrators import small_step_sums
from sim.cloth.integrators.free_pieces import FreePieces
from sim.device.double import vec3

ROUNDS = 12
"""Of a step, which is made again when it made contacts."""
SWEEPS, MOST_SWEEPS = 4, 1024
"""Of Jacobi's method in a small step: four times as many where something would pass through, and again."""
BEARING = 4.0
"""Sweeps for each mass of a point that a contact has to bear."""
PREDICTED = 1.15
"""Pairs that are predicted to come nearer than this share of their thickness are looked after from the start."""
RECOVERY = 3.0
"""What a limit lacks is made up for e^-3 short of the whole in a step."""


class SmallSteps:
    """Steps a cloth; held points go to where `place` has them, straight."""

    STATISTICS = ("cloth_substeps", "cloth_contacts", "cloth_rounds", "cloth_held_back", "cloth_stuck")
    """Small steps, contacts, how often they were made, points that could not go all their way, and pairs that solids
    push through."""

    past = None
    """They go by no step before."""

    def __init__(self, mesh: ClothMesh, gravity: np.ndarray, collisions: Collisions):
        self.mesh = mesh
        self.gravity = vec3(*gravity)
        self.collisions = collisions
        self._adrift = FreePieces(mesh)
        self._rows = 2 * collisions.bodies.count
        self.motion = StepMotion(
            start=vectors(np.zeros((mesh.total, 3))),
            before=vectors(np.zeros((mesh.count, 3))),
            target=mesh.place,
            active_contacts=numbers(np.zeros(mesh.count)),
            body_mobility=matrices(self._rows),
            body_velocity=vectors(np.zeros((self._rows, 3))),
            body_active_contacts=numbers(np.zeros(self._rows)),
        )
        self._solids = integers(np.arange(mesh.count, mesh.total))
        self.sweeps = SWEEPS
        self._velocity, self._ahead = (vectors(np.zeros((mesh.total, 3))) for _ in range(2))

    def substeps(self, dt: float) -> int:
        """How many small steps a step of dt [s] takes."""
        raise NotImplementedError

    def run(self, dt: float, number: int) -> None:
        """Take so many small steps of dt [s]."""
        raise NotImplementedError

    def advance(self, dt: float) -> dict[str, float]:
        """Step by dt [s]; returns the STATISTICS."""
        mesh, collisions, points, start = self.mesh, self.collisions, self.mesh.points, self.motion.start
        number = self.substeps(dt)
        small_step_sums.remember(mesh.total, dt, points, self._velocity, self._ahead, self.motion)
        collisions.begin(start, dt)
        collisions.find(start, self._ahead, PREDICTED)
        self.sweeps = self._needed_sweeps()
        small_step_sums.rest_bodies(self._rows, dt, collisions.bodies.tables, self.motion)
        for rounds in range(1, ROUNDS + 1):
            small_step_sums.clear_forces(collisions.count, collisions.projected)
            self.run(dt / number, number)
            small_step_sums.carry_solids(mesh.count, mesh.total, dt, points, self.motion)
            self._carry_bodies()
            if not collisions.find(start, points.position, add=rounds < ROUNDS):
                if not len(collisions.narrow) or self.sweeps >= MOST_SWEEPS:
                    break
                self.sweeps *= 4
            if rounds < ROUNDS:
                small_step_sums.put_back(mesh.total, points, self._velocity, self.motion)
                small_step_sums.rest_bodies(self._rows, dt, collisions.bodies.tables, self.motion)
        self._fall_back(dt, number)
        held_back, stuck = collisions.hold_back(start, points.position, points.velocity)
        collisions.end()
        return dict(zip(self.STATISTICS, (number, collisions.count, rounds, held_back, stuck), strict=True))

    def _fall_back(self, dt: float, number: int) -> None:
        """Bring what fell in so many small steps back to where the means of its velocities take it."""
        if not self._adrift.any:
            return
        points, count, gravity = self.mesh.points, self.mesh.count, np.array(self.gravity)
        before, after = (array.to_numpy()[:count] for array in (self._velocity, points.velocity))
        share = self._adrift.falling(self.collisions.contacts, gravity, (after - before) / dt)
        if share is not None:
            small_step_sums.shift(count, -0.5 * share * gravity * dt * dt / number, points)
            self.collisions.find(self.motion.start, points.position, add=False)

    def project_contacts(self, dt: float, number: int, left: int) -> None:
        """Let contacts hold in one of so many small steps of dt [s]."""
        mesh, collisions, bodies = self.mesh, self.collisions, self.collisions.bodies
        sizes, sweeps = (mesh.count, self._rows, collisions.count), self.sweeps if collisions.count else 0
        tables, recovery = (mesh.points, collisions.projected, bodies.tables, self.motion), self.recovery(number)
        if mesh.alone and self._rows:
            projection_with_bodies.project_bodies_alone(*sizes, sweeps, number, left, dt, recovery, *tables)
        elif collisions.count or self._rows:
            projection_with_bodies.begin(*sizes, number, left, dt, recovery, *tables)
            for _ in range(sweeps):
                projection_with_bodies.sweep(*sizes, number, left, dt, *tables)
            projection_with_bodies.end(*sizes, number, dt, *tables)

    def _needed_sweeps(self) -> int:
        """Sweeps of a small step: forces that go on from one to the next follow what is sunk, and come too late for the
        mass that they bear where sweeps do not bring up as much inertia."""
        borne = self.collisions.borne
        if not borne:
            return SWEEPS
        lightest = float(self.mesh.mass[~self.mesh.held].min(initial=math.inf))
        return int(min(max(SWEEPS, math.ceil(BEARING * borne / lightest)), MOST_SWEEPS))

    def _carry_bodies(self) -> None:
        """Put points of bodies to where these have gone."""
        if self._rows:
            places = self.collisions.bodies.moved()
            put(len(places), self._solids, places, self.mesh.points.position)

    @staticmethod
    def recovery(number: int) -> float:
        """Of what a limit lacks, the share that one of so many small steps makes up for."""
        return min(1.0, RECOVERY / number)

    @property
    def alone(self) -> bool:
        """Whether one thread takes all small steps in one launch."""
        return self.mesh.alone and not self._rows

    @property
    def bytes(self) -> int:
        """Memory of its own arrays and of contacts [bytes]."""
        return 8 * (9 * self.mesh.total + 4 * self.mesh.count) + self.collisions.bytes
