"""What comes in through emitters and goes out through drains, in every step of every solver."""

import math
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from sim.arrays import numpy_real
from sim.fluid.drains import Drains, Sink
from sim.fluid.emitters import Outlet
from sim.fluid.streams import LED, Streams
from sim.fluid.system import FluidSystem


@dataclass
class Sent:
    """What one emitter has to remember between steps.

    number: the emitter's own, never given to another; layers: length of its stream so far over the spacing.
    """

    number: int
    layers: float = 0.0
    warned: bool = False


@dataclass
class Ledger:
    """What emission has to remember between steps, events and parts of a run."""

    sent: dict[str, Sent] = field(default_factory=dict)
    full: bool = False
    """Whether it was said that there are as many particles as the scene allows."""

    def of(self, name: str) -> Sent:
        return self.sent.setdefault(name, Sent(len(self.sent)))

    def state(self) -> dict[str, Any]:
        return asdict(self)

    @classmethod
    def load(cls, state: dict[str, Any]) -> "Ledger":
        return cls({name: Sent(**values) for name, values in state["sent"].items()}, state["full"])


@dataclass(frozen=True)
class Layer:
    """Particles that are due: how far beyond the outlet they are at the end of the step [m]."""

    outlet: Outlet
    sent: Sent
    distance: float
    time: float


class Flow:
    """Emitters and drains of a fluid.

    `counts` has what is told in summary.json, and by it the next identity; `free` says whether fluid can be at points
    [m], shape [n, 3], among the solids; `warn` takes what the user should know.
    """

    def __init__(
        self,
        system: FluidSystem,
        origin: np.ndarray,
        outlets: list[Outlet],
        sinks: list[Sink],
        ledger: Ledger,
        counts: Any,
        free: Callable[[Outlet], np.ndarray],
        warn: Callable[[str], None],
    ):
        self.system = system
        self.origin = origin
        self.outlets = outlets
        self.ledger = ledger
        self.counts = counts
        self.warn = warn
        self.time = 0.0
        """Begin of the present step [s]."""
        self.streams = Streams({ledger.of(outlet.name).number: outlet for outlet in outlets}, origin)
        self.drains = Drains(sinks, origin)
        self._free = {outlet.name: free(outlet) for outlet in outlets}

    def lead(self) -> None:
        """Hold the particles in the nozzles to their way, whatever forces there are."""
        if self.outlets and self.system.count:
            self.streams.lead(self.system)

    def exchange(self, dt: float) -> bool:
        """Take out and bring in what the step dt [s] demands, when particles have moved and are not yet sorted; whether
        there was anything."""
        drained = self.drains.remove(self.system.particles, self.time + dt)
        self.counts.particles_drained += drained
        emitted = sum([self._send(layer) for layer in self._due(dt)])
        return drained + emitted > 0

    def _due(self, dt: float) -> Iterator[Layer]:
        """The layers that leave their outlets in the step; the middle of the first is due after half a spacing."""
        end = self.time + dt
        for outlet in self.outlets:
            sent = self.ledger.of(outlet.name)
            before = sent.layers
            sent.layers += outlet.way(self.time, end) / outlet.spacing
            after_stop = outlet.speed * max(0.0, end - max(outlet.stop, self.time))
            for layer in range(math.floor(before + 0.5), math.floor(sent.layers + 0.5)):
                distance = (sent.layers - layer - 0.5) * outlet.spacing + after_stop
                yield Layer(outlet, sent, distance, end - distance / outlet.speed)

    def _send(self, layer: Layer) -> int:
        """Add the particles of a layer that have room; how many."""
        outlet, sent, system = layer.outlet, layer.sent, self.system
        free = self._free[outlet.name].copy()
        if system.count:
            blocked, tight = self.streams.obstructed(system, sent.number, layer.distance)
            free &= ~blocked & (not tight)
            if tight:
                # Led particles would go on to press into fluid that can not give way.
                self.streams.let_go(system, sent.number)
        missing = len(free) - int(free.sum())
        self.counts.particles_blocked += missing
        if missing and not sent.warned:
            sent.warned = True
            self.warn(f"outlet '{outlet.name}' is blocked at t={layer.time:.4g} s: {missing} of {len(free)} particles")
        count, room = len(free) - missing, system.spec.max_particles - system.count
        if count > room:
            self.counts.particles_over_limit += count
            if not self.ledger.full:
                self.ledger.full = True
                limit = f"fluid.max_particles = {system.spec.max_particles:,} is reached"
                self.warn(f"{limit} at t={layer.time:.4g} s: '{outlet.name}' pauses while there are so many")
            return 0
        self._add(outlet.points[free] + layer.distance * outlet.direction, outlet, sent.number)
        return count

    def _add(self, points: np.ndarray, outlet: Outlet, number: int) -> None:
        first, count = self.counts.particles_started + self.counts.particles_emitted, len(points)
        velocity = [*(outlet.speed * outlet.direction), self.system.spec.rest_density]
        self.system.particles.extend(
            {
                "position": np.column_stack((points - self.origin, np.zeros(count))).astype(numpy_real),
                "velocity": np.tile(np.array(velocity, numpy_real), (count, 1)),
                "acceleration": np.zeros((count, 4), numpy_real),
                "tag": np.column_stack((first + np.arange(count), np.full(count, LED - number))).astype(np.int32),
            }
        )
        self.counts.particles_emitted += count
