"""What comes in through emitters and goes out through drains, in every step of every solver."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from sim.device.arrays import numpy_real
from sim.fluid.births import Births
from sim.fluid.inflow.drains import Drains, Sink
from sim.fluid.inflow.emitters import Outlet
from sim.fluid.inflow.streams import LED, Streams
from sim.fluid.system import FluidSystem

ROUNDING = 1e-9
"""Layers that a stream may be short by, so that rounding does not hold one back for a step."""


@dataclass
class Sent:
    """What one emitter has to remember between steps.

    number: the emitter's own, never given to another; layers: length of its stream so far over the spacing.
    """

    number: int
    layers: float = 0.0
    warned: bool = False


class Ledger:
    """What emission has to remember between steps, events and parts of a run, by the name of the emitter.

    Made from what `state` returned, or from nothing.
    """

    def __init__(self, state: dict[str, Any]):
        self.sent = {name: Sent(**values) for name, values in state.get("sent", {}).items()}
        self.full: bool = state.get("full", False)
        """Whether it was said that there are as many particles as the scene allows."""

    def of(self, name: str) -> Sent:
        """What an emitter has to remember; one that is not known yet gets the next number."""
        return self.sent.setdefault(name, Sent(len(self.sent)))

    def state(self) -> dict[str, Any]:
        """Plain data for a checkpoint."""
        return {"sent": {name: asdict(sent) for name, sent in self.sent.items()}, "full": self.full}


class Flow:
    """Emitters and drains of a fluid.

    `counts` has what is told in summary.json, and by it the next identity; `births` takes what comes; `free` says
    whether fluid can be at points [m], shape [n, 3], among the solids at a time [s]; `warn` takes what the user should
    know.
    """

    def __init__(
        self,
        system: FluidSystem,
        origin: np.ndarray,
        outlets: Sequence[Outlet],
        sinks: Sequence[Sink],
        ledger: Ledger,
        counts: Any,
        births: Births,
        free: Callable[[np.ndarray, float], np.ndarray],
        warn: Callable[[str], None],
    ):
        self.system = system
        self.origin = origin
        self.outlets = outlets
        self.ledger = ledger
        self.counts = counts
        self.births = births
        self.free = free
        self.warn = warn
        self.time = 0.0
        """Begin of the present step [s]."""
        self.streams = Streams({ledger.of(outlet.name).number: outlet for outlet in outlets}, origin)
        self.drains = Drains(sinks, origin)

    def lead(self) -> None:
        """Hold the particles in the nozzles to their way, whatever forces there are."""
        if self.outlets and self.system.count:
            self.streams.lead(self.system)

    def exchange(self, dt: float) -> bool:
        """Take out and bring in what the step dt [s] demands, when particles have moved and are not yet sorted; whether
        there was anything."""
        drained = self.drains.remove(self.system.particles, self.time + dt)
        self.counts.particles_drained += drained
        emitted = sum([self._send(*layer, self.time + dt) for layer in self._due(dt)])
        return drained + emitted > 0

    def fastest(self, time: float) -> float:
        """The greatest speed [m/s] of the emitters that work at `time` [s] or later."""
        return max((outlet.speed for outlet in self.outlets if outlet.stop > time), default=0.0)

    def _due(self, dt: float) -> Iterator[tuple[Outlet, float]]:
        """The layers whose backs leave their outlets in the step, and how far beyond they are at its end [m]."""
        end = self.time + dt
        for outlet in self.outlets:
            sent = self.ledger.of(outlet.name)
            whole = _whole(sent.layers)
            sent.layers += outlet.distance(self.time, end) / outlet.spacing
            since_stop = outlet.speed * max(0.0, end - max(outlet.stop, self.time))
            for layer in range(whole + 1, _whole(sent.layers) + 1):
                yield outlet, (sent.layers - layer) * outlet.spacing + since_stop

    def _send(self, outlet: Outlet, distance: float, end: float) -> int:
        """Add the particles that have room of a layer that has come `distance` [m] beyond its outlet at `end` [s], the
        end of the step; how many."""
        system, sent = self.system, self.ledger.of(outlet.name)
        points = outlet.points + distance * outlet.direction
        free = self.free(points, self.time)
        if system.count:
            free &= ~self.streams.crowded(system, sent.number, distance)
        count = int(free.sum())
        missing = len(points) - count
        self.counts.particles_blocked += missing
        if missing and not sent.warned:
            sent.warned = True
            self.warn(f"emitter '{outlet.name}' is blocked at t={self.time:.4g} s: what has no room is not emitted")
        if count > system.spec.max_particles - system.count:
            self.counts.particles_over_limit += count
            if not self.ledger.full:
                self.ledger.full = True
                limit = f"fluid.max_particles = {system.spec.max_particles:,} is reached"
                self.warn(f"{limit} at t={self.time:.4g} s: emitters pause while there are so many")
            return 0
        self._add(points[free], outlet, sent.number, end - distance / outlet.speed)
        return count

    def _add(self, points: np.ndarray, outlet: Outlet, number: int, time: float) -> None:
        """Add particles whose backs left their outlet at `time` [s]."""
        count = len(points)
        if not count:
            return
        first = self.counts.particles_started + self.counts.particles_emitted
        velocity = [*outlet.velocity, self.system.spec.rest_density]
        self.system.particles.extend(
            {
                "position": np.column_stack((points - self.origin, np.zeros(count))).astype(numpy_real),
                "velocity": np.tile(np.array(velocity, numpy_real), (count, 1)),
                "acceleration": np.zeros((count, 4), numpy_real),
                "tag": np.column_stack((first + np.arange(count), np.full(count, LED - number))).astype(np.int32),
                "slack": np.zeros(count, numpy_real),
                "eased": np.zeros(count, numpy_real),
            }
        )
        self.births.add(first, time, outlet.name)
        self.counts.particles_emitted += count


def _whole(layers: float) -> int:
    return math.floor(layers + ROUNDING)
