"""Whether fluid can leave an outlet among solids."""

from __future__ import annotations

from dataclasses import replace

from scene.settings import Refused
from sim.bodies.obstacles import Obstacles
from sim.coupling.fluid_solids import allowed
from sim.fluid.inflow.emitters import Outlet
from sim.fluid.seeding.seed import START_CLEARANCE

MATERIALS = ("fluid",)
"""Of a scene, for this to be loaded."""


def refuse_obstructed(outlet: Outlet, obstacles: Obstacles) -> None:
    """Raise Refused where a solid is in the outlet, or in the way of the particles that are led from it."""
    clearance = START_CLEARANCE * outlet.spacing
    for name in dict.fromkeys([wall.body for wall in obstacles.walls] + [item.name for item in obstacles.placed]):
        walls = [wall for wall in obstacles.walls if wall.body == name]
        one = replace(obstacles, walls=walls, placed=[item for item in obstacles.placed if item.name == name])
        if not allowed(one, outlet.lane, clearance, 0.0).all():
            raise Refused(
                f"'{name}' is in the way of '{outlet.name}', from which fluid moves straight on for "
                f"{outlet.nozzle:.3g} m, {clearance:.2g} m off every solid",
                location=outlet.location,
                remedy="let the emitter point into free space, or make it smaller",
            )
