"""Volumes in which particles vanish."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scene.settings import Refused
from sim.device.arrays import IntArray, Particles, Vec4Array, vec3, vec4
from sim.device.compiler import ti
from sim.fluid.spec import Drain, Fluid
from sim.geometry.shapes import place
from sim.geometry.solids import Solid


@dataclass(frozen=True)
class Sink:
    """The volume of one drain, and the times [s] between which it works."""

    solid: Solid
    start: float
    stop: float


def find_sink(drain: Drain, fluid: Fluid, folder: Path, location: tuple[str | int, ...]) -> Sink:
    """Place a drain; raises Refused for a bad shape, or one so thin that particles could pass in a step."""
    try:
        solid = place(drain.shape, drain, folder)
    except Refused as refused:
        raise refused.at(*location) from None
    pose = solid.pose
    thinnest = pose.scale * float(np.ptp(pose.to_local(solid.surface.vertices), axis=0).min())
    if thinnest < fluid.spacing:
        raise Refused(
            f"the drain is {thinnest:.3g} m thick: particles {fluid.spacing:.3g} m apart could pass through it",
            location=(*location, "shape"),
            remedy="make it thicker, or use a smaller particle_radius",
        )
    return Sink(solid, drain.start, math.inf if drain.stop is None else drain.stop)


class Drains:
    """The drains of a scene; origin: of the world [m]."""

    def __init__(self, sinks: Sequence[Sink], origin: np.ndarray):
        self.sinks = sinks
        self.origin = origin
        self._found = ti.ndarray(ti.i32, 1024)
        self._points = ti.ndarray(vec4, 1024)

    def remove(self, particles: Particles, time: float) -> int:
        """Take the particles out whose centres lie in a drain that works at `time` [s]; how many those were."""
        if not particles.count:
            return 0
        gone = np.zeros(particles.count, dtype=bool)
        for sink in self.sinks:
            if sink.start <= time < sink.stop:
                gone[self._inside(sink.solid, particles)] = True
        return particles.leave_out(gone)

    def _inside(self, solid: Solid, particles: Particles) -> np.ndarray:
        """Indices of the particles in a solid: its distance is asked for those in its box only."""
        low, high = np.asarray(solid.bounds) - self.origin
        while True:
            number = _find(particles.count, vec3(*low), vec3(*high), particles.position, self._found, self._points)
            if number <= self._found.shape[0]:
                break
            self._found, self._points = ti.ndarray(ti.i32, 2 * number), ti.ndarray(vec4, 2 * number)
        if not number:
            return np.zeros(0, np.int32)
        points = self._points.to_numpy()[:number, :3].astype(np.float64) + self.origin
        return self._found.to_numpy()[:number][solid.contains(points)]


@ti.kernel
def _find(count: ti.i32, low: vec3, high: vec3, position: Vec4Array, found: IntArray, points: Vec4Array) -> ti.i32:
    """Indices and positions of the particles in a box, in no particular order, as far as there is room; how many."""
    number = 0
    for i in range(count):
        x = position[i]
        if (low <= x.xyz).all() and (x.xyz <= high).all():
            slot = ti.atomic_add(number, 1)
            if slot < found.shape[0]:
                found[slot] = i
                points[slot] = x
    return number
