"""What a scene would simulate, found without simulating: the checks that need geometry."""

from __future__ import annotations

from pathlib import Path

from sim.events import spec_at
from sim.settings import Refused
from sim.spec import Event, SimulationSpec
from sim.world import Counts, World


def preview(spec: SimulationSpec, folder: Path) -> str:
    """One line about what the scene holds at the start, and one for each warning; raises Refused for what can not be
    simulated."""
    for index, event in enumerate(spec.events):
        try:
            world = World(spec_at(spec, event.at), folder)
            if event.add.fluid:
                _pour(world, list(event.add.fluid), event.at)
        except Refused as refused:
            raise _in_event(refused, event, index) from None
    world = World(spec_at(spec, 0.0), folder)
    solids = len(world.obstacles.names)
    parts = [f"{solids} solid{'' if solids == 1 else 's'}"]
    if spec.fluid is not None:
        particles, counts = _pour(world, list(spec.fluid.bodies), 0.0)
        parts.insert(0, f"{particles:,} fluid particles")
        parts += [volume.line() for volume in world.volumes.values()]
        if counts.particles_without_room:
            parts.append(f"{counts.particles_without_room:,} particles have no room")
        for outlet in world.outlets:
            flow = f"{outlet.rate:.3g} m^3/s at {outlet.speed:.3g} m/s"
            parts.append(f"{outlet.name}: {flow}, {outlet.particle_rate:,.0f} particles a second")
    if world.sheets:
        parts.insert(-1, f"{sum(len(item.fabric.points) for item in world.sheets):,} points of cloth")
    for item in world.obstacles.placed:
        if item.solid.report is not None:
            parts += [f"{item.name}: {line}" for line in item.solid.report.lines()]
    warnings = [f"\n  warning: {text}" for text in world.warnings()]
    return "; ".join(parts) + "".join(warnings)


def _pour(world: World, bodies: list[str], time: float) -> tuple[int, Counts]:
    """How many particles the fluid bodies have at `time` [s], as if no other fluid were there; raises Refused."""
    from sim.fluid.part import FluidState

    counts = Counts()
    return world.pour(FluidState(), bodies, bodies, counts, time).count, counts


def _in_event(refused: Refused, event: Event, index: int) -> Refused:
    """The refusal of a body that the event adds, at its place in the event."""
    for place, part in enumerate(refused.location):
        if part in event.add.names():
            group = refused.location[1] if refused.location[1] in {"emitters", "drains"} else refused.location[0]
            location = ("events", index, "add", group, *refused.location[place:])
            return Refused(refused.message, location=location, remedy=refused.remedy)
    return refused
