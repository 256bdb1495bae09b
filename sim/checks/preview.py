"""What a scene would simulate, found without simulating: the checks that need geometry."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from scene.events import spec_at
from scene.settings import Caution, Refused
from sim.bodies.overlaps import overlaps
from sim.checks.probe_places import idle_probes
from sim.run.first_step import refuse_jumps, refuse_steps
from sim.run.placing.placed_scene import PlacedScene
from sim.run.reporting.counts import Counts
from sim.spec import Event, SimulationSpec


@dataclass(frozen=True)
class Preview:
    """What a scene holds at the start, and later."""

    placed: PlacedScene
    contents: str
    """In one line."""
    points: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """Places of the particles [m], shape [n, 3]."""
    cautions: tuple[Caution, ...] = ()
    later: tuple[PlacedScene, ...] = ()
    """What there is after each event, as if nothing had moved."""


def preview(spec: SimulationSpec, folder: Path) -> Preview:
    """What the scene holds at the start, and what a run would warn of; raises Refused for what cannot be simulated."""
    scenes: list[PlacedScene] = []
    coming: list[Caution] = []
    for index, event in enumerate(spec.events):
        then = spec_at(spec, event.at)
        try:
            scenes.append(_placed_after(then, folder, event))
            coming += _of_coming_sheets(then, folder, event, index)
        except Refused as refused:
            raise _in_event(refused, event, index) from None
    placed = PlacedScene(spec_at(spec, 0.0), folder)
    placed.untangle(0.0)
    solids = len(placed.obstacles.names)
    parts = [f"{solids} solid{'' if solids == 1 else 's'}"]
    points, velocity = np.zeros((2, 0, 3))
    if spec.fluid is not None:
        points, velocity, counts = _pour(placed, list(spec.fluid.bodies), 0.0)
        parts.insert(0, f"{len(points):,} fluid particles")
        parts += [volume.line() for volume in placed.volumes.values()]
        if counts.particles_without_room:
            parts.append(f"{counts.particles_without_room:,} particles have no room")
        for outlet in placed.outlets:
            flow = f"{outlet.rate:.3g} m^3/s at {outlet.speed:.3g} m/s"
            parts.append(f"{outlet.name}: {flow}, {outlet.particle_rate:,.0f} particles a second")
    if placed.sheets:
        parts.insert(-1, f"{sum(len(item.fabric.points) for item in placed.sheets):,} points of cloth")
    for item in placed.obstacles.placed:
        if item.solid.report is not None:
            parts += [f"{item.name}: {line}" for line in item.solid.report.lines()]
    refuse_steps(placed, velocity)
    start = list(_of_the_start(placed))
    known = {caution.text for caution in start}
    for index, (event, later) in enumerate(zip(spec.events, scenes, strict=True)):
        coming += [caution for caution in _of_a_change(event, later, index) if caution.text not in known]
    cautions = (*start, *coming, *idle_probes([placed, *scenes]))
    return Preview(placed, "; ".join(parts), points, cautions, tuple(scenes))


def _of_the_start(placed: PlacedScene) -> Iterator[Caution]:
    """What a run says as it begins."""
    yield from (Caution(text) for text in placed.warnings())
    for one, other, depth in overlaps(placed.obstacles):
        yield Caution(_overlap(one, other, depth), ("rigid", "bodies", one))
    for item in placed.untangled or []:
        yield Caution(item.line(), ("cloth", "sheets", item.sheet))


def _of_a_change(event: Event, placed: PlacedScene, index: int) -> Iterator[Caution]:
    """What a run says as an event brings something in, as far as it does not depend on what moved until then."""
    location = ("events", index, "add")
    yield from (Caution(text, location) for text in placed.warnings())
    standing = {item.name for item in placed.obstacles.placed if item.motion is None}
    known = standing | {wall.body for wall in placed.obstacles.walls} | event.add.rigid.keys()
    for one, other, depth in overlaps(placed.obstacles):
        if {one, other} <= known and {one, other} & event.add.rigid.keys():
            yield Caution(_overlap(one, other, depth), location)


def _overlap(one: str, other: str, depth: float) -> str:
    return f"'{one}' and '{other}' begin {depth * 1000:.3g} mm or more inside each other: move one of them away"


def _of_coming_sheets(spec: SimulationSpec, folder: Path, event: Event, index: int) -> Iterator[Caution]:
    """What a run says of cloth that an event brings in, among what stands; raises Refused as a run does."""
    if not event.add.cloth or spec.cloth is None:
        return
    standing = {
        name: body for name, body in (spec.rigid.bodies if spec.rigid else {}).items() if body.motion == "static"
    }
    rigid = spec.rigid.model_copy(update={"bodies": standing}) if spec.rigid and standing else None
    cloth = spec.cloth.model_copy(update={"sheets": event.add.cloth})
    placed = PlacedScene(spec.model_copy(update={"fluid": None, "rigid": rigid, "cloth": cloth, "probes": {}}), folder)
    placed.untangle(event.at)
    for sheet in placed.sheets:
        refuse_jumps(sheet, event.at)
    for item in placed.untangled or []:
        yield Caution(item.line(), ("events", index, "add", "cloth", item.sheet))


def _placed_after(spec: SimulationSpec, folder: Path, event: Event) -> PlacedScene:
    placed = PlacedScene(spec, folder)
    if event.add.fluid:
        _pour(placed, list(event.add.fluid), event.at)
    return placed


def _pour(placed: PlacedScene, bodies: list[str], time: float) -> tuple[np.ndarray, np.ndarray, Counts]:
    """Places [m] and velocities [m/s] of the particles of fluid bodies at `time` [s], shape [n, 3], as if no other
    fluid were there; raises Refused."""
    from sim.fluid.model import FluidState

    counts = Counts()
    state = placed.pour(FluidState(), bodies, bodies, counts, time)
    return state.position[:, :3].astype(np.float64) + placed.origin, state.velocity[:, :3], counts


def _in_event(refused: Refused, event: Event, index: int) -> Refused:
    """The refusal of a body that the event adds, at its place in the event."""
    for place, part in enumerate(refused.location):
        if part in event.add.names():
            group = refused.location[1] if refused.location[1] in {"emitters", "drains"} else refused.location[0]
            location = ("events", index, "add", group, *refused.location[place:])
            return Refused(refused.message, location=location, remedy=refused.remedy)
    return refused
