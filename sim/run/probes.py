"""Measurements during a run, each at its own rate."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sim.run.probe_means import Gathered
from sim.spec import (
    BodyForce,
    Front,
    PinForce,
    Pressure,
    Probe,
    Region,
    SimulationSpec,
    VertexPosition,
    Volume,
    WaterHeight,
)

if TYPE_CHECKING:
    from sim.run.world import World

COLUMNS = ("time", "probe", "quantity", "value", "unit")


class Probes:
    """The probes of a scene, when each is due next [s], and what those that tell means have gathered."""

    def __init__(
        self,
        spec: SimulationSpec,
        due: dict[str, float] | None = None,
        gathered: dict[str, Gathered] | None = None,
    ):
        self.probes = spec.probes
        self.fps = spec.fps
        self.due = {name: 0.0 for name in self.probes} | (due or {})
        self.gathered = {name: replace(values) for name, values in (gathered or {}).items()}

    def sample(self, world: World, time: float) -> Iterator[tuple[float, str, str, float, str]]:
        """Rows for the probes that are due at or before `time` [s], with the time of this step."""
        view = None
        for name, probe in self.probes.items():
            means, is_due = getattr(probe, "mean", False), self.due[name] <= time + 1e-12
            if not (is_due or means):
                continue
            if is_due:
                rate = probe.rate or self.fps
                self.due[name] = (math.floor(time * rate + 1e-6) + 1) / rate
            if isinstance(probe, VertexPosition | PinForce):
                rows = _of_sheet(world, probe)
            elif world.fluid is None:
                continue
            else:
                view = view or FluidView(world, time)
                rows = view.read(probe)
            if means:
                rows = self.gathered.setdefault(name, Gathered(time, time)).take(rows, time, is_due=is_due)
            for quantity, value, unit in rows:
                yield time, name, quantity, value, unit


class FluidView:
    """Particles on the host at `time` [s], as one probe after another looks at them; world coordinates."""

    def __init__(self, world: World, time: float):
        part = world.fluid
        state = part.state()
        self.world = world
        self.time = time
        self.h = part.system.h
        self.mass = part.system.mass
        self.spec = part.system.spec
        self.points = state.position[:, :3].astype(np.float64) + world.origin
        self.density = state.velocity[:, 3].astype(np.float64)
        self.pressure = part.system.pressures() * self.density**2

    def read(self, probe: Probe) -> list[tuple[str, float, str]]:
        """Name, value and unit of all that a probe measures; raises TypeError for a probe of another kind."""
        match probe:
            case WaterHeight():
                return [("water_height", self.water_height(probe.x, probe.z), "m")]
            case Pressure():
                from sim.coupling.pressure_at import pressure_at

                return [
                    (
                        "pressure",
                        pressure_at(self, self.world.fluid.system, self.world.origin, np.array(probe.at)),
                        "Pa",
                    )
                ]
            case Front():
                return [("front", self.front(probe.axis), "m")]
            case Volume():
                return [("volume", self.volume(), "m^3")]
            case BodyForce():
                force, torque = self.force_on(probe.body, probe.region)
                rows = [(f"force_{axis}", float(force[k]), "N") for k, axis in enumerate("xyz")]
                return rows + [(f"torque_{axis}", float(torque[k]), "N m") for k, axis in enumerate("xyz")]
        raise TypeError(f"no measurement for {type(probe).__name__}")

    def water_height(self, x: float, z: float) -> float:
        """Highest point on the vertical line where the fluid fills half of the kernel [m]; nan without fluid there."""
        across = np.hypot(self.points[:, 0] - x, self.points[:, 2] - z)
        near = self.points[across < self.h]
        if not len(near):
            return math.nan
        from sim.fluid.kernel import cubic_host

        volume = self.mass / self.spec.rest_density
        heights = _heights(near[:, 1], self.h)
        offsets = np.hypot(near[:, 0] - x, near[:, 2] - z)
        filled = np.array([cubic_host(np.hypot(offsets, near[:, 1] - y), self.h).sum() for y in heights]) * volume
        above = np.flatnonzero(filled >= 0.5)
        if not len(above) or above[0] == 0:
            return math.nan
        k = above[0]
        share = (0.5 - filled[k - 1]) / (filled[k] - filled[k - 1])
        return float(heights[k - 1] + share * (heights[k] - heights[k - 1]))

    def front(self, axis: str) -> float:
        """Furthest particle's surface along the axis [m]; negative axes measure downwards along it."""
        if not len(self.points):
            return math.nan
        along = self.points[:, "xyz".index(axis[-1])]
        radius = self.spec.particle_radius
        return float(along.min() - radius) if axis.startswith("-") else float(along.max() + radius)

    def volume(self) -> float:
        """Sum of m / rho [m^3]; a density below rest, as at the free surface, is the kernel's lack, not the fluid's."""
        return float((self.mass / np.maximum(self.density, self.spec.rest_density)).sum())

    def force_on(self, body: str, region: Region | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Force [N] and torque about its centre of mass [N m] that the fluid exerts on a solid, or on the part of its
        surface that is in a region."""
        from sim.coupling.fluid_rigid.force_on_solid import reaction

        box = np.array([region.low, region.high]) - self.world.origin if region else None

        for index, item in enumerate(self.world.obstacles.placed):
            if item.name == body and item.motion and item.motion.obeys_forces:
                return self.world.floating.acting(index)
            if item.name == body:
                centre = item.centre_at(self.time) - self.world.origin
                return reaction(self.world.fluid.system, index, centre, box)
        return np.zeros(3), np.zeros(3)


def _of_sheet(world: World, probe: VertexPosition | PinForce) -> list[tuple[str, float, str]]:
    """Where a vertex is, or what holds the sheet; nothing while that is not there."""
    if world.cloth is None or not any(item.name == probe.sheet for item in world.sheets):
        return []
    if isinstance(probe, PinForce):
        force = world.cloth.pin_force(probe.sheet)
        return [(f"force_{axis}", float(force[k]), "N") for k, axis in enumerate("xyz")]
    place = world.cloth.vertices(probe.sheet)[0][probe.vertex]
    return [(f"position_{axis}", float(place[k]), "m") for k, axis in enumerate("xyz")]


def _heights(particles: np.ndarray, h: float) -> np.ndarray:
    """Heights [m] from the top down, h / 16 apart, without those that no particle reaches: drops may be far apart."""
    step, top = h / 16, particles.max() + h
    middle = np.unique(((top - particles) // step).astype(np.int64))
    return top - step * np.unique(middle[:, None] + np.arange(-17, 19))
