"""Typed settings of the simulation stage.

`SimulationSpec` is all that a segment of the simulation depends on: neither the duration nor
anything of the later stages is part of it, so that a longer film repeats no segment.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from annotated_types import Gt, Le
from pydantic import Field, model_validator

from scene.settings import Name, Settings
from scene.units import Acceleration, Dimensionless, Duration, Extents, FrameRate, Position, PositiveDuration
from sim.cloth.spec import Cloth, ClothSheet
from sim.fluid.spec import Drain, Emitter, Fluid, FluidBody
from sim.geometry.spec import ClosedMesh, Placement
from sim.rigid.spec import Contact, Rigid, RigidBody
from sim.run.probes.spec import Probe

Side = Literal["left", "right", "bottom", "top", "back", "front"]
SIDES: tuple[Side, ...] = ("left", "right", "bottom", "top", "back", "front")
"""-x, +x, -y, +y, -z, +z: the order of the planes of a box."""
CFL = {"iisph": 0.3, "dfsph": 0.45}
"""CFL numbers where a scene leaves them out, of solvers that go less or further than others: less than half of those up
to which five balls of water may be thrown at a wall, 0.64 and 1.56 (`python -m tests.stress.limits`)."""


class BoxContainer(Contact):
    """Walls around a cuboid. A closed side extends infinitely beyond the cuboid."""

    type: Literal["box"]
    size: Extents
    """Inner edge lengths along x, y and z [m]."""
    position: Position = (0.0, 0.0, 0.0)
    """Centre of the bottom face [m]."""
    open: tuple[Side, ...] = ("top",)
    """Sides without a wall."""

    @model_validator(mode="after")
    def _has_a_wall(self) -> Self:
        if set(self.open) == set(SIDES):
            raise ValueError("a container with all sides open holds nothing: leave one side closed")
        return self


class MeshContainer(Placement, Contact):
    """The inside of a closed mesh."""

    type: Literal["mesh"]
    shape: ClosedMesh


Container = Annotated[BoxContainer | MeshContainer, Field(discriminator="type")]


class TimeStep(Settings):
    """How the time step is chosen."""

    cfl: Annotated[Dimensionless, Gt(0), Le(1)] = 0.4
    """Largest distance that the fastest signal may travel in one step, over half the support radius. Where a scene
    leaves it out, 0.3 with IISPH, which is the first to break in an impact, and 0.45 with DFSPH, the last."""
    maximum: PositiveDuration | None = None
    """Never longer than this [s]."""
    fixed: PositiveDuration | None = None
    """The same step throughout [s]; refused, or stopped, where it is beyond the stability limit."""

    @model_validator(mode="after")
    def _one_policy(self) -> Self:
        if self.fixed is not None and self.maximum is not None:
            raise ValueError("fixed and maximum exclude each other: remove one of them")
        return self


class Addition(Settings):
    """What an event adds."""

    fluid: dict[Name, FluidBody] = {}
    emitters: dict[Name, Emitter] = {}
    drains: dict[Name, Drain] = {}
    rigid: dict[Name, RigidBody] = {}
    cloth: dict[Name, ClothSheet] = {}
    containers: dict[Name, Container] = {}

    def names(self) -> list[str]:
        """Of all that it adds: fluid, emitters, drains, bodies, sheets and containers."""
        return [*self.fluid, *self.emitters, *self.drains, *self.rigid, *self.cloth, *self.containers]


class Event(Settings):
    """A change of the scene at a time."""

    at: Duration
    """Time [s]; an event at the time of a frame is first seen in the next frame."""
    add: Addition = Addition()
    remove: tuple[Name, ...] = ()
    """Names of bodies, emitters, drains, sheets or containers to remove; fluid already emitted stays."""
    set: dict[str, Any] = {}
    """New values by dotted path, as `fluid.viscosity: 0.01` or `gravity: [0, 0, 0]`."""

    @model_validator(mode="after")
    def _does_something(self) -> Self:
        if not (self.add.names() or self.remove or self.set):
            raise ValueError("an event needs add, remove or set: say what it does, or remove it")
        return self


class SimulationSpec(Settings):
    """Everything that the simulation depends on."""

    fps: Annotated[FrameRate, Le(10_000)] = 24.0
    """Frames per simulated second [Hz]; as `24000/1001` exactly that, for television."""
    gravity: tuple[Acceleration, Acceleration, Acceleration] = (0.0, -9.81, 0.0)
    step: TimeStep = TimeStep()
    precision: Literal["single", "double"] = "single"
    """Precision of the computation; files are in single precision. Double is slower, and meant for studies."""
    containers: dict[Name, Container] = {}
    """Walls that enclose their contents."""
    fluid: Fluid | None = None
    rigid: Rigid | None = None
    cloth: Cloth | None = None
    probes: dict[Name, Probe] = {}
    """Quantities recorded in probes.csv."""
    events: tuple[Event, ...] = ()
    """Changes at given times; sorted by time."""

    @model_validator(mode="after")
    def _events_in_order(self) -> Self:
        times = [event.at for event in self.events]
        if times != sorted(times):
            raise ValueError("events must be sorted by their time: put the earliest first")
        return self

    @model_validator(mode="after")
    def _step_of_the_solver(self) -> Self:
        if self.fluid and self.fluid.solver in CFL and "cfl" not in self.step.model_fields_set:
            object.__setattr__(self, "step", self.step.model_copy(update={"cfl": CFL[self.fluid.solver]}))
        return self

    def materials(self) -> frozenset[str]:
        """Which of fluid, rigid and cloth the scene needs, at the start or through an event."""
        present = {name for name in ("fluid", "rigid", "cloth") if getattr(self, name) is not None}
        for event in self.events:
            present |= {name for name in ("fluid", "rigid", "cloth") if getattr(event.add, name)}
        return frozenset(present)

    def body_names(self) -> list[str]:
        """Names of all bodies, emitters, drains, sheets and containers, of the start and of the events."""
        names = [*self.containers]
        names += [*self.fluid.bodies, *self.fluid.emitters, *self.fluid.drains] if self.fluid else []
        names += self.rigid.bodies if self.rigid else []
        names += self.cloth.sheets if self.cloth else []
        for event in self.events:
            names += event.add.names()
        return names

    def fluid_sources(self) -> tuple[str, ...]:
        """Names of all that fluid comes from: its bodies and emitters, of the start and of the events."""
        names = [*self.fluid.bodies, *self.fluid.emitters] if self.fluid else []
        for event in self.events:
            names += [*event.add.fluid, *event.add.emitters]
        return tuple(dict.fromkeys(names))

    def has_dynamic_bodies(self) -> bool:
        """Whether any body obeys forces, at any time."""
        groups = [self.rigid.bodies] if self.rigid else []
        groups += [event.add.rigid for event in self.events]
        return any(body.motion == "dynamic" for bodies in groups for body in bodies.values())

    def placements(self) -> list[tuple[tuple[str | int, ...], Any]]:
        """Every body with a shape, with its path in the scene."""
        found: list[tuple[tuple[str | int, ...], Any]] = []
        for group, field in (
            ("fluid", "bodies"),
            ("fluid", "emitters"),
            ("fluid", "drains"),
            ("rigid", "bodies"),
            ("cloth", "sheets"),
        ):
            material = getattr(self, group)
            if material is not None:
                found += [((group, field, name), body) for name, body in getattr(material, field).items()]
        found += [(("containers", name), body) for name, body in self.containers.items()]
        for index, event in enumerate(self.events):
            for group in ("fluid", "emitters", "drains", "rigid", "cloth", "containers"):
                bodies = getattr(event.add, group)
                found += [(("events", index, "add", group, name), body) for name, body in bodies.items()]
        return found

    def before(self, time: float) -> SimulationSpec:
        """The same settings without the events at or after `time` [s]: what a segment that ends then depends on."""
        return self.model_copy(update={"events": tuple(event for event in self.events if event.at < time)})
