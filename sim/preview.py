"""What a scene would simulate, found without simulating: the checks that need geometry."""

from __future__ import annotations

from pathlib import Path

from sim.events import spec_at
from sim.spec import SimulationSpec
from sim.world import Counts, World


def preview(spec: SimulationSpec, folder: Path) -> str:
    """One line about what the scene holds at the start; raises Refused for what can not be simulated."""
    for event in spec.events:
        World(spec_at(spec, event.at), folder)
    world = World(spec_at(spec, 0.0), folder)
    solids = len(world.obstacles.placed) + len(world.obstacles.boxes)
    parts = [f"{solids} solid{'' if solids == 1 else 's'}"]
    if spec.fluid is not None:
        from sim.fluid.part import FluidState

        counts = Counts()
        names = list(spec.fluid.bodies)
        state = world.pour(FluidState(), names, names, counts)
        parts.insert(0, f"{state.count:,} fluid particles")
        if counts.particles_without_room:
            parts.append(f"{counts.particles_without_room:,} particles removed inside solids or outside containers")
    for item in world.obstacles.placed:
        if item.solid.report is not None:
            parts += [f"{item.name}: {line}" for line in item.solid.report.lines()]
    return "; ".join(parts)
