"""What holds a sheet."""

from __future__ import annotations

from collections.abc import Iterator

from scene.settings import given
from sim.run.probes.probe import Row
from sim.run.probes.spec import PinForce
from sim.run.probes.view import View

MATERIALS = ("cloth",)


def read(probe: PinForce, view: View) -> Iterator[Row]:
    """Force of all pins [N], three components; nothing while the sheet is not there."""
    if view.has_sheet(probe.sheet):
        force = given(view.world.cloth).pin_force(probe.sheet)
        yield from ((f"force_{axis}", float(force[k]), "N") for k, axis in enumerate("xyz"))
