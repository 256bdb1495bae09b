"""The scene before it steps: where solids are, and where fluid and cloth begin."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from scene.settings import Refused, given
from sim.bodies.obstacles import find_obstacles
from sim.run.placing.bounds import action_bounds
from sim.spec import SimulationSpec

if TYPE_CHECKING:
    from sim.cloth.contact.solids import Solids
    from sim.cloth.fabric.state import ClothState
    from sim.cloth.model import PlacedSheet
    from sim.cloth.untangling.report import Untangled
    from sim.fluid.inflow.drains import Sink
    from sim.fluid.inflow.emitters import Outlet
    from sim.fluid.model import FluidState
    from sim.fluid.seeding.sources import Source
    from sim.fluid.seeding.volumes import Volume
    from sim.run.reporting.counts import Counts

LEAST_DEPTH = 5.0
"""What falls is in the scene for this way under everything at least [m]: about a second."""
COARSEST = 0.01
"""Positions in files are right to this share of the spacing of particles."""


class PlacedScene:
    """All that a specification without events places.

    Modules of a material that the scene does not have are not imported.
    """

    def __init__(
        self,
        spec: SimulationSpec,
        folder: Path,
        origin: np.ndarray | None = None,
        cloth_state: ClothState | None = None,
    ):
        """Place everything; raises Refused. `origin` [m] and what cloth does are given where a run goes on."""
        self.spec = spec
        self.folder = folder
        self.cloth_state = cloth_state
        self.gravity = np.array(spec.gravity)
        self.obstacles = find_obstacles(spec, folder)
        self.sources = self._find_sources()
        self.outlets = self._find_outlets()
        self.sinks = self._find_sinks()
        self.sheets = self._find_sheets()
        self.untangled: list[Untangled] | None = None
        """What became of sheets that are placed through something; None until that was looked for."""
        self.volumes: dict[str, Volume] = {}
        """How much there is of fluid bodies that were poured."""
        self.bounds = action_bounds([*self.sources, *self.outlets, *self.sheets], self.obstacles)
        self._refuse_remote()
        self.origin = self.bounds.mean(axis=0) if origin is None else np.asarray(origin)
        """Of the coordinates of particles [m], shape [3]: the middle of the action."""

    def pour(self, state: FluidState, names: list[str], bodies: list[str], counts: Counts, time: float) -> FluidState:
        """`state` with the particles of the fluid `bodies` at `time` [s]; `names` numbers all bodies of the scene."""
        from sim.coupling.room import Room
        from sim.fluid.model import pour
        from sim.fluid.seeding.volumes import Volume

        fluid = given(self.spec.fluid)
        room = Room(self.obstacles, self.sheets, self.cloth_state, time)
        for source in self.sources:
            if source.name in bodies:
                first = counts.particles_started + counts.particles_emitted
                index = names.index(source.name)
                state, found = pour(state, source, index, first, fluid, self.origin, room)
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

    def untangle(self, time: float) -> None:
        """Let cloth that begins at `time` [s] begin apart from what it is placed through; raises Refused."""
        if self.sheets and self.untangled is None:
            from sim.cloth.fabric.state import ClothState
            from sim.cloth.untangling.untangle import untangle

            state = self.cloth_state or ClothState()
            self.sheets, self.untangled = untangle(self.sheets, state, self.solids(time), self.up)

    def solids(self, time: float) -> Solids:
        """What cloth may meet, where it is at `time` [s]."""
        if not (self.obstacles.placed or self.obstacles.walls):
            from sim.cloth.contact.solids import Solids

            return Solids.none()
        from sim.coupling.cloth_solids import find_solids

        return find_solids(self.spec, self.obstacles, time)

    @functools.cached_property
    def floor(self) -> float:
        """Height of the lowest solid or fluid [m], along the direction against gravity."""
        heights = [self._extent_up(np.asarray(bounds))[0] for bounds in self.obstacles.bounds()]
        heights += [self._extent_up(item.bounds)[0] for item in [*self.inflows, *self.sheets]]
        heights += [wall.offset for wall in self.obstacles.walls if float(wall.normal @ self.up) > 0.999]
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
    def inflows(self) -> list[Source | Outlet]:
        """Where fluid comes from."""
        return [*self.sources, *self.outlets]

    @property
    def _top(self) -> float:
        """Height [m] that fluid comes in at, or that a body which moves may lift it to."""
        boxes = [inflow.bounds for inflow in self.inflows]
        boxes += [item.bounds for item in self.obstacles.placed if item.motion]
        return max((self._extent_up(box)[1] for box in boxes), default=0.0)

    @property
    def fastest(self) -> float:
        """The greatest speed [m/s] of fluid that comes in, or of a body at any time."""
        speeds = [inflow.speed for inflow in self.inflows]
        return max(speeds + [item.fastest for item in self.obstacles.placed], default=0.0)

    @property
    def up(self) -> np.ndarray:
        """Unit vector against gravity, or the y axis where there is none, shape [3]."""
        g = np.linalg.norm(self.gravity)
        return -self.gravity / g if g > 0 else np.array([0.0, 1.0, 0.0])

    def _extent_up(self, bounds: np.ndarray) -> tuple[float, float]:
        low, high = bounds[0] * self.up, bounds[1] * self.up
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
