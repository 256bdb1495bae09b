"""The fluid's particles and their surroundings: what every pressure solver shares."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
import taichi as ti

from sim.device.arrays import Declared, DoubleTable, IntArray, Particles, RealArray, Vec4Array, real, vec3
from sim.fluid.boundary.boundary import Boundary
from sim.fluid.boundary.gaps import relieved
from sim.fluid.kernel import cubic_host, particle_mass
from sim.fluid.packed import DENSITY, DISTANCE, Q
from sim.fluid.spec import Fluid
from sim.fluid.sums import BLOCKS, span
from sim.neighbors.spatial_hash import HashGrid, NeighborList

if TYPE_CHECKING:
    from sim.fluid.forces.momentum import Momentum

PARTICLES = (
    Declared("position", "vec4", "m; w: p / rho^2 [m^5/(kg s^2)]"),
    Declared("velocity", "vec4", "m/s; w: density [kg/m^3]"),
    Declared("acceleration", "vec4", "m/s^2; w: L q of the last pressures [kg/(m^3 s^2)]"),
    Declared("tag", "vec2i", "identity and body"),
    Declared("slack", "real", "how much nearer to solids than a layer it may be, after it was caught between two [m]"),
    Declared("eased", "real", "share of the rest density that solids add, and that does not press yet"),
    Declared("known", "real", "what solids added before they were listed anew, and 1; or nothing", saved=False),
)

ROW = 21
"""Numbers of a block of particles that a measure is made of."""


@dataclass(frozen=True)
class Measure:
    """What one pass over the particles tells about the whole fluid; SI units, local coordinates."""

    v_max: float
    a_max: float
    pace: float
    """The greatest v / 2 + sqrt(v^2 / 4 + a s), at which a particle goes a way s in a step t: v t + a t^2 = s."""
    kinetic_energy: float
    momentum: np.ndarray
    position_sum: np.ndarray
    density_max: float
    crowding_max: float
    """As density_max, but of what solids add no more than a particle alone has of them at rest [kg/m^3]."""
    pressure_max: float
    """No more than makes water as fast as it can be in the scene: where nothing gives way, pressures grow at will."""
    height: float
    """Along gravity, of a block of fluid whose heights vary as those of all particles do that do not fall alone [m]."""
    compression_sum: float
    not_finite: int
    beyond_walls: int
    too_fast: int
    fallen: int
    """Particles that have left the scene for good."""


STILL = Measure(0.0, 0.0, 0.0, 0.0, np.zeros(3), np.zeros(3), 0.0, 0.0, 0.0, 0.0, 0.0, 0, 0, 0, 0)
"""The measure of no particles at all."""


class Exchange(Protocol):
    """Particles that come, are led, and go."""

    def lead(self) -> None:
        """Hold those that are led to their way, whatever forces there are."""

    def exchange(self, dt: float) -> bool:
        """Take out and bring in what the step dt [s] demands; returns whether there was anything."""


class ViscousDrag(Protocol):
    """Bodies that obey forces in the equations of implicit viscosity: rows as `sim.fluid.forces.body_unknowns` has
    them, and the body of each solid that is listed near a particle, or -1."""

    table: ti.Ndarray
    body_of: ti.Ndarray

    def begin(self, viscosity: float, sums: ti.Ndarray) -> None:
        """Residuals and directions, where particles have their first guess as velocity, and viscous_search.w is the
        density; viscosity: kinematic, times the step [m^2]."""

    def pull(self) -> None:
        """The images of the searches."""

    def finish(self, *, solved: bool) -> np.ndarray:
        """By how much velocities and angular velocities change, shape [bodies, 6]."""


class Bodies(Protocol):
    """What the fluid moves, bodies or cloth, as solvers talk with it in the course of a step dt [s]."""

    layer_mass_ratio: float
    """Mass of the fluid's layer around it over its own, where it is lightest."""

    def list(self) -> None:
        """Find what of them is near the particles, as the particles' lists are made."""

    def gather_forces(self, momentum: "Momentum") -> None:
        """Note the forces that positions and velocities give, to act in the step."""

    def predict(self, dt: float) -> None:
        """Bring them to where they will be after the step, by what is known before its pressures."""

    def subtract_predicted(self, dt: float) -> None:
        """Take from the source of the pressures what has been foreseen by those of the last step."""

    def respond(self, ahead: float, *, beside_expected: bool = False) -> None:
        """Find what gives way to the pressures in position.w, and leave in pressure_acceleration.w by how much that
        lowers the second derivative of the densities of particles [kg/(m^3 s^2)]; pairs act where particles will be
        `ahead` [s]. `beside_expected`: but for what has been foreseen."""

    def gather_pressures(self, ahead: float) -> None:
        """Note the forces of the pressures found, which are in search.x."""

    def viscous_drag(self) -> ViscousDrag | None:
        """Their part in the equations of implicit viscosity, if they have one."""

    def apply_viscosity(self, dt: float, change: np.ndarray) -> None:
        """Take the changes of velocity and angular velocity by viscosity over the step, shape [bodies, 6]."""

    def apply(self, dt: float) -> None:
        """Let the forces noted last act in the step, and move what they act on to where they take it."""

    def hold_along_surfaces(self, dt: float) -> None:
        """Let what is held along surfaces by the pressures in position.w act in the step, in place of what the last
        step held."""

    def revert(self, dt: float) -> None:
        """Take back what was taken last."""

    def commit(self, dt: float) -> dict[str, float]:
        """Make the step with what was noted and taken; returns its statistics."""

    def drift(self, dt: float) -> dict[str, float]:
        """Make the step with half of the last forces; returns its statistics."""

    def kick(self, dt: float, momentum: "Momentum") -> None:
        """Change velocities by half of the forces that positions and velocities give now, and remember them."""

    def prevent_penetration(self, dt: float) -> None:
        """Keep particles that have gone dt [s] with their velocities on their side of what is thin."""

    @property
    def bytes(self) -> int:
        """Memory of what the exchange with the fluid needs [bytes]."""


