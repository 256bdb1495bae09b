"""The fluid's particles and their surroundings: what every pressure solver shares."""

import numpy as np

from sim.device.arrays import Declared, Particles
from sim.fluid.boundary.boundary import Boundary
from sim.fluid.forces.terms import Terms
from sim.fluid.kernel import particle_mass
from sim.fluid.layout import Points, Resolution
from sim.fluid.measure import STILL, Measure, Meter
from sim.fluid.protocols import Bodies, Exchange
from sim.fluid.spec import Fluid
from sim.neighbors.spatial_hash import HashGrid, NeighborList

PARTICLES = (
    Declared("position", "vec4", "m; w: p / rho^2 [m^5/(kg s^2)]"),
    Declared("velocity", "vec4", "m/s; w: density [kg/m^3]"),
    Declared("acceleration", "vec4", "m/s^2; w: L q of the last pressures [kg/(m^3 s^2)]"),
    Declared("tag", "vec2i", "identity and body"),
    Declared("slack", "real", "how much nearer to solids than a layer it may be, after it was caught between two [m]"),
    Declared("eased", "real", "share of the rest density that solids add, and that does not press yet"),
    Declared("known", "real", "what solids added before they were listed anew, and 1; or nothing", saved=False),
)


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
        self.resolution = Resolution(self.h, spec.spacing, self.mass, spec.rest_density)
        self.particles = Particles(PARTICLES + extra, 0)
        self.grid = HashGrid(0, self.h * (1 + skin))
        self.neighbors = NeighborList(32)
        self._skin = skin * self.h
        self._fall = float(np.linalg.norm(gravity)) * spec.spacing
        self._distance_left = 0.0
        self._listed = self._noted = False
        """Whether solids are listed as they are after a checkpoint, and whether it is known what they were before."""
        self.remembers = hasattr(self.particles, "pressed")
        """Whether it is kept which pressures acted where in the step, for who asks for them."""
        self.forgetful = True
        """Whether what particles remember of the last step only to be faster is lost."""
        self._meter = Meter(spec, gravity)
        self.measured = STILL
        """What the last measure said."""
        self.terms: Terms | None = None
        """Of the solver's momentum equation."""
        self.flow: Exchange | None = None
        self.bodies: Bodies | None = None

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
        self.particles.forget()
        return self.grid.fit(self.count)

    def exchange(self, dt: float, distance: float = float("inf")) -> None:
        """Let particles come and go, at the positions after a step dt [s] of which nothing is known yet; `distance`:
        how far [m] any of them has moved in it at most."""
        self._noted = self.boundary.shapes.meshes and self._listed and self._distance_left <= distance
        if self._noted:
            self.update_half_spaces(pulls=False)
            self.boundary.faces.note(self.count, self.particles.known)
        if self.flow and self.flow.exchange(dt):
            self._distance_left = 0.0
            self.forgetful = True

    def lead(self) -> None:
        """Give back their velocity to particles that no force is to move."""
        if self.flow:
            self.flow.lead()

    def update_half_spaces(
        self,
        ahead: float = 0.0,
        *,
        since: float | None = None,
        position: str = "position",
        pulls: bool = True,
    ) -> None:
        """Find what solids are to particles that will be `ahead` [s], by the array of this name; without `pulls` these
        stay.
        `since`: the time [s] since this was last told; then what is caught between two is led and let out, by changing
        its velocity and slack."""
        self.boundary.faces.place(
            self.particles.bundle(Points, position=position),
            self.count,
            ahead,
            gaps=True,
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
            self.update_half_spaces(since=dt)
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
        self.update_half_spaces(since=dt)

    def measure(self, distance: float, speed_limit: float, level: float, depth: float) -> Measure:
        """Extremes, sums and error counts, in a fixed order of summation; the pace is for `distance` [m].

        A particle is too fast above `speed_limit` [m/s], unless it gained the speed by falling from
        where gravity's potential is `level` [m^2/s^2]. It has no pace where it falls alone under there, and has fallen
        out of the scene `depth` [m^2/s^2] further down.
        """
        self.measured = self._meter.measure(
            self.particles,
            self.neighbors.size,
            self.boundary.faces.lists,
            self.resolution,
            distance=distance,
            speed_limit=speed_limit,
            level=level,
            depth=depth,
        )
        return self.measured

    @property
    def bytes(self) -> int:
        """Memory of particles, neighbours, surroundings, and of what the fluid moves [bytes]."""
        own = self.particles.bytes + self.grid.bytes + self.neighbors.bytes + self.boundary.bytes
        return own + (self.bodies.bytes if self.bodies else 0)
