"""Newton's method for a step of implicit Euler: where the energy of `step_energy` is least."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from sim.cloth.contact import augmented_lagrangian
from sim.cloth.contact.collision import Collisions
from sim.cloth.fabric.arrays import matrices, numbers, vectors
from sim.cloth.fabric.layout import PARTITIONS
from sim.cloth.fabric.mesh import ClothMesh
from sim.cloth.fabric.rows import BendingRows
from sim.cloth.integrators.newton import conjugate_gradients, linear_system, step_energy
from sim.cloth.integrators.newton.block_matrix import find_pattern
from sim.cloth.integrators.newton.linear_system import SETTLED, System
from sim.cloth.integrators.newton.step_energy import ElementForces
from sim.cloth.integrators.newton.trial import Trial
from sim.cloth.spec import ImplicitEuler as Settings
from sim.device.compiler import ti
from sim.device.double import vec3

if TYPE_CHECKING:
    from sim.cloth.shell.newton import ShellNewton

PASSES = 3
"""Times that the normal forces that bound friction are renewed in a solution, and one more."""
REACH = 4.0
"""Sides of contacts may come nearer in a step of Newton's by so many times the longest displacement in the one
before."""
SEARCHES = 3
"""For the least energy beyond the end of a step."""
MOST = 4.0
"""Times that such a search may go further than before."""
FURTHER = 1.2
"""Times that it has to go further to be worth it."""
SUFFICIENT_DECREASE = 0.4
"""Linear forces let the energy fall by half of its slope; where it falls by less than this share, the direction before
is forgotten: in a bent valley, it would lead out."""
NEARLY = 1e-9
"""Energies that differ by this share are too much alike to tell where the least is."""
HALVINGS = 30
"""Of a step that does not lead down: then it is rounding that is left."""
ROUNDING = 1e-12
"""Energies that differ by this share are the same."""


class Newton:
    """Finds where the points of a cloth go in a step."""

    def __init__(self, mesh: ClothMesh, gravity: np.ndarray, settings: Settings, collisions: Collisions):
        self.mesh = mesh
        self.settings = settings
        self.collisions = collisions
        self.gravity = vec3(*gravity)
        n, s, h = mesh.count, mesh.springs, mesh.hinges
        self.trial = Trial(
            start=vectors(mesh.placed),
            predicted=vectors(mesh.placed),
            base=vectors(mesh.placed),
            place=mesh.place,
            length_before=numbers(np.zeros(s)),
            angle_before=numbers(np.zeros(h)),
        )
        self.left = 0.0
        """Forces left over, over those that act, where the last solution met a cap."""
        self._weight = float(np.linalg.norm(gravity))
        self._mass = float(mesh.mass[~mesh.held].sum())
        self._bodies = collisions.bodies.count
        bending = mesh.shell.bending_rows() if mesh.shell else BendingRows.none(n)
        self._pattern = find_pattern(mesh.ends, mesh.corners, n, mesh.edges, bending)
        self._shell = _shell(mesh, self._pattern.pairs, bending) if mesh.shell else None
        self._element_arrays = {
            "spring_direction": vectors(np.zeros((s, 3))),
            "spring_tangent": vectors(np.zeros((s, 3))),
            "moment": numbers(np.zeros(h)),
            "hinge_stiffness": numbers(np.zeros(h)),
            "angle_gradient": vectors(np.zeros((4 * h, 3))),
        }
        rows = ("force", "force_before", "residual", "preconditioned", "direction", "product", "solution")
        self._tables = {
            **{name: vectors(np.zeros((self._rows, 3))) for name in (*rows, "newton_direction")},
            "preconditioner": matrices(self._rows),
            "scalar": numbers(np.zeros(SETTLED + 1)),
        }
        self._given = vectors(np.zeros((n, 3)))
        self._term_room = 0

    @property
    def _rows(self) -> int:
        """Of equations: of points, and two of each body."""
        return self.mesh.count + 2 * self._bodies

    @property
    def force(self) -> ti.Ndarray:
        """What is left of forces on points where the last solution ended [N]."""
        return self._system["force"]

    def converge(self, dt: float) -> np.ndarray:
        """Go to where the energy is least, each direction conjugate to the one before; returns steps, iterations, and
        whether a cap was met."""
        self._make_room()
        settings = self.settings
        slow = settings.velocity_error * dt
        energy = self._assess(dt)
        iterations, capped, passes, displacement, before = 0, 0, 0, math.inf, 0.0
        for step in range(settings.max_newton + 1):
            first, unbalanced = self._balance(dt)
            if displacement == 0.0 or (displacement <= slow and unbalanced <= settings.force_error**2):
                passes += 1
                if passes == PASSES or self.collisions.update_lagged_forces() <= slow:
                    self.left = 0.0
                    return np.array([step, iterations, capped])
                energy, before = self._assess(dt), 0.0
                first, _ = self._balance(dt)
            if step == settings.max_newton:
                break
            self._fill_off_diagonal(dt)
            made, ended = self._solve(first * settings.linear_error**2, REACH * displacement)
            iterations += made
            capped |= not ended
            before, decrease = linear_system.conjugate(self._rows, before, self._system)
            energy, displacement, sufficient = self._descend(dt, energy, decrease)
            before *= sufficient
        self.left = math.sqrt(unbalanced)
        return np.array([step, iterations, 1])

    def linearize(self, dt: float) -> None:
        """Find how points give way to forces where they are."""
        self._assess(dt)
        self._balance(dt)
        self._fill_off_diagonal(dt)

    def respond(self, load: ti.Ndarray, error: float) -> ti.Ndarray:
        """By what displacements [m] points give way to forces [N], by `linearize`; `error`: share of the forces that
        may be left."""
        first = linear_system.set_load(self.mesh.count, 2 * self._bodies, self.mesh.points, load, self._system)
        self._solve(first * error**2, 0.0, linear=True)
        linear_system.respond(self.mesh.count, self._system, self._given)
        return self._given

    def begin(self, turning: bool) -> bool:
        """Begin a step; returns whether an edge turns by more than a right angle, or springs do."""
        return (self._shell.begin(self.trial.start, self.trial.place) if self._shell else False) or turning

    def _fill_off_diagonal(self, dt: float) -> None:
        step_energy.fill_off_diagonal(len(self._pattern.pairs), self._pattern.matrix, self._elements)
        if self._shell:
            self._shell.fill_off_diagonal(dt, self._pattern.matrix, self._pattern.alike)

    def _assess(self, dt: float) -> float:
        mesh, contacts, rows = self.mesh, self.collisions.count, 2 * self._bodies
        first = mesh.count + mesh.springs + mesh.hinges
        if contacts or rows:
            tables = self.collisions.tables, self.collisions.bodies.tables, self.trial, self._elements["energy_term"]
            step_energy.assess_contacts(first, contacts, rows, *tables)
        others = contacts + rows
        if self._shell:
            self._shell.assess(first + others, dt, self.trial.place, self._elements["energy_term"])
            others += self._shell.terms
        return step_energy.assess(mesh.air.present, others, dt, mesh.model, self.trial, self._elements)

    def _balance(self, dt: float) -> tuple[float, float]:
        """Find what forces are left; returns r.z, and the sum of r^2 / m over that of the forces that act: on cloth or
        on bodies, whichever is more."""
        mesh, collisions, bodies = self.mesh, self.collisions, self.collisions.bodies
        tables = mesh.model, self._pattern.matrix, self.trial, self._elements, self._system["force"]
        step_energy.differentiate(mesh.air.present, dt, *tables)
        if self._shell:
            self._shell.differentiate(dt, self.trial.place, mesh.points, self._pattern.matrix, self.force)
        tables = collisions.tables, bodies.tables, self._pattern.matrix, self.trial, self._system
        first, *sums = linear_system.linearize(mesh.count, self._bodies, dt, self.gravity, mesh.points, *tables)
        # Without gravity, what would count as a change.
        least = (self._weight or self.settings.velocity_error / dt) ** 2
        cloth = _share(sums[0], max(sums[1], self._mass * least))
        solid = _share(sums[2], max(sums[3], bodies.mass.min() * least)) if bodies.count else 0.0
        return first, max(cloth, solid)

    def _solve(self, enough: float, reach: float, *, linear: bool = False) -> tuple[int, bool]:
        """Conjugate gradients until r.z is not above `enough`; returns iterations, and whether they ended before the
        cap. Contacts that are further than `reach` [m] from pressing do not; `linear`: contacts go on as they do."""
        mesh, most, contacts = self.mesh, self.settings.max_iterations, self.collisions.count
        collisions, bodies = self.collisions, self._bodies
        matrix = self._pattern.matrix, self._pattern.alike
        parts = mesh.points, collisions.tables, collisions.bodies.tables, *matrix, self._system
        augmented_lagrangian.activate(contacts, reach, collisions.tables)
        if mesh.alone:
            made = conjugate_gradients.solve_alone(linear, mesh.count, bodies, contacts, most, enough, *parts)
            return made, made <= most
        for made in range(1, most + 1):
            left = conjugate_gradients.iterate(linear, contacts > 0, mesh.count, self._rows, contacts, *parts)
            if not left > enough:
                return made, True
        return most, False

    def _descend(self, dt: float, energy: float, decrease: float) -> tuple[float, float, bool]:
        """A line search along the direction found, whose predicted decrease of the energy [J] is for the whole of it:
        to its end; on if that is where the energy goes on to fall; less far if it does not fall. Returns the energy,
        the longest displacement of a point [m], and whether the energy has fallen as much as linear forces would let
        it."""
        share, displacement, after = 1.0, *self._try(dt, 1.0)
        sufficient = energy - after > SUFFICIENT_DECREASE * decrease
        for _ in range(SEARCHES):
            curvature = 2 * (after - energy + share * decrease) / share**2
            best = min(decrease / curvature, MOST * share) if curvature > 0 else MOST * share
            if abs(after - energy) < NEARLY * abs(energy) or best < FURTHER * share:
                break
            _, found = self._try(dt, best)
            if not found < after:
                self._try(dt, share)
                break
            share, after = best, found
        for _ in range(HALVINGS):
            if after <= energy + ROUNDING * abs(energy) or not math.isfinite(displacement):
                return after, share * displacement, sufficient
            share /= 2
            _, after = self._try(dt, share)
        return self._try(dt, 0.0)[1], 0.0, False

    def _try(self, dt: float, share: float) -> tuple[float, float]:
        """Go a share of the direction found; returns how far all of it takes any point [m], and the energy [J]."""
        bodies = self.collisions.bodies
        tables = bodies.reach, bodies.tables, self.trial, self._system
        return linear_system.move(self.mesh.count, 2 * self._bodies, share, *tables), self._assess(dt)

    def _make_room(self) -> None:
        """Let there be room for the sums over all contacts."""
        mesh = self.mesh
        needed = self._rows + mesh.springs + mesh.hinges + self.collisions.count + PARTITIONS
        needed += self._shell.terms if self._shell else 0
        if needed > self._term_room:
            self._term_room = needed + self.collisions.count
            sum_term = vectors(np.zeros((max(self._rows, 2 * self.collisions.count) + PARTITIONS, 3)))
            self._elements = ElementForces(**self._element_arrays, energy_term=numbers(np.zeros(self._term_room)))
            self._system = System(**self._tables, sum_term=sum_term)

    @property
    def bytes(self) -> int:
        """Memory of its vectors, of what springs and hinges add, and of its matrix [bytes]."""
        n, s, h = self.mesh.count, self.mesh.springs, self.mesh.hinges
        own = n * (3 * 11 + 9 + 9 + 9) + s * (3 + 3 + 2) + h * (12 + 4) + len(self._pattern.pairs) * 18
        return 8 * own + (self._shell.bytes if self._shell else 0)


def _shell(mesh: ClothMesh, pairs: np.ndarray, bending: BendingRows) -> ShellNewton:
    from sim.cloth.shell.newton import ShellNewton
    from sim.cloth.shell.shell import shell_of

    return ShellNewton(shell_of(mesh), mesh.shell_rest, pairs, bending)


def _share(part: float, whole: float) -> float:
    """Of nothing, none: where all points are held."""
    return part / whole if whole != 0.0 else 0.0