class FluidSystem:
    """Particles, their neighbours, and the solids around them, in coordinates relative to the world's origin.

    extra: arrays that only the solver needs. skin: how much further than the support radius neighbours are listed,
    relative to it, so that a list serves for several short steps. implicit_viscosity: viscosity is no force, but a step
    of its own.
    """

    def __init__(
        self,
        spec: Fluid,
        gravity: np.ndarray,
        boundary: Boundary,
        extra: tuple[Declared, ...] = (),
        skin: float = 0.0,
        implicit_viscosity: bool = False,
    ):
        self.spec = spec
        self.implicit_viscosity = implicit_viscosity
        self.gravity = gravity
        self.boundary = boundary
        self.h = spec.support_radius
        self.mass = particle_mass(spec.spacing, self.h, spec.rest_density)
        self.particles = Particles(PARTICLES + extra, 0)
        self.grid = HashGrid(0, self.h * (1 + skin))
        self.neighbors = NeighborList(64)
        self._skin = skin * self.h
        self._fall = float(np.linalg.norm(gravity)) * spec.spacing
        self._alone = 1.0 - self.mass * float(cubic_host(np.zeros(1), self.h)[0]) / spec.rest_density
        """What solids add to a particle alone at rest, over the rest density."""
        self._distance_left = 0.0
        self._listed = self._noted = False
        """Whether solids are listed as they are after a checkpoint, and whether it is known what they were before."""
        self.remembers = hasattr(self.particles, "pressed")
        """Whether it is kept which pressures acted where in the step, for who asks for them."""
        self.forgetful = True
        """Whether what particles remember of the last step only to be faster is lost."""
        self._partial = ti.ndarray(ti.f64, (BLOCKS, ROW))
        self.measured = STILL
        """What the last measure said."""
        self.momentum: Momentum | None = None
        """The solver's forces that positions and velocities give."""
        self.flow: Exchange | None = None
        self.bodies: Bodies | None = None

    @property
    def lists(self) -> tuple[ti.Ndarray | bool, ...]:
        """Neighbours as kernels take them: size and index of the lists of particles, whether there are samples of
        sheets, the samples, and size and index of their lists."""
        boundary = self.boundary
        near, near_samples = self.neighbors, boundary.neighbors
        return near.size, near.index, boundary.sampled > 0, boundary.samples, near_samples.size, near_samples.index

    @property
    def count(self) -> int:
        """Number of particles now."""
        return self.particles.count

    def load(self, state: dict[str, np.ndarray]) -> None:
        """Hold these particles instead of those there were."""
        self.particles.load(state)
        self.begin_frame()

    def begin_frame(self) -> bool:
        """Choose the hash by the present count and forget the neighbours and what else is not saved, so that a run that
        goes on from a checkpoint does the same; returns whether particles have to be sorted anew before all else."""
        self._distance_left = 0.0
        self._listed = self._listed and self._skin == 0
        self.forgetful = True
        return self.grid.fit(self.count)

    def exchange(self, dt: float, distance: float = float("inf")) -> None:
        """Let particles come and go, at the positions after a step dt [s] of which nothing is known yet; `distance`:
        how far [m] any of them has moved in it at most."""
        self._noted = self.boundary.shapes.meshes and self._listed and self._distance_left <= distance
        if self._noted:
            self.meet(pulls=False)
            self.boundary.faces.note(self.count, self.particles.known)
        if self.flow and self.flow.exchange(dt):
            self._distance_left = 0.0
            self.forgetful = True

    def lead(self) -> None:
        """Give back their velocity to particles that no force is to move."""
        if self.flow:
            self.flow.lead()

    def meet(
        self,
        ahead: float = 0.0,
        *,
        since: float | None = None,
        position: ti.Ndarray | None = None,
        pulls: bool = True,
    ) -> None:
        """Find what solids are to particles that will be `ahead` [s], or at `position`; without `pulls` these stay.
        `since`: the time [s] since this was last told; then what is caught between two is led and let out, by changing
        its velocity and slack."""
        particles = self.particles
        self.boundary.faces.place(
            particles.position if position is None else position,
            particles.velocity,
            self.count,
            ahead,
            slack=particles.slack,
            eased=particles.eased,
            since=since,
            fall=self._fall,
            rest_density=self.spec.rest_density,
            pulls=pulls,
        )

    def find_neighbors(self, distance: float = float("inf"), dt: float = 0.0) -> None:
        """Sort the particles by cell, list their neighbours, of the fluid and of the boundary, and find what solids are
        to them where all are now.

        `distance`: how far [m] any of them has moved at most since the last call, `dt` [s] before; lists are kept while
        they hold all pairs.
        """
        self._distance_left -= distance
        if not self.count:
            if self.bodies:
                self.bodies.list()
            return
        if self._distance_left > 0:
            self.meet(since=dt)
            return
        self._distance_left = self._skin / 2
        self.particles.reorder(self.grid.sort(self.particles.position, self.count))
        position = self.particles.position
        self.neighbors.build(position, self.count, self.grid, position, same=True)
        self.find_solids(dt)
        if self._noted:
            self.boundary.faces.ease(self.count, self.particles.known, self.particles.eased)
        self._noted, self._listed = False, True
        self.boundary.faces.sever(position, self.count, self.neighbors)
        if self.bodies:
            self.bodies.list()

    def find_solids(self, dt: float = 0.0) -> None:
        """List the solids near particles as they lie, which need not be sorted, `dt` [s] after the last time."""
        self.boundary.list(self.particles.position, self.count)
        self.meet(since=dt)

    def pressures(self) -> np.ndarray:
        """Of the last step, of all that was solved for, as q = p / rho^2 [m^5/(kg s^2)], shape [n]."""
        return self.particles.numpy("position")[:, 3].astype(np.float64)

    def measure(self, distance: float, speed_limit: float, level: float, depth: float) -> Measure:
        """Extremes, sums and error counts, in a fixed order of summation; the pace is for `distance` [m].

        A particle is too fast above `speed_limit` [m/s], unless it gained the speed by falling from
        where gravity's potential is `level` [m^2/s^2]. It has no pace where it falls alone under there, and has fallen
        out of the scene `depth` [m^2/s^2] further down.
        """
        if not self.count:
            self.measured = STILL
            return STILL
        _measure(
            self.count,
            self.particles.position,
            self.particles.velocity,
            self.particles.acceleration,
            self.spec.rest_density,
            self.neighbors.size,
            self.boundary.faces.begin,
            self.boundary.faces.size,
            self.boundary.faces.face,
            self.boundary.faces.share,
            self.boundary.faces.excess,
            self._alone,
            self.h / 2,
            vec3(*self.gravity),
            distance,
            speed_limit,
            level,
            depth,
            self._partial,
        )
        table = self._partial.to_numpy()
        peak, total = table.max(axis=0), table.sum(axis=0)
        self.measured = Measure(
            v_max=float(np.sqrt(peak[0])),
            a_max=float(np.sqrt(peak[1])),
            pace=float(peak[2]),
            kinetic_energy=0.5 * self.mass * float(total[3]),
            momentum=self.mass * total[4:7],
            position_sum=total[7:10],
            density_max=float(peak[10]),
            compression_sum=float(total[11]),
            not_finite=int(total[12]),
            beyond_walls=int(total[13]),
            too_fast=int(total[14]),
            fallen=int(total[15]),
            crowding_max=float(peak[16]),
            pressure_max=self.spec.rest_density * min(self.spec.rest_density * float(peak[17]), 0.5 * speed_limit**2),
            height=_height(total[18], total[19], total[20], float(np.linalg.norm(self.gravity))),
        )
        return self.measured

    @property
    def bytes(self) -> int:
        """Memory of particles, neighbours, surroundings, and of what the fluid moves [bytes]."""
        own = self.particles.bytes + self.grid.bytes + self.neighbors.bytes + self.boundary.bytes
        return own + (self.bodies.bytes if self.bodies else 0)


