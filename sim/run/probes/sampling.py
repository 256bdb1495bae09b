"""Rows of the probes during a run, each at its own rate."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from common.registry import load
from sim.run.probes.means import Gathered
from sim.run.probes.probe import ProbeSettings, Row
from sim.run.probes.view import View
from sim.spec import SimulationSpec

if TYPE_CHECKING:
    from sim.run.world import World

COLUMNS = ("time", "probe", "quantity", "value", "unit")


class Probes:
    """The probes of a scene, when each is due next [s], and what those that tell means have gathered."""

    def __init__(
        self,
        spec: SimulationSpec,
        due: dict[str, float] | None = None,
        gathered: dict[str, Gathered] | None = None,
    ):
        self.probes = spec.probes
        self.fps = spec.fps
        self.due = {name: 0.0 for name in self.probes} | (due or {})
        self.gathered = {name: replace(values) for name, values in (gathered or {}).items()}

    def sample(self, world: World, time: float) -> Iterator[tuple[float, str, str, float, str]]:
        """Rows for the probes that are due at or before `time` [s], with the time of this step."""
        view = View(world, time)
        for name, probe in self.probes.items():
            means, is_due = getattr(probe, "mean", False), self.due[name] <= time + 1e-12
            if not (is_due or means):
                continue
            if is_due:
                rate = probe.rate or self.fps
                self.due[name] = (math.floor(time * rate + 1e-6) + 1) / rate
            rows = _read(probe, view)
            if means and not rows:
                self.gathered.pop(name, None)
            elif means:
                rows = self.gathered.setdefault(name, Gathered(time, time)).take(rows, time, is_due=is_due)
            for quantity, value, unit in rows:
                yield time, name, quantity, value, unit


def _read(probe: ProbeSettings, view: View) -> list[Row]:
    """All that a probe measures now; nothing where its material is not there."""
    if probe.MATERIAL in ("fluid", "cloth") and getattr(view.world, probe.MATERIAL) is None:
        return []
    return list(load(probe.IMPLEMENTATION)(probe, view))
