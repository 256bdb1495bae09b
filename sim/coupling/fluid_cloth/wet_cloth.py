"""Cloth that fluid moves: what passes between the two in the course of a step.

Pressures that are looked for move the cloth, too. With the forces J q of the pressures q = p / rho^2 on its points, it
gives way by A^-1 J q, where A is the matrix of Newton's method for the step (`sim.cloth.integrators.newton`), springs,
contacts and all, and compresses the fluid by J^T A^-1 J q less. So the cloth is part of the system of equations of
`sim.fluid.pressure.projection`, which stays symmetric: a cloth as light as a feather or as stiff as a board asks for no
shorter step, where taking turns would throw the two back and forth (Causin et al. 2005).

Solvers that look for pressures ask three times. The cloth steps with the forces of the last step's pressures; those
found act in place of them, by A; and the step is made with these, by Newton's method. Where pressures follow from
positions (WCSPH), the cloth steps with half of the forces before it and half of those after it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import trimesh

from sim.cloth.contact.dynamic_solids import Bodies
from sim.cloth.fabric.arrays import clear, vectors
from sim.cloth.fabric.state import ClothState
from sim.cloth.model import ClothModel, PlacedSheet
from sim.coupling.fluid_cloth import wet_cloth_sums
from sim.coupling.fluid_cloth.sheet_samples import Pattern, SheetReaction, SheetSamples, find_cuts
from sim.coupling.fluid_cloth.tightness import Tightness
from sim.coupling.fluid_rigid.reaction_sums import subtract_predicted
from sim.device.compiler import ti
from sim.fluid.forces.terms import Terms
from sim.fluid.spec import Fluid
from sim.fluid.system import FluidSystem
from sim.geometry.distance.closest_points import MeshDistance


def sheet_samples(cloth: ClothModel, fluid: Fluid, origin: np.ndarray) -> Callable[[float], SheetSamples]:
    """What makes samples of the cloth where it is, listed within a radius [m]."""

    def make(radius: float) -> SheetSamples:
        mesh = cloth.mesh
        pattern = Pattern.of(mesh.triangles, _cuts(cloth, fluid.spacing))
        samples = SheetSamples(pattern, mesh.count, fluid.spacing, fluid.support_radius, radius, origin)
        samples.place, samples.speed = mesh.points.position, mesh.points.velocity
        return samples

    return make


def _cuts(cloth: ClothModel, spacing: float) -> np.ndarray:
    """Into how many the sides of triangles are to be divided for samples where the cloth is."""
    mesh = cloth.mesh
    return find_cuts(mesh.triangles, mesh.placed, mesh.points.position.to_numpy(), spacing)


def off_sheets(sheets: list[PlacedSheet], state: ClothState | None, points: np.ndarray, clearance: float) -> np.ndarray:
    """Whether `points` [m], shape [n, 3], are `clearance` [m] off all sheets where they are; shape [n]."""
    free = np.ones(len(points), dtype=bool)
    for item in sheets:
        now = state.of(item.name) if state else None
        places = item.begins if now is None else now[0]
        around = (points > places.min(axis=0) - clearance) & (points < places.max(axis=0) + clearance)
        near = np.flatnonzero(free & around.all(axis=1))
        if len(near):
            surface = trimesh.Trimesh(places, item.fabric.triangles, process=False)
            free[near] = MeshDistance(surface).unsigned(points[near]) > clearance
    return free


class WetCloth:
    """The cloth of a scene, as `system.bodies` or a part of them.

    make: samples of the cloth where it is; solids: where points of solids will be after the step [m], or None where
    none moves, and bodies that obey forces; move_bodies: moves these by what the cloth did to them in a step of so many
    seconds; alone: whether nothing else is moved by the fluid.
    """

    def __init__(
        self,
        cloth: ClothModel,
        system: FluidSystem,
        make: Callable[[float], SheetSamples],
        origin: np.ndarray,
        solids: Callable[[float], tuple[np.ndarray | None, Bodies | None]],
        move_bodies: Callable[[float], None],
        *,
        alone: bool,
    ):
        self.cloth, self.system = cloth, system
        self._make, self._solids, self._move_bodies, self._alone = make, solids, move_bodies, alone
        self._integrator = cloth.integrator
        self.reaction = SheetReaction(system)
        layer = system.spec.rest_density * system.spec.spacing
        self.layer_mass_ratio = layer / min(item.sheet.density for item in cloth.sheets)
        self.tightness = Tightness(cloth, system, origin)
        n = cloth.mesh.count
        self._steady, self._load, self._found, self._pressed = (vectors(np.zeros((n, 3))) for _ in range(4))
        self._way, self._expected, self._speed = (vectors(np.zeros((n, 3))) for _ in range(3))
        self._until = 0.0

    def begin(self, until: float) -> None:
        """A step to the time `until` [s] begins."""
        self._until = until

    def begin_frame(self) -> bool:
        """Lay samples anew where the cloth has stretched; returns whether it has."""
        boundary = self.system.boundary
        sheets = self.reaction.sheets
        if np.array_equal(_cuts(self.cloth, self.system.spec.spacing), sheets.pattern.cuts):
            return False
        boundary.attach(self._make(sheets.grid.radius))
        boundary.move()
        return True

    def list(self) -> None:
        self.reaction.list()

    def gather_forces(self, terms: Terms) -> None:
        self.reaction.forces(terms, self._steady)

    def predict(self, dt: float) -> None:
        self._dt = dt
        last = self.cloth.fluid_force
        self.cloth.set_targets(dt, self._until, *self._solids(dt))
        self._sum(self._load, self._steady, last)
        self._integrator.predict(dt, self._load)
        self._integrator.linearize(dt)
        self._expected.copy_from(self._integrator.respond(last))
        clear(self._found)
        self._pose()

    def subtract_predicted(self, dt: float) -> None:
        particles = self.system.particles
        self.reaction.add_response(dt, self._expected, dt * dt, fresh=True)
        subtract_predicted(self.system.count, dt, particles.pressure_acceleration, particles.source)

    def respond(self, ahead: float, *, beside_expected: bool = False) -> None:
        self.reaction.pressures(ahead, self._pressed, found=False)
        displacement = self._integrator.respond(self._pressed)
        self.reaction.add_response(ahead, displacement, self._dt**2, fresh=self._alone)

    def gather_pressures(self, ahead: float) -> None:
        self.reaction.pressures(ahead, self._pressed, found=True)
        self._way.copy_from(self._integrator.respond(self._pressed))

    def viscous_drag(self) -> None:
        """Implicit viscosity is refused beside cloth."""

    def apply_viscosity(self, dt: float, change: np.ndarray) -> None:
        """Implicit viscosity is refused beside cloth."""

    def apply(self, dt: float) -> None:
        self._sum(self._found, self._found, self._pressed)
        self._shift(self._way, 1.0)
        self._shift(self._expected, -1.0)
        clear(self._expected)
        self._pose()

    def hold_along_surfaces(self, dt: float) -> None:
        """Samples hold nothing along them."""

    def revert(self, dt: float) -> None:
        wet_cloth_sums.shift(self.cloth.mesh.count, -1.0, self._pressed, self._found)
        self._shift(self._way, -1.0)
        self._pose()

    def commit(self, dt: float) -> dict[str, float]:
        self._load.copy_from(self._found)
        wet_cloth_sums.shift(self.cloth.mesh.count, -1.0, self.cloth.fluid_force, self._load)
        self.cloth.set_targets(dt, self._until, *self._solids(dt))
        self._integrator.change(dt, self._load)
        self.cloth.fluid_force.copy_from(self._found)
        return self._finish(dt)

    def drift(self, dt: float) -> dict[str, float]:
        clear(self._load)
        wet_cloth_sums.shift(self.cloth.mesh.count, 0.5, self.cloth.fluid_force, self._load)
        self.cloth.set_targets(dt, self._until, *self._solids(dt))
        self._integrator.predict(dt, self._load)
        return self._finish(dt)

    def kick(self, dt: float, terms: Terms) -> None:
        self.reaction.forces(terms, self.cloth.fluid_force)
        wet_cloth_sums.strike(self.cloth.mesh.count, dt / 2, self.cloth.mesh.points, self.cloth.fluid_force)
        self.system.boundary.move()

    def prevent_penetration(self, dt: float) -> None:
        self.tightness.keep(dt)

    def _finish(self, dt: float) -> dict[str, float]:
        stats = self.cloth.note(self._integrator.commit(dt))
        points, sheets = self.cloth.mesh.points, self.reaction.sheets
        sheets.place, sheets.speed = points.position, points.velocity
        self._move_bodies(dt)
        return stats

    def _shift(self, displacement: ti.Ndarray, factor: float) -> None:
        wet_cloth_sums.shift(self.cloth.mesh.count, factor, displacement, self._integrator.trial.place)

    def _sum(self, out: ti.Ndarray, one: ti.Ndarray, other: ti.Ndarray) -> None:
        out.copy_from(one)
        wet_cloth_sums.shift(self.cloth.mesh.count, 1.0, other, out)

    def _pose(self) -> None:
        """Bring samples to where the cloth is foreseen to be after the step."""
        trial, sheets = self._integrator.trial, self.reaction.sheets
        wet_cloth_sums.speeds(self.cloth.mesh.count, self._dt, trial.start, trial.place, self._speed)
        sheets.place, sheets.speed = trial.place, self._speed
        self.system.boundary.move()

    @property
    def bytes(self) -> int:
        return self.reaction.bytes + 7 * 24 * self.cloth.mesh.count
