"""Where a vertex of a sheet is."""

from __future__ import annotations

from collections.abc import Iterator

from scene.settings import given
from sim.run.probes.probe import Row
from sim.run.probes.spec import VertexPosition
from sim.run.probes.view import View

MATERIALS = ("cloth",)


def read(probe: VertexPosition, view: View) -> Iterator[Row]:
    """Its three coordinates [m]; nothing while the sheet is not there."""
    if view.has_sheet(probe.sheet):
        place = given(view.world.cloth).vertices(probe.sheet)[0][probe.vertex]
        yield from ((f"position_{axis}", float(place[k]), "m") for k, axis in enumerate("xyz"))
