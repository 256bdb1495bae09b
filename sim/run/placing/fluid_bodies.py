"""Which fluid bodies there are in the course of a run, and which particles are theirs."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from sim.spec import SimulationSpec

if TYPE_CHECKING:
    from sim.fluid.model import FluidState
    from sim.run.reporting.counts import Counts


def numbered(spec: SimulationSpec) -> list[str]:
    """Fluid bodies in the order in which they are numbered: those of the start, then of the events."""
    names = list(spec.fluid.bodies) if spec.fluid else []
    return names + [name for event in spec.events for name in event.add.fluid]


def without(state: FluidState, removed: Iterable[str], names: list[str], counts: Counts) -> FluidState:
    """The particles of all bodies but those that an event removes; `names` numbers all bodies of the scene."""
    for name in removed:
        if name in names:
            before = state.count
            state = state.without_body(names.index(name))
            counts.particles_removed_by_events += before - state.count
    return state
