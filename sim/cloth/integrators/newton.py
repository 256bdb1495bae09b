"""Newton's method for a step of implicit Euler: where the energy that `newton_sums` tells is least."""

from __future__ import annotations

import math

import numpy as np
import taichi as ti

from sim.cloth.contact import augmented_lagrangian
from sim.cloth.contact.collision import Collisions
from sim.cloth.fabric.arrays import matrices, numbers, vectors
from sim.cloth.fabric.layout import ROWS
from sim.cloth.fabric.mesh import ClothMesh
from sim.cloth.integrators import conjugate_gradients, newton_sums
from sim.cloth.integrators.conjugate_gradients import AT_ONCE
from sim.cloth.integrators.newton_sums import SETTLED, Strain, System, Trial
from sim.cloth.integrators.stiffness import find_pattern
from sim.cloth.spec import ImplicitEuler as Settings
from sim.device.double import vec3

PASSES = 3
"""Times that the forces which friction counts are renewed in a solution, and one more."""
REACH = 4.0
"""Times the longest way of a point in one of Newton's steps that sides of contacts may come nearer in the next."""
SEARCHES = 3
"""For the least energy beyond the end of a way."""
MOST = 4.0
"""Times that such a search may go further than before."""
FURTHER = 1.2
"""Times that it has to go further to be worth it."""
AS_TOLD = 0.4
"""Linear forces let the energy fall by half of its slope; where it falls by less than this share, the way before is
forgotten: in a bent valley, it would lead out."""
NEARLY = 1e-9
"""Energies that differ by this share are too much alike to tell where the least is."""
HALVINGS = 30
"""Of a way that does not lead down: then it is rounding that is left."""
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
            aim=vectors(mesh.placed),
            base=vectors(mesh.placed),
            place=mesh.place,
            length_before=numbers(np.zeros(s)),
            angle_before=numbers(np.zeros(h)),
        )
        self.left = 0.0
        """Forces left over, over those that act, where the last solution met a cap."""
        self._weight = float(np.linalg.norm(gravity))
        self._mass = float(mesh.mass[~mesh.held].sum())
        self._bodies = collisions.loose.count
        self._pattern = find_pattern(mesh.ends, mesh.corners, n)
        self._strains = {
            "spring_normal": vectors(np.zeros((s, 3))),
            "spring_block": vectors(np.zeros((s, 3))),
            "moment": numbers(np.zeros(h)),
            "hinge_stiff": numbers(np.zeros(h)),
            "slope": vectors(np.zeros((4 * h, 3))),
        }
        alike = ("force", "force_before", "residual", "scaled", "course", "bent", "response", "line")
        self._tables = {
            **{name: vectors(np.zeros((self._rows, 3))) for name in alike},
            "inverse": matrices(self._rows),
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
        """Go to where the energy is least, each way conjugate to the one before; returns steps, iterations, and whether
        a cap was met."""
        self._make_room()
        settings = self.settings
        slow = settings.velocity_error * dt
        energy = self._assess(dt)
        iterations, capped, passes, displacement, before = 0, 0, 0, math.inf, 0.0
        for step in range(settings.max_newton + 1):
            first, unbalanced = self._balance(dt)
            if displacement == 0.0 or (displacement <= slow and unbalanced <= settings.force_error**2):
                passes += 1
                if passes == PASSES or self.collisions.press_on() <= slow:
                    self.left = 0.0
                    return np.array([step, iterations, capped])
                energy, before = self._assess(dt), 0.0
                first, _ = self._balance(dt)
            if step == settings.max_newton:
                break
            newton_sums.tie(self._pattern.pairs, self._pattern.rows, self._strain)
            made, ended = self._solve(first * settings.linear_error**2, REACH * displacement)
            iterations += made
            capped |= not ended
            before, down = newton_sums.conjugate(self._rows, before, self._system)
            energy, displacement, as_told = self._descend(dt, energy, down)
            before *= as_told
        self.left = math.sqrt(unbalanced)
        return np.array([step, iterations, 1])

    def linearize(self, dt: float) -> None:
        """Find how points give way to forces where they are."""
        self._assess(dt)
        self._balance(dt)
        newton_sums.tie(self._pattern.pairs, self._pattern.rows, self._strain)

    def respond(self, load: ti.Ndarray, error: float) -> ti.Ndarray:
        """By what ways [m] points give way to forces [N], by `linearize`, to a share of the forces that may be left."""
        first = newton_sums.ask(self.mesh.count, 2 * self._bodies, self.mesh.points, load, self._system)
        self._solve(first * error**2, 0.0, linear=True)
        newton_sums.respond(self.mesh.count, self._system, self._given)
        return self._given

    def _assess(self, dt: float) -> float:
        mesh, touches, rows = self.mesh, self.collisions.count, 2 * self._bodies
        first = mesh.count + mesh.springs + mesh.hinges
        if touches or rows:
            tables = self.collisions.touches, self.collisions.loose.tables, self.trial, self._strain["term"]
            newton_sums.assess_touches(first, touches, rows, *tables)
        return newton_sums.assess(
            mesh.air.present,
            mesh.count,
            mesh.springs,
            mesh.hinges,
            touches + rows,
            dt,
            mesh.air.wind,
            mesh.points,
            mesh.strands,
            mesh.angles,
            mesh.air.drag,
            self.trial,
            self._strain,
        )

    def _balance(self, dt: float) -> tuple[float, float]:
        """Find what forces are left; returns r.z, and the sum of r^2 / m over that of the forces that act: on cloth or
        on bodies, whichever is more."""
        mesh, air, collisions = self.mesh, self.mesh.air, self.collisions
        newton_sums.stiffen(
            air.present,
            mesh.count,
            dt,
            air.wind,
            mesh.points,
            mesh.strands,
            mesh.angles,
            air.drag,
            self._pattern.rows,
            self.trial,
            self._strain,
            self._system["force"],
        )
        bodies = collisions.loose
        tables = collisions.touches, bodies.tables, bodies.holds, self._pattern.rows, self.trial, self._system
        first, *sums = newton_sums.linearize(mesh.count, self._bodies, dt, self.gravity, mesh.points, *tables)
        # Without gravity, what would count as a change.
        least = (self._weight or self.settings.velocity_error / dt) ** 2
        cloth = sums[0] / max(sums[1], self._mass * least)
        solid = sums[2] / max(sums[3], bodies.mass.min() * least) if bodies.count else 0.0
        return first, max(cloth, solid)

    def _solve(self, enough: float, reach: float, *, linear: bool = False) -> tuple[int, bool]:
        """Conjugate gradients until r.z is not above `enough`; returns iterations, and whether they ended before the
        cap. Contacts that are further than `reach` [m] from pressing do not; `linear`: contacts go on as they do."""
        mesh, most, touches = self.mesh, self.settings.max_iterations, self.collisions.count
        collisions, bodies = self.collisions, self._bodies
        loose = collisions.loose
        parts = mesh.points, collisions.touches, loose.tables, loose.holds, self._pattern.rows, self._system
        augmented_lagrangian.wake(touches, reach, collisions.touches)
        if mesh.alone:
            made = conjugate_gradients.solve_alone(linear, mesh.count, bodies, touches, most, enough, *parts)
            return made, made <= most
        for made in range(AT_ONCE, most + AT_ONCE, AT_ONCE):
            left = conjugate_gradients.iterate(linear, mesh.count, bodies, touches, *parts)
            if not left > enough:
                return made, True
        return made, False

    def _descend(self, dt: float, energy: float, down: float) -> tuple[float, float, bool]:
        """Go along the way found, on which the energy falls by `down` [J] for the whole of it at first, to its end; on
        if that is where the energy goes on to fall; less far if it does not fall. Returns the energy, the longest way
        of a point [m], and whether the energy has fallen as much as linear forces would let it."""
        share, displacement, after = 1.0, *self._try(dt, 1.0)
        as_told = energy - after > AS_TOLD * down
        for _ in range(SEARCHES):
            bend = 2 * (after - energy + share * down) / share**2
            best = min(down / bend, MOST * share) if bend > 0 else MOST * share
            if abs(after - energy) < NEARLY * abs(energy) or best < FURTHER * share:
                break
            _, found = self._try(dt, best)
            if not found < after:
                self._try(dt, share)
                break
            share, after = best, found
        for _ in range(HALVINGS):
            if after <= energy + ROUNDING * abs(energy) or not math.isfinite(displacement):
                return after, share * displacement, as_told
            share /= 2
            _, after = self._try(dt, share)
        return self._try(dt, 0.0)[1], 0.0, False

    def _try(self, dt: float, share: float) -> tuple[float, float]:
        """Go a share of the way found; returns how far all of it takes any point [m], and the energy [J]."""
        loose = self.collisions.loose
        tables = loose.reach, loose.tables, self.trial, self._system
        return newton_sums.move(self.mesh.count, 2 * self._bodies, share, *tables), self._assess(dt)

    def _make_room(self) -> None:
        """Let there be room for the sums over all contacts."""
        mesh = self.mesh
        needed = self._rows + mesh.springs + mesh.hinges + self.collisions.count + ROWS
        if needed > self._term_room:
            self._term_room = needed + self.collisions.count
            part = vectors(np.zeros((max(self._rows, 2 * self.collisions.count) + ROWS, 3)))
            self._strain = Strain(**self._strains, term=numbers(np.zeros(self._term_room)))
            self._system = System(**self._tables, part=part)

    @property
    def bytes(self) -> int:
        """Memory of its vectors, of what springs and hinges add, and of its matrix [bytes]."""
        n, s, h = self.mesh.count, self.mesh.springs, self.mesh.hinges
        own = n * (3 * 11 + 9 + 9 + 9) + s * (3 + 3 + 2) + h * (12 + 4) + self._pattern.pairs * 18
        return 8 * own
