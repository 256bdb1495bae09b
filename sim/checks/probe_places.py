"""Probes that look where nothing comes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scene.settings import Caution
from sim.run.placing.placed_scene import PlacedScene
from sim.run.probes.probe import ProbeSettings
from sim.run.probes.spec import BodyForce, Pressure, Region, WaterHeight

FAR = 5.0
"""Beyond so many diagonals of the box around all that happens there is nothing."""


def idle_probes(scenes: list[PlacedScene]) -> Iterator[Caution]:
    """One for each probe that looks where nothing comes in all of `scenes`: the scene as it begins, and after each of
    its events."""
    for name, probe in scenes[0].spec.probes.items():
        reasons = [_idle(probe, placed) for placed in scenes]
        if all(reasons):
            field = "at" if isinstance(probe, Pressure) else "region" if isinstance(probe, BodyForce) else "x"
            yield Caution(f"'{name}' {reasons[0]}, and will measure nothing: move it", ("probes", name, field))


def _idle(probe: ProbeSettings, placed: PlacedScene) -> str:
    """Why a probe measures nothing in this scene; empty where it may."""
    if isinstance(probe, BodyForce) and probe.region is not None:
        return _beside_its_body(probe.body, probe.region, placed)
    if placed.spec.fluid is None or not isinstance(probe, Pressure | WaterHeight):
        return ""
    reach = placed.spec.fluid.support_radius
    line = isinstance(probe, WaterHeight)
    place = np.array([probe.x, 0.0, probe.z] if isinstance(probe, WaterHeight) else probe.at)
    across = np.array([1.0, 0.0, 1.0]) if line else np.ones(3)
    for wall in placed.obstacles.walls:
        depth = wall.offset - float(place @ wall.normal)
        upright = abs(wall.normal[1]) < 1e-9
        if depth > reach and (upright or not line):
            return f"is {depth:.3g} m behind a wall of '{wall.body}'"
    for item in placed.obstacles.placed if not line else ():
        if item.motion is None and item.solid.closed:
            depth = -float(item.solid.signed_distance(place[None])[0]) * (-1 if item.hollow else 1)
            if depth > reach:
                return f"is {depth:.3g} m {'outside of' if item.hollow else 'inside'} '{item.name}'"
    low, high = placed.bounds
    away = float(np.linalg.norm(across * np.maximum(0.0, np.maximum(low - place, place - high))))
    if away > FAR * float(np.linalg.norm(high - low)):
        return f"is {away:.3g} m from all that happens"
    return ""


def _beside_its_body(body: str, region: Region, placed: PlacedScene) -> str:
    """Why a probe of the force in a region measures nothing of a body that does not obey forces; empty where it may."""
    low, high = np.array(region.low), np.array(region.high)
    for item in placed.obstacles.placed:
        led = item.motion is not None and (item.motion.obeys_forces or item.motion.endless)
        beside = np.any((item.bounds[1] < low) | (item.bounds[0] > high))
        if item.name == body and beside and not led:
            return f"looks at a region in which '{body}' never is"
    return ""
