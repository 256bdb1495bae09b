"""The scene at run time: which materials there are, what they meet, and how they step together."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from scene.settings import Refused
from sim.bodies.obstacles import find_obstacles
from sim.run.bounds import action_bounds
from sim.spec import SimulationSpec

if TYPE_CHECKING:
    from sim.bodies.movement import Movement
    from sim.cloth.contact.dynamic_solids import Bodies
    from sim.cloth.contact.solids import Solids
    from sim.cloth.fabric.state import ClothState
    from sim.cloth.model import ClothModel, PlacedSheet
    from sim.cloth.untangling.report import Untangled
    from sim.coupling.fluid_cloth.sheet_samples import SheetSamples
    from sim.coupling.fluid_cloth.wet_cloth import WetCloth
    from sim.coupling.fluid_rigid.floating import Floating
    from sim.fluid.inflow.drains import Sink
    from sim.fluid.inflow.emitters import Outlet
    from sim.fluid.inflow.flow import Flow
    from sim.fluid.measure import Measure
    from sim.fluid.model import FluidModel, FluidState
    from sim.fluid.seeding.sources import Source
    from sim.fluid.seeding.volumes import Volume
    from sim.rigid.body import RigidState
    from sim.rigid.model import RigidModel

LEAST_DEPTH = 5.0
"""What falls is in the scene for this way under everything at least [m]: about a second."""
COARSEST = 0.01
"""Positions in files are right to this share of the spacing of particles."""


@dataclass
class Counts:
    """What was added, removed or repeated, for the summary."""

    particles_started: int = 0
    particles_without_room: int = 0
    particles_removed_by_events: int = 0
    particles_emitted: int = 0
    particles_drained: int = 0
    particles_fallen: int = 0
    """Particles that have fallen so far below everything in the scene that they are out of it."""
    particles_blocked: int = 0
    """Particles that emitters would have sent into what was in the way."""
    particles_held_off: int = 0
    """Times that a particle was brought back to its side of a thin solid, or it would have passed through."""
    particles_over_limit: int = 0
    """Particles that emitters would have sent while there were as many as fluid.max_particles allows."""
    retries: int = 0
    steps_repeated: int = 0
    steps_capped: int = 0
    """Steps in which one of the two below happened."""
    pressure_capped: int = 0
    """Steps in which a pressure solver stopped at its cap of iterations, with a larger error than asked for."""
    viscosity_capped: int = 0
    """Steps in which the solver of implicit viscosity did."""
    contacts_capped: int = 0
    """Steps in which the sweeps over contacts of rigid bodies did."""
    cloth_capped: int = 0
    """Steps in which Newton's method or conjugate gradients of cloth ended at a cap."""
    cloth_held_back: int = 0
    """Times that a point of cloth could not go all its way in a step, or it would have passed through something."""


