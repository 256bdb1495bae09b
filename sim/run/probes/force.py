"""Force and torque of the fluid on a solid."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scene.settings import given
from sim.coupling.fluid_rigid.force_on_solid import reaction
from sim.run.probes.probe import Row
from sim.run.probes.spec import BodyForce, Region
from sim.run.probes.view import View

MATERIALS = ("fluid",)


def read(probe: BodyForce, view: View) -> Iterator[Row]:
    """Force [N] and torque [N m], three components each."""
    force, torque = force_on(view, probe.body, probe.region)
    yield from ((f"force_{axis}", float(force[k]), "N") for k, axis in enumerate("xyz"))
    yield from ((f"torque_{axis}", float(torque[k]), "N m") for k, axis in enumerate("xyz"))


def force_on(view: View, body: str, region: Region | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Force [N] and torque about its centre of mass [N m] that the fluid exerts on a solid, or on the part of its
    surface that is in a region."""
    world = view.world
    box = np.array([region.low, region.high]) - world.origin if region else None
    for index, item in enumerate(world.obstacles.placed):
        if item.name == body and item.motion and item.motion.obeys_forces:
            return given(world.floating).acting(index)
        if item.name == body:
            centre = item.centre_at(view.time) - world.origin
            return reaction(given(world.fluid).system, index, centre, box)
    return np.zeros(3), np.zeros(3)