def _height(count: float, depth: float, squared: float, gravity: float) -> float:
    """Of a block whose heights have the variance of so many particles, whose potentials [m^2/s^2] and squares of these
    are summed up; zero without gravity [m/s^2]."""
    if not (count and gravity):
        return 0.0
    return math.sqrt(12.0 * max(squared / count - (depth / count) ** 2, 0.0)) / gravity


@ti.kernel
def _measure(
    count: ti.i32,
    position: Vec4Array,
    velocity: Vec4Array,
    acceleration: Vec4Array,
    rest_density: real,
    near: IntArray,
    begin: IntArray,
    solids_near: IntArray,
    face: Vec4Array,
    share: Vec4Array,
    excess: RealArray,
    alone: real,
    deepest: real,
    gravity: vec3,
    distance: real,
    speed_limit: real,
    level: real,
    depth: real,
    partial: DoubleTable,
):
    for block in range(BLOCKS):
        row = ti.Vector([0.0] * ROW, dt=ti.f64)
        within = span(block, BLOCKS, count)
        for i in range(within[0], within[1]):
            x, v, a = position[i], velocity[i], acceleration[i]
            v2, a2 = v.xyz.dot(v.xyz), a.xyz.dot(a.xyz)
            row[0] = ti.max(row[0], v2)
            row[1] = ti.max(row[1], a2)
            fallen = gravity.dot(x.xyz) + level
            if near[i] > 0 or solids_near[i] > 0 or fallen <= deepest * gravity.norm():
                row[2] = ti.max(row[2], 0.5 * ti.sqrt(v2) + ti.sqrt(0.25 * v2 + distance * ti.sqrt(a2)))
                row[18] += 1.0
                row[19] += ti.cast(fallen, ti.f64)
                row[20] += ti.cast(fallen, ti.f64) ** 2
            row[3] += v2
            for axis in ti.static(range(3)):
                row[4 + axis] += v[axis]
                row[7 + axis] += x[axis]
            density = relieved(v[DENSITY], rest_density, excess[i])
            row[10] = ti.max(row[10], density)
            crowded = v[DENSITY] - ti.max(share[i].w - alone, 0.0) * rest_density
            row[16] = ti.max(row[16], relieved(crowded, rest_density, excess[i]))
            row[11] += ti.max(density / rest_density - 1.0, 0.0)
            row[17] = ti.max(row[17], x[Q])
            finite = (
                ti.abs(v2) < 1e30
                and ti.abs(a2) < 1e30
                and x.xyz.dot(x.xyz) < 1e30
                and v[DENSITY] < 1e30
                and ti.abs(x[Q]) < 1e30
            )
            if not finite:
                row[12] += 1.0
            for e in range(begin[i], begin[i] + solids_near[i]):
                if face[e][DISTANCE] < -deepest:
                    row[13] += 1.0
            if v2 > speed_limit * speed_limit + 2.0 * ti.max(fallen, 0.0):
                row[14] += 1.0
            if fallen > depth:
                row[15] += 1.0
        for column in ti.static(range(ROW)):
            partial[block, column] = row[column]