class World:
    """The materials and solids of a specification without events.

    Modules of a material that the scene does not have are not imported.
    """

    def __init__(
        self,
        spec: SimulationSpec,
        folder: Path,
        origin: np.ndarray | None = None,
        rigid_state: RigidState | None = None,
        cloth_state: ClothState | None = None,
    ):
        """Place everything; raises Refused. `origin` [m] and what bodies and cloth do are given when a run goes on."""
        self.spec = spec
        self.folder = folder
        self.gravity = np.array(spec.gravity)
        self.obstacles = find_obstacles(spec, folder)
        self.sources = self._find_sources()
        self.outlets = self._find_outlets()
        self.sinks = self._find_sinks()
        self.sheets = self._find_sheets()
        self.untangled: list[Untangled] | None = None
        """What became of sheets that are placed through something; None until that was looked for."""
        self.bounds = action_bounds([*self.sources, *self.outlets, *self.sheets], self.obstacles)
        self._refuse_remote()
        self.origin = self.bounds.mean(axis=0) if origin is None else np.asarray(origin)
        self.fluid: FluidModel | None = None
        self.flow: Flow | None = None
        self.rigid: RigidModel | None = None
        self.floating: Floating | None = None
        self.cloth: ClothModel | None = None
        self.wet_cloth: WetCloth | None = None
        self._rigid_state = rigid_state
        self._cloth_state = cloth_state
        if rigid_state is not None:
            self._put_back(rigid_state)
        self.volumes: dict[str, Volume] = {}
        """How much there is of fluid bodies that were poured."""
        self.emission: dict[str, Any] = {}
        """What emitters had sent when this world was built."""
        self.time = self._until = 0.0
        """Of the present state [s]; told by who steps."""

    def pour(self, state: FluidState, names: list[str], bodies: list[str], counts: Counts, time: float) -> FluidState:
        """`state` with the particles of the fluid `bodies` at `time` [s]; `names` numbers all bodies of the scene."""
        from sim.coupling.room import Room
        from sim.fluid.model import pour
        from sim.fluid.seeding.volumes import Volume

        room = Room(self.obstacles, self.sheets, self._cloth_state, time)
        for source in self.sources:
            if source.name in bodies:
                first = counts.particles_started + counts.particles_emitted
                index = names.index(source.name)
                state, found = pour(state, source, index, first, self.spec.fluid, self.origin, room)
                counts.particles_without_room += found.number - len(found.points)
                counts.particles_started += len(found.points)
                self.volumes[source.name] = Volume.of(source, found)
        return state

    def warnings(self) -> Iterator[str]:
        """What is there of the fluid other than was asked for, and what its particles do not resolve."""
        if self.spec.fluid is None:
            return
        from sim.coupling.resolution import warnings

        for volume in self.volumes.values():
            yield from volume.warnings()
        yield from warnings(self.obstacles, self.spec.fluid.spacing)

    def build(
        self,
        state: FluidState | None,
        emission: dict[str, Any],
        counts: Counts,
        warn: Callable[[str], None],
        time: float,
        *,
        going_on: bool,
    ) -> None:
        """Build what steps from `time` [s] on; `going_on` takes accelerations as they are in `state`.

        `emission` is what emitters remember; they count in `counts`.
        """
        self.emission = emission
        self.time = time
        if self.obstacles.dynamic:
            self._build_rigid(time)
        if self.sheets:
            self._build_cloth(time)
        if self.rigid:
            self.rigid.awaits_cloth = bool(self.cloth)
        if state is None:
            self._leave_fluid()
            return
        from sim.coupling.fluid_solids import boundary_solids
        from sim.fluid.model import FluidModel, Surroundings

        fluid = self.spec.fluid
        self.fluid = FluidModel(
            fluid,
            self.gravity,
            self.origin,
            state,
            Surroundings(boundary_solids(self.obstacles, fluid.spacing, fluid.support_radius), self._sheet_samples()),
            drop=self.drop,
            fastest=self.fastest,
            floor=self.floor,
            depth=self.depth,
            probed=any(probe.PRESSURES for probe in self.spec.probes.values()),
        )
        self._aim(time)
        self.fluid.system.boundary.move()
        self._couple()
        if self.outlets or self.sinks:
            self.flow = self.fluid.system.flow = self._build_flow(counts, warn)
        self.fluid.solver.restore() if going_on else self.fluid.solver.start()

    def _couple(self) -> None:
        """Let fluid, dynamic bodies and cloth move each other."""
        moved = [self._float()] if self.rigid else []
        moved += [self._soak(alone=not moved)] if self.cloth else []
        if len(moved) > 1:
            from sim.coupling.together import Together

            self.fluid.system.bodies = Together(moved)
        elif moved:
            self.fluid.system.bodies = moved[0]

    def _sheet_samples(self) -> Callable[[float], SheetSamples] | None:
        if not self.cloth:
            return None
        from sim.coupling.fluid_cloth.wet_cloth import sheet_samples

        return sheet_samples(self.cloth, self.spec.fluid, self.origin)

    def _soak(self, *, alone: bool) -> WetCloth:
        from sim.coupling.fluid_cloth.wet_cloth import WetCloth

        self.wet_cloth = WetCloth(
            self.cloth,
            self.fluid.system,
            self._sheet_samples(),
            self.origin,
            self._solids_ahead,
            self._apply_response,
            alone=alone,
        )
        return self.wet_cloth

    def _solids_ahead(self, dt: float) -> tuple[np.ndarray | None, Bodies | None]:
        """Where surfaces that cloth may meet are after the step, if any of them moves, and bodies that obey forces."""
        if self.rigid:
            self._follow()
        return self._solids_at(self._until, dt)

    def _float(self) -> Floating:
        from sim.coupling.fluid_rigid.floating import Floating

        moving = [index for index, item in enumerate(self.obstacles.placed) if item.motion]
        rows = {index: moving.index(index) for index in self.obstacles.dynamic}
        surfaces = [item.solid.mesh for item in self.obstacles.dynamic.values()]
        system = self.fluid.system
        self.floating = Floating(self.rigid, system, rows, list(self.obstacles.dynamic), self.origin, surfaces)
        return self.floating

    def _put_back(self, state: RigidState) -> None:
        """Stand dynamic bodies where they were."""
        row = {name: index for index, name in enumerate(state.names)}
        for item in self.obstacles.dynamic.values():
            if item.name in row:
                item.motion.resume(state.position[row[item.name]], state.rotation[row[item.name]])

    def _build_rigid(self, time: float) -> None:
        from sim.rigid.assemble import assemble
        from sim.rigid.body import RigidState
        from sim.rigid.model import RigidModel

        bodies = assemble(self.spec, self.obstacles)
        state = self._rigid_state or RigidState()
        self.rigid = RigidModel(bodies, self.gravity, self.spec.rigid, state, bottom=self.floor - self.depth)
        self.rigid.land({index: item.movement(time) for index, item in self.obstacles.prescribed.items()})
        self._follow()

    def untangle(self, time: float) -> None:
        """Let cloth that begins at `time` [s] begin apart from what it is placed through; raises Refused."""
        if self.sheets:
            self._untangle(self._solids(time))

    def _untangle(self, solids: Solids) -> None:
        if self.untangled is None:
            from sim.cloth.fabric.state import ClothState
            from sim.cloth.untangling.untangle import untangle

            state = self._cloth_state or ClothState()
            self.sheets, self.untangled = untangle(self.sheets, state, solids, self._up)

    def _build_cloth(self, time: float) -> None:
        from sim.cloth.fabric.state import ClothState
        from sim.cloth.model import ClothModel

        solids = self._solids(time)
        self._untangle(solids)
        state = self._cloth_state or ClothState()
        self.cloth = ClothModel(self.sheets, self.gravity, self.spec.cloth, state, time, solids)

    def _solids(self, time: float) -> Solids:
        """What cloth may meet, where it is at `time` [s]."""
        if not (self.obstacles.placed or self.obstacles.walls):
            from sim.cloth.contact.solids import Solids

            return Solids.none()
        from sim.coupling.cloth_solids import find_solids

        return find_solids(self.spec, self.obstacles, time)

    def step_limit(self, measure: Measure | None) -> float:
        """Largest stable time step [s]; infinite where nothing moves."""
        return min(self._step_limits(measure).values(), default=math.inf)

    def limiting_term(self, measure: Measure) -> tuple[str, str]:
        """What `step_limit` comes from, and what would help."""
        limits = self._step_limits(measure)
        match min(limits, key=limits.get):
            case "spin":
                return f"the spin of a body ({self.rigid.measure().spin_max:.3g} rad/s)", "let it turn more slowly"
            case "travel":
                return (
                    f"the speed of a body ({self.rigid.measure().v_max:.3g} m/s)",
                    "use lower speeds or larger bodies",
                )
            case "light body":
                return "a body much lighter than the fluid", "use fluid.solver: dfsph or iisph, or a heavier body"
            case "rigid step":
                return "rigid.max_step", "raise it"
            case "cloth step":
                return "cloth.max_step", "raise it"
            case term if self.cloth and term in self.cloth.integrator.limits():
                return self.cloth.integrator.limiting_term(term)
            case "force":
                return f"the force on the particles ({measure.a_max:.3g} m/s^2)", "use weaker forces"
            case "pressure":
                remedy = "use water that is less deep, or larger particles"
                return f"the pressure in the fluid ({measure.pressure_max:.3g} Pa)", remedy
            case "viscosity":
                remedy = "use fluid.viscosity_solver: implicit, a lower fluid.viscosity, or larger particles"
                return f"the viscosity ({self.spec.fluid.viscosity:.3g} m^2/s)", remedy
            case "surface tension":
                tension = max(self.spec.fluid.surface_tension, self.spec.fluid.adhesion)
                return f"the surface tension ({tension:.3g} N/m)", "use a lower one, or larger particles"
        speeds = f"fluid {measure.v_max:.3g} m/s"
        if self.spec.fluid.solver == "wcsph":
            speeds = f"sound {self.fluid.fastest_signal:.3g} m/s, {speeds}"
        if self.flow and self.flow.fastest(self.time):
            speeds += f", emitters {self.flow.fastest(self.time):.3g} m/s"
        if self.fluid.system.boundary.moves:
            speeds += f", bodies {self.fluid.system.boundary.speed:.3g} m/s"
        return f"the fastest signal ({speeds})", "use lower speeds, less gravity, or larger particles"

    def _step_limits(self, measure: Measure | None) -> dict[str, float]:
        limits = self.rigid.step_limits(self.rigid.measure()) if self.rigid else {}
        limits |= self.cloth.step_limits() if self.cloth else {}
        emitted = self.flow.fastest(self.time) if self.flow else 0.0
        if measure is None or not (self.fluid.count or emitted):
            return limits
        measure = replace(measure, v_max=max(measure.v_max, emitted), pace=max(measure.pace, emitted))
        return limits | self.fluid.solver.step_limits(measure, self.spec.step.cfl)

    def begin_frame(self) -> int:
        """What a run that goes on from the last frame would do first; how many particles were out of the scene."""
        fallen = self.fluid.remove_fallen() if self.fluid else 0
        anew = (bool(self.fluid) and self.fluid.system.begin_frame()) or fallen > 0
        if self.wet_cloth:
            anew = self.wet_cloth.begin_frame() or anew
        if anew:
            self.fluid.solver.restore()
        elif self.fluid:
            self.fluid.system.find_solids()
        return fallen

    def advance(self, dt: float, until: float) -> dict[str, float]:
        """Step all materials by dt [s] to the time `until` [s]; returns what the solvers tell of the step."""
        prescribed = self.obstacles.prescribed if self.rigid else {}
        if self.rigid:
            self.rigid.release([index for index, item in prescribed.items() if item.motion.jumps(self.time)])
        moved = {index: item.movement(until) for index, item in prescribed.items()}
        together = self.fluid and self.fluid.count and self.rigid
        stats = {}
        if self.fluid and not self.fluid.count:
            self._leave_fluid()
        if self.rigid and not together:
            stats = self.rigid.advance(dt, moved)
            self._follow()
        wet = self.wet_cloth and self.fluid.count
        if self.cloth and not wet:
            stats |= self.cloth.advance(dt, until, *self._solids_at(until, dt))
            if self.obstacles.dynamic:
                self._push(dt, until)
        if self.fluid:
            stats |= self._advance_fluid(dt, until, moved)
            if wet:
                stats["cloth_held_off"] = self.wet_cloth.tightness.held_off
            boundary = self.fluid.system.boundary
            stats["held_off"], boundary.held_off = boundary.held_off, 0
        if together:
            self._follow()
        self.time = until
        return stats

    def _leave_fluid(self) -> None:
        for part in (self.rigid, self.cloth):
            if part:
                part.leave_fluid()

    def release(self, after: SimulationSpec) -> None:
        """Let go of bodies that touch what `after`, from now on, has otherwise or no longer."""
        if self.rigid:
            before, later = (
                {**(spec.rigid.bodies if spec.rigid else {}), **spec.containers} for spec in (self.spec, after)
            )
            changed = {name for name, item in before.items() if later.get(name) != item}
            self.rigid.release([index for index, body in enumerate(self.rigid.bodies) if body.name in changed])

    def _push(self, dt: float, until: float) -> None:
        """Let the cloth push dynamic bodies."""
        from sim.coupling.cloth_solids import places, push

        push(self.cloth, self.rigid, dt)
        self._follow()
        self.cloth.settle_solids(places(self.obstacles, until))

    def _apply_response(self, dt: float) -> None:
        """Let wet cloth push dynamic bodies, before the fluid hears where they are."""
        if self.floating:
            self._push(dt, self._until)
            self.floating.pose()

    def _solids_at(self, time: float, dt: float) -> tuple[np.ndarray | None, Bodies | None]:
        """Where surfaces that cloth may meet are at `time` [s], if any of them moves, and bodies that obey forces."""
        if not any(item.motion for item in self.obstacles.placed):
            return None, None
        from sim.coupling.cloth_solids import ahead, places

        return places(self.obstacles, time), ahead(self.cloth, self.rigid, dt) if self.obstacles.dynamic else None

    def _follow(self) -> None:
        """Keep the motions of dynamic bodies up to date."""
        for index, item in self.obstacles.dynamic.items():
            item.motion.now = self.rigid.movement(index)

    def _advance_fluid(self, dt: float, until: float, moved: dict[int, Movement]) -> dict[str, float]:
        self._aim(until)
        self._until = until
        if self.floating:
            self.floating.begin(moved)
        if self.wet_cloth:
            self.wet_cloth.begin(until)
        if self.flow:
            self.flow.time = self.time
        if self.fluid.count:
            return self.fluid.solver.advance(dt)
        self.fluid.system.boundary.move()
        if self.flow and self.flow.exchange(dt):
            self.fluid.solver.start()
        return {}

    def _aim(self, time: float) -> None:
        """Say where the bodies that move are at `time` [s], which alone decides it."""
        boundary = self.fluid.system.boundary
        if boundary.shapes.moving:
            from sim.coupling.fluid_solids import motions

            boundary.aim(motions(self.obstacles, self.origin, time))

    def measure(self) -> Measure | None:
        """Extremes, sums and error counts of the fluid; None without one."""
        return self.fluid.measure(self.spec.step.cfl) if self.fluid else None

    def next_keyframe(self, time: float) -> float:
        """The first time after `time` [s] at which the velocity of a body or pin jumps; infinite where none does."""
        return min(self.obstacles.next_keyframe(time), self.cloth.next_keyframe(time) if self.cloth else math.inf)

    def choices(self) -> dict[str, str]:
        """What settings of `auto` came to."""
        if not self.fluid or not self.spec.fluid.viscosity:
            return {}
        return {"fluid.viscosity_solver": "implicit" if self.fluid.system.implicit_viscosity else "explicit"}

    def bytes_by_module(self) -> dict[str, int]:
        """Memory of each material that the scene has [bytes]."""
        found = {"fluid": self.fluid.system.bytes} if self.fluid else {}
        found |= {"rigid": self.rigid.bytes} if self.rigid else {}
        return found | ({"cloth": self.cloth.bytes} if self.cloth else {})

    @functools.cached_property
    def floor(self) -> float:
        """Height of the lowest solid or fluid [m], along the direction against gravity."""
        heights = [self._extent_up(np.asarray(bounds))[0] for bounds in self.obstacles.bounds()]
        heights += [self._extent_up(item.bounds)[0] for item in [*self._inflows, *self.sheets]]
        heights += [wall.offset for wall in self.obstacles.walls if float(wall.normal @ self._up) > 0.999]
        return min(heights, default=0.0)

    @functools.cached_property
    def depth(self) -> float:
        """How far under the floor what falls is out of the scene [m]: nowhere, where something may come after it."""
        if self.obstacles.endless or not self.gravity.any():
            return math.inf
        return max(float(np.linalg.norm(np.ptp(self.bounds, axis=0))), LEAST_DEPTH)

    @property
    def drop(self) -> float:
        """How far what begins highest may fall [m]."""
        return self._top - self.floor

    @property
    def _inflows(self) -> list[Source | Outlet]:
        """Where fluid comes from."""
        return [*self.sources, *self.outlets]

    @property
    def _top(self) -> float:
        """Height [m] that fluid comes in at, or that a body which moves may lift it to."""
        boxes = [inflow.bounds for inflow in self._inflows]
        boxes += [item.bounds for item in self.obstacles.placed if item.motion]
        return max((self._extent_up(box)[1] for box in boxes), default=0.0)

    @property
    def fastest(self) -> float:
        """The greatest speed [m/s] of fluid that comes in, or of a body at any time."""
        speeds = [inflow.speed for inflow in self._inflows]
        return max(speeds + [item.fastest for item in self.obstacles.placed], default=0.0)

    @property
    def _up(self) -> np.ndarray:
        g = np.linalg.norm(self.gravity)
        return -self.gravity / g if g > 0 else np.array([0.0, 1.0, 0.0])

    def _extent_up(self, bounds: np.ndarray) -> tuple[float, float]:
        low, high = bounds[0] * self._up, bounds[1] * self._up
        return float(np.minimum(low, high).sum()), float(np.maximum(low, high).sum())

    def _refuse_remote(self) -> None:
        """Files hold coordinates in single precision, which is coarse far from zero."""
        if self.spec.fluid is None:
            return
        step = float(np.spacing(np.float32(np.abs(self.bounds).max())))
        spacing = self.spec.fluid.spacing
        if step / 2 > COARSEST * spacing:
            raise Refused(
                f"coordinates up to {np.abs(self.bounds).max():.6g} m can only be written in steps of {step:.2g} m, "
                f"which is coarse for particles {spacing:.3g} m apart",
                remedy="move the scene nearer to the origin, or use larger particles",
            )

    def _find_sources(self) -> list[Source]:
        if self.spec.fluid is None:
            return []
        from sim.fluid.seeding.sources import find_source

        bodies = self.spec.fluid.bodies
        return [
            find_source(name, body, self.spec.fluid, self.folder, ("fluid", "bodies", name))
            for name, body in bodies.items()
        ]

    def _find_sheets(self) -> list[PlacedSheet]:
        if self.spec.cloth is None:
            return []
        from sim.cloth.model import find_sheets

        sheets = find_sheets(self.spec.cloth, self.folder)
        points = {item.name: len(item.fabric.points) for item in sheets}
        for name, probe in self.spec.probes.items():
            if probe.type == "vertex" and probe.vertex >= points.get(probe.sheet, math.inf):
                raise Refused(
                    f"the sheet '{probe.sheet}' has {points[probe.sheet]} points, numbered from 0",
                    location=("probes", name, "vertex"),
                    remedy=f"give one below {points[probe.sheet]}",
                )
        return sheets

    def _find_outlets(self) -> list[Outlet]:
        if self.spec.fluid is None or not self.spec.fluid.emitters:
            return []
        from sim.coupling.outlets import refuse_obstructed
        from sim.fluid.inflow.emitters import find_outlet

        emitters = self.spec.fluid.emitters
        outlets = [
            find_outlet(name, emitter, self.spec.fluid, self.folder, ("fluid", "emitters", name))
            for name, emitter in emitters.items()
        ]
        for outlet in outlets:
            refuse_obstructed(outlet, self.obstacles)
        return outlets

    def _find_sinks(self) -> list[Sink]:
        if self.spec.fluid is None or not self.spec.fluid.drains:
            return []
        from sim.fluid.inflow.drains import find_sink

        drains = self.spec.fluid.drains
        return [
            find_sink(drain, self.spec.fluid, self.folder, ("fluid", "drains", name)) for name, drain in drains.items()
        ]

    def _build_flow(self, counts: Counts, warn: Callable[[str], None]) -> Flow:
        from sim.coupling.fluid_solids import allowed
        from sim.fluid.inflow.flow import Flow, Ledger
        from sim.fluid.seeding.seed import START_CLEARANCE

        moving = replace(self.obstacles, walls=[], placed=[item for item in self.obstacles.placed if item.motion])
        return Flow(
            self.fluid.system,
            self.origin,
            self.outlets,
            self.sinks,
            Ledger(self.emission),
            counts,
            lambda points, time: allowed(moving, points, START_CLEARANCE * self.spec.fluid.spacing, time),
            warn,
        )
