"""Implicit Euler: stable at any stiffness and step (Baraff & Witkin 1998), by Newton's method.

It takes from an oscillation of angular frequency w the share 1 - (1 + w^2 dt^2)^(-1/2) a step, whatever the damping.
Where nothing touches, now and in the step before, backward differences of second order
(`sim.cloth.integrators.backward_differences`) take only w^4 dt^4 / 4; across an impact they would throw back what it
has stopped.
"""

from __future__ import annotations

import numpy as np

from sim.cloth.contact.collision import Collisions
from sim.cloth.fabric.arrays import integers, numbers
from sim.cloth.fabric.mesh import ClothMesh
from sim.cloth.fabric.pin_places import put
from sim.cloth.integrators.backward_differences import BackwardDifferences
from sim.cloth.integrators.free_pieces import FreePieces
from sim.cloth.integrators.newton import trial as trials
from sim.cloth.integrators.newton.solver import Newton
from sim.cloth.spec import Cloth
from sim.device.compiler import ti
from sim.device.double import vec3

INERTIAS = 16.0
"""Contact stiffness over the inertia of their points in a step. Springs are much stiffer:
with their stiffness, contacts that close and open would decide how many steps Newton's method takes."""
SINKING = 0.05
"""Shares of the thickness that multipliers may let contacts sink in: where that asks for more stiffness, but not for
more than SPRINGS times that of the cloth there."""
SPRINGS = 10.0
SUNK = 0.25
"""With more of these, multipliers are updated, and all is solved again."""
SUNK_BY_BODIES = 0.001
"""Where bodies lie on cloth: what is left of an error there goes on into the next step as their speed."""
ROUNDS = 12
"""Of looking for contacts that the last solution made."""
GIVING_WAY = 1e-3
"""What is left of a force over the whole of it, when it is asked how points give way."""
UNSOLVED = 100.0
"""Forces left at a cap, over those that act, from which on what moves is left to chance."""


