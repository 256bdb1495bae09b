"""Implicit Euler: stable at any stiffness and step (Baraff and Witkin 1998), by Newton's method.

It takes from an oscillation of angular frequency w the share 1 - (1 + w^2 dt^2)^(-1/2) a step, whatever the damping.
"""

from __future__ import annotations

import math

import numpy as np
import taichi as ti
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from sim.cloth import conjugate_gradients, newton
from sim.cloth.collision import Collisions
from sim.cloth.conjugate_gradients import AT_ONCE
from sim.cloth.layout import ROWS
from sim.cloth.mesh import ClothMesh
from sim.cloth.newton import System, Trial
from sim.cloth.spec import Cloth
from sim.cloth.tables import matrices, numbers, vectors
from sim.double import vec3

HARDNESS = 10.0
"""Stiffness with which contacts are looked for, over that of the cloth at their points."""
PASSES = 3
"""Times that the forces which friction counts are renewed in a solution, and one more."""
ROUNDS = 12
"""Of looking for contacts that the last solution made."""
GIVING_WAY = 1e-3
"""What is left of a force over the whole of it, when it is asked how points give way."""
UNSOLVED = 100.0
"""Forces left at a cap, over the weight and over those that the step takes into account, from which on what moves is
left to chance."""
HALVINGS = 30
"""Of a way that does not lead down: then it is rounding that is left."""
ROUNDING = 1e-12
"""Energies that differ by this share are the same."""


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
        self.settings = settings.implicit_euler
        self.gravity = vec3(*gravity)
        n, s, h = mesh.count, mesh.springs, mesh.hinges
        self.trial = Trial(
            start=vectors(mesh.placed),
            aim=vectors(mesh.placed),
            base=vectors(mesh.placed),
            place=mesh.place,
            length_before=numbers(np.zeros(s)),
            angle_before=numbers(np.zeros(h)),
        )
        self._gravity = float(np.linalg.norm(gravity))
        self._mass = float(mesh.mass[~mesh.held].sum())
        self._adrift, self._held = numbers(_adrift(mesh)), numbers(np.zeros(mesh.count))
        self._left = 0.0
        """Acceleration [m/s^2] that forces left over would make, where the last solution met a cap."""
        self._term_room = 0
        self._tables = {
            "spring_normal": vectors(np.zeros((s, 3))),
            "spring_block": vectors(np.zeros((s, 3))),
            "moment": numbers(np.zeros(h)),
            "hinge_stiff": numbers(np.zeros(h)),
            "slope": vectors(np.zeros((4 * h, 3))),
            "slope_way": numbers(np.zeros(h)),
            **{name: vectors(np.zeros((n, 3))) for name in ("residual", "scaled", "bent", "answer")},
            # Solids do not give way.
            "course": vectors(np.zeros((mesh.total, 3))),
            "inverse": matrices(n),
            "scalar": numbers(np.zeros(3)),
        }

    def limits(self) -> dict[str, float]:
        """Largest steps [s] by what limits them: none."""
        return {}

    def advance(self, dt: float) -> dict[str, float]:
        """Step by dt [s]; returns the STATISTICS."""
        self.foresee(dt)
        return self.settle(dt)

    def foresee(self, dt: float, load: ti.Ndarray | None = None) -> None:
        """Find where a step of dt [s] with these forces of others on points [N] takes them, in `trial.place`."""
        mesh, trial = self.mesh, self.trial
        turning = newton.begin(
            mesh.count,
            mesh.total,
            mesh.springs,
            mesh.hinges,
            dt,
            self.gravity,
            # What touches something is at rest more often than it falls.
            self._held if self.collisions.count else self._adrift,
            mesh.points,
            mesh.strands,
            mesh.angles,
            trial,
        )
        if turning:
            # From beyond a spring that has gone through itself, Newton's method finds the cloth inside out.
            newton.stay(mesh.count, mesh.points, trial)
        if load is not None:
            newton.load_on(mesh.count, dt, mesh.points, load, trial)
        self.collisions.begin(trial.start)
        self._told, self._rounds = np.zeros(3, int), 0
        self._part(dt)

    def change(self, dt: float, load: ti.Ndarray) -> None:
        """Let forces on points [N] act besides those foreseen, and look where that takes them."""
        newton.load_on(self.mesh.count, dt, self.mesh.points, load, self.trial)
        self._part(dt)

    def linearize(self, dt: float) -> None:
        """Find how points give way to forces where they are foreseen."""
        self._assess(dt)
        self._linearize(dt)

    def give_way(self, dt: float, load: ti.Ndarray) -> ti.Ndarray:
        """By what ways [m] points give way to forces [N] that act in the step, by `linearize`."""
        first = newton.ask(self.mesh.count, self.mesh.points, load, self.system)
        self._iterate(dt, first * GIVING_WAY**2)
        return self.system.answer

    def settle(self, dt: float) -> dict[str, float]:
        """Take the step to where it was foreseen; returns the STATISTICS."""
        mesh, trial, collisions = self.mesh, self.trial, self.collisions
        share, stuck = collisions.hold_back(trial.start, trial.place)
        collisions.end()
        steps, iterations, capped = self._told.tolist()
        values = (
            steps,
            iterations,
            int(capped > 0),
            collisions.count,
            self._rounds,
            int((share < 1).sum()),
            stuck,
            int(self._left > UNSOLVED * self._acceleration(dt)),
        )
        newton.finish(mesh.total, dt, mesh.points, trial)
        return dict(zip(self.STATISTICS, values, strict=True))

    def _acceleration(self, dt: float) -> float:
        """Of the step on average, at least that of gravity [m/s^2]; only looked for where a cap was met."""
        if not self._left:
            return self._least_acceleration(dt)
        mesh, count = self.mesh, self.mesh.count
        way = (self.trial.place.to_numpy() - self.trial.start.to_numpy())[:count]
        change = (way / dt - mesh.points.velocity.to_numpy()[:count]) / dt
        squares = np.where(mesh.held, 0.0, mesh.mass) @ (change**2).sum(axis=1)
        return max(self._least_acceleration(dt), math.sqrt(squares / self._mass))

    def _part(self, dt: float) -> None:
        """Solve again and again until no contact is new."""
        for rounds in range(1, ROUNDS + 1):
            self._rounds += 1
            self.collisions.harden(dt, HARDNESS)
            self._make_room()
            self._told += self._converge(dt)
            if not self.collisions.find(self.trial.start, self.trial.place, add=rounds < ROUNDS):
                break

    def _converge(self, dt: float) -> np.ndarray:
        """Newton's method; returns steps, iterations, and whether a cap was met."""
        energy = self._assess(dt)
        iterations, capped, passes, way = 0, 0, 0, math.inf
        slow = self.settings.velocity_error * dt
        for step in range(self.settings.max_newton + 1):
            first, unbalanced = self._linearize(dt)
            if way == 0.0 or (way <= slow and unbalanced <= self._balanced(dt)):
                passes += 1
                if passes == PASSES or self.collisions.press_on() <= slow:
                    self._left = 0.0
                    return np.array([step, iterations, capped])
                energy = self._assess(dt)
                first, _ = self._linearize(dt)
            if step == self.settings.max_newton:
                break
            made, ended = self._iterate(dt, first * self.settings.linear_error**2)
            iterations += made
            capped |= not ended
            energy, way = self._descend(dt, energy)
        self._left = math.sqrt(unbalanced / self._mass)
        return np.array([step, iterations, 1])

    def _assess(self, dt: float) -> float:
        mesh = self.mesh
        return newton.assess(
            mesh.air.present,
            mesh.count,
            mesh.springs,
            mesh.hinges,
            self.collisions.count,
            dt,
            mesh.air.wind,
            mesh.points.mass,
            mesh.points.mobile,
            mesh.strands,
            mesh.angles,
            self.collisions.touches,
            mesh.air.drag,
            self.trial,
            self.system,
        )

    def _linearize(self, dt: float) -> tuple[float, float]:
        """Look for the way from the places tried; returns r.z and the sum of r^2 / m."""
        mesh = self.mesh
        parts = *self._parts, self.trial, self.system
        return tuple(newton.linearize(mesh.air.present, mesh.count, dt, mesh.air.wind, *parts))

    def _balanced(self, dt: float) -> float:
        """Sum of r^2 / m that may be left: next to stiff springs, a way too short to count may be all that there is of
        a fall or a swing."""
        return self._mass * (self.settings.linear_error * self._least_acceleration(dt)) ** 2

    def _least_acceleration(self, dt: float) -> float:
        """That of gravity, or what would count as a change without one [m/s^2]."""
        return self._gravity or self.settings.velocity_error / dt

    @property
    def _parts(self) -> tuple:
        mesh = self.mesh
        return mesh.points, mesh.strands, mesh.angles, self.collisions.touches, mesh.air.drag

    def _iterate(self, dt: float, enough: float) -> tuple[int, bool]:
        """Conjugate gradients until r.z is not above `enough`; returns iterations, and whether they ended before the
        cap."""
        mesh, parts = self.mesh, self._parts
        most, touches = self.settings.max_iterations, self.collisions.count
        if mesh.alone:
            made = conjugate_gradients.solve_alone(
                mesh.air.present, mesh.count, mesh.hinges, touches, most, enough, dt, *parts, self.system
            )
            return made, made <= most
        for made in range(AT_ONCE, most + AT_ONCE, AT_ONCE):
            left = conjugate_gradients.iterate(
                mesh.air.present, mesh.count, mesh.hinges, touches, dt, *parts, self.system
            )
            if not left > enough:
                return made, True
        return made, False

    def _descend(self, dt: float, energy: float) -> tuple[float, float]:
        """Go so far that the energy falls; returns it, and the longest way of a point [m]."""
        share = 1.0
        for _ in range(HALVINGS):
            way = newton.move(self.mesh.count, share, self.trial, self.system)
            after = self._assess(dt)
            if after <= energy + ROUNDING * abs(energy) or not math.isfinite(way):
                return after, share * way
            share /= 2
        newton.move(self.mesh.count, 0.0, self.trial, self.system)
        return self._assess(dt), 0.0

    def _make_room(self) -> None:
        """Let there be room for the sums over all contacts."""
        mesh = self.mesh
        needed = mesh.count + mesh.springs + mesh.hinges + self.collisions.count + ROWS
        if needed > self._term_room:
            self._term_room = needed + self.collisions.count
            self.system = System(**self._tables, term=numbers(np.zeros(self._term_room)))

    @property
    def bytes(self) -> int:
        n, s, h = self.mesh.count, self.mesh.springs, self.mesh.hinges
        return 8 * (n * (3 * 8 + 9 + 1) + s * (3 + 3 + 2) + h * (12 + 5)) + self.collisions.bytes


def _adrift(mesh: ClothMesh) -> np.ndarray:
    """1 for points that no springs tie to a held one, 0 for others, shape [points]."""
    ones = np.ones(len(mesh.ends))
    _, piece = connected_components(coo_array((ones, tuple(mesh.ends.T)), shape=(mesh.count, mesh.count)))
    return 1.0 - np.isin(piece, piece[mesh.held])