class ImplicitEuler:
    """Steps a cloth; held points go to where `place` has them."""

    STATISTICS = (
        "cloth_newton",
        "cloth_iterations",
        "cloth_capped",
        "cloth_contacts",
        "cloth_rounds",
        "cloth_held_back",
        "cloth_stuck",
        "cloth_unsolved",
    )
    """Newton's steps, iterations of conjugate gradients in all of them, and whether one of the two ended at its cap;
    contacts, searches for them, points that could not go all their way, pairs that solids push through, and whether
    the last cap was met far from a solution."""

    def __init__(self, mesh: ClothMesh, gravity: np.ndarray, settings: Cloth, collisions: Collisions):
        self.mesh = mesh
        self.collisions = collisions
        self.gravity = vec3(*gravity)
        self._newton = Newton(mesh, gravity, settings.integrator_settings, collisions)
        self.trial = self._newton.trial
        self.past = BackwardDifferences(mesh.count)
        self._start = mesh.points.position
        self._adrift = FreePieces(mesh)
        self._solids = integers(np.arange(mesh.count, mesh.total))
        self._pushed = False
        """Whether others act on points in the step."""
        self._falls, self._rests = numbers(self._adrift.free), numbers(np.zeros(mesh.count))

    def limits(self) -> dict[str, float]:
        """Largest steps [s] by what limits them: none."""
        return {}

    def advance(self, dt: float) -> dict[str, float]:
        """Step by dt [s]; returns the STATISTICS."""
        self.predict(dt)
        return self.commit(dt)

    def predict(self, dt: float, load: ti.Ndarray | None = None) -> None:
        """Find where a step of dt [s] with these forces of others on points [N] takes them, in `trial.place`."""
        self._pushed = load is not None
        if not self._pushed and self._predict_untouched(dt):
            return
        self._begin(dt, 1.0, 0.0, dt)
        if self._pushed:
            trials.add_load(self.mesh.count, dt, self.mesh.points, load, self.trial)
        self.collisions.find(self._start, self.trial.place)
        self._carry(self.collisions.bodies.places)
        self._counts, self._rounds = np.zeros(3, int), 0
        self._part(dt)

    def _predict_untouched(self, dt: float) -> bool:
        """The same to the second order of the step, if that is such that nothing touches; returns whether it is."""
        if self.collisions.count or not self.past.serves(dt):
            return False
        self._begin(dt, *self.past.weights(dt))
        self._counts, self._rounds = self._newton.converge(self._since), 1
        self._keep_momentum(self._since)
        return not (self.collisions.count or self.collisions.find(self._start, self.trial.place, add=False))

    def _begin(self, dt: float, now: float, ago: float, since: float) -> None:
        """Begin a step of dt [s] with these weights of the present and of the step before, and the time [s] since its
        start."""
        mesh, trial, past = self.mesh, self.trial, self.past
        self._since = since
        # What touches something is at rest more often than it falls.
        falls = self._rests if self.collisions.count else self._falls
        turning = trials.begin(mesh.total, since, falls, now, ago, past.position, past.velocity, mesh.model, trial)
        if self._newton.begin(turning > 0):
            # From beyond a spring that has gone through itself, Newton's method finds the cloth inside out.
            trials.stay(mesh.count, mesh.points, trial)
        self.collisions.begin(self._start, dt)
        self._carry(self.collisions.bodies.moved())

    def change(self, dt: float, load: ti.Ndarray) -> None:
        """Let forces on points [N] act besides those predicted, and look where that takes them."""
        trials.add_load(self.mesh.count, dt, self.mesh.points, load, self.trial)
        if self.collisions.bodies.count:
            self.collisions.begin_again()
        self._part(dt)

    def linearize(self, dt: float) -> None:
        """Find how points give way to forces where they are predicted."""
        self._newton.linearize(dt)

    def respond(self, load: ti.Ndarray) -> ti.Ndarray:
        """By what displacements [m] points give way to forces [N] that act in the step, by `linearize`."""
        return self._newton.respond(load, GIVING_WAY)

    def commit(self, dt: float) -> dict[str, float]:
        """Take the step to where it was predicted; returns the STATISTICS."""
        mesh, trial, collisions = self.mesh, self.trial, self.collisions
        back = self._fall_back(dt)
        held_back, stuck = collisions.hold_back(self._start, trial.place)
        collisions.end()
        steps, iterations, capped = self._counts.tolist()
        values = (
            steps,
            iterations,
            int(capped > 0),
            collisions.count,
            self._rounds,
            held_back,
            stuck,
            int(self._newton.left > UNSOLVED),
        )
        past = self.past
        trials.finish(mesh.count, mesh.total, dt, self._since, past.position, past.velocity, mesh.points, trial)
        # Differences over two steps would let what pushed in the first act on in the second.
        past.step = 0.0 if collisions.count or held_back or self._pushed else dt
        if back is not None:
            trials.accelerate(mesh.count, -dt, back, mesh.points)
        return dict(zip(self.STATISTICS, values, strict=True))

    def _fall_back(self, dt: float) -> np.ndarray | None:
        """Bring what falls back to where the mean of its velocities takes it, by these accelerations [m/s^2], shape
        [points, 3]; None where nothing falls."""
        if not self._adrift.any or self._since < dt:
            # Backward differences of second order do so by themselves.
            return None
        mesh, trial, gravity = self.mesh, self.trial, np.array(self.gravity)
        before, start, place = (
            array.to_numpy()[: mesh.count] for array in (mesh.points.velocity, self._start, trial.place)
        )
        share = self._adrift.falling(self.collisions.contacts, gravity, ((place - start) / dt - before) / dt)
        if share is None:
            return None
        back = -0.5 * share * gravity
        trials.shift(mesh.count, dt, back, trial)
        self.collisions.find(self._start, trial.place, add=False)
        return back

    def _part(self, dt: float) -> None:
        """Solve again and again until no contact is new, and none is sunk in."""
        collisions, trial = self.collisions, self.trial
        for rounds in range(1, ROUNDS + 1):
            self._rounds += 1
            collisions.set_stiffness(dt, INERTIAS, SPRINGS, SINKING)
            self._counts += self._newton.converge(dt)
            self._keep_momentum(dt)
            self._carry(collisions.bodies.moved())
            violated = collisions.violations(SUNK_BY_BODIES if collisions.borne > 0 else SUNK, trial.place)
            if violated:
                collisions.update_multipliers()
            if not (collisions.find(self._start, trial.place, add=rounds < ROUNDS) or violated):
                break
            self._carry(collisions.bodies.places)

    def _carry(self, places: np.ndarray) -> None:
        """Put points of solids to places [m], where bodies may take them."""
        if self.collisions.bodies.count:
            put(len(places), self._solids, places, self.trial.place)

    def _keep_momentum(self, dt: float) -> None:
        """Move what is adrift by what forces left on it as a whole would."""
        push = self._adrift.push(self.collisions.contacts, self._newton.force)
        if push is not None:
            trials.shift(self.mesh.count, dt, push, self.trial)

    @property
    def bytes(self) -> int:
        """Memory of Newton's method and of contacts [bytes]."""
        return self._newton.bytes + self.collisions.bytes
