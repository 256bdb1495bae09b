"""What is known of a film before it is made, and may not be what was meant, or cannot be rendered: a camera in the
water, changes that come after the end, a panorama that is no picture."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from render import program
from render.errors import Unusable
from scene import assets
from scene.diagnostics import idle
from scene.load import Scene
from scene.names import resolve
from scene.settings import Caution, Refused
from sim.checks.preview import Preview
from sim.run.placing.extent import LEVEL, filmed
from workflow.stages.film.spec import ALPHA

CLEAR = ("water", "glass")
"""Looks that focus light; those of installed packages say nothing of it."""


def cautions(scene: Scene, found: Preview) -> Iterator[Caution]:
    """One for each thing that the film would not show, or not as it was meant."""
    yield from idle.cautions(scene)
    yield from _after_the_end(scene)
    yield from _of_the_camera(scene, found)
    if scene.film.crf == 0:
        text = "few players take lossless H.264: give 1 or more, and film.also: [prores] to edit"
        yield Caution(text, ("film", "crf"))
    if scene.render.background.type == "transparent" and not scene.film.also:
        text = f"the MP4 cannot keep it: add one of {', '.join(ALPHA)} to film.also, or use frames/*.png"
        yield Caution(text, ("render", "background", "type"))
    yield from _of_caustics(scene)
    blender = program.chosen()
    if blender is not None and shutil.which(blender) is None:
        yield Caution(f"there is no Blender at {blender} on this machine, which {program.VARIABLE} names")


def refuse_panorama(scene: Scene) -> None:
    """Raise Refused for a panorama that Blender cannot read. Without the package bpy, rendering tells."""
    file = scene.render.lights.environment.file
    if file is None or importlib.util.find_spec("bpy") is None:
        return
    if not _readable(assets.resolve(file, scene.folder)):
        location, remedy = ("render", "lights", "environment", "file"), "save it as .hdr or .exr again"
        raise Refused(f"Blender cannot read '{file}'", location=location, remedy=remedy)


def _readable(panorama: Path) -> bool:
    command = [sys.executable, "-m", "render.panorama", str(panorama)]
    return subprocess.run(command, capture_output=True, check=False).returncode != Unusable.exit_code


def _after_the_end(scene: Scene) -> Iterator[Caution]:
    """What happens when the film is over; probes of what only comes then measure nothing."""
    end = scene.duration
    over = f"and the film ends at {end:g} s: raise duration, or remove it"
    for index, event in enumerate(scene.simulation.events):
        if event.at >= end:
            yield Caution(f"happens at {event.at:g} s, {over}", ("events", index))
    known = resolve(scene.simulation)
    for item in known.values():
        late = _begins(item.body)
        if late is not None and late[0] >= end:
            yield Caution(f"begins at {late[0]:g} s, {over}", (*item.location, late[1]))
    for name, probe in scene.simulation.probes.items():
        for key in ("body", "sheet"):
            target = known.get(getattr(probe, key, ""))
            if target and target.location[0] == "events" and scene.simulation.events[int(target.location[1])].at >= end:
                text = f"'{getattr(probe, key)}' is not there before the film ends at {end:g} s: remove the probe"
                yield Caution(text, ("probes", name, key))


def _begins(body: Any) -> tuple[float, str] | None:
    """When something that works for a part of the time begins [s], and the setting that says so."""
    keyframes: tuple[Any, ...] = getattr(body, "keyframes", ())
    if len(keyframes) > 1:
        return keyframes[0].at, "keyframes"
    start = getattr(body, "start", None)
    return (start, "start") if start is not None else None


def _of_caustics(scene: Scene) -> Iterator[Caution]:
    """Where there is nothing to focus light, or no lamp whose light could be."""
    render, lights = scene.render, scene.render.lights
    if not render.caustics:
        return
    looks = [*render.materials.values(), *([render.water] if scene.simulation.fluid is not None else [])]
    location = ("render", "caustics")
    if not any(look.type in CLEAR for look in looks):
        yield Caution("changes nothing: no look is of water or glass: add one, or remove it", location)
    if not any((lights.sun.strength, lights.softboxes, *(area.power for area in lights.areas))):
        yield Caution("changes nothing: light of the environment alone is not focused: add a sun or lamps", location)


def _of_the_camera(scene: Scene, found: Preview) -> Iterator[Caution]:
    """Where it stands at the start, if the scene says so."""
    camera = scene.render.camera
    first = camera.keyframes[0] if camera.keyframes else camera
    if first.position is None:
        return
    location = ("render", "camera", *(("keyframes", 0) if camera.keyframes else ()), "position")
    place = np.array(first.position)
    for item in found.placed.obstacles.placed:
        if item.solid.closed and not item.hollow and item.solid.contains(place[None])[0]:
            yield Caution(f"the camera begins inside '{item.name}': move it out", location)
    fluid = scene.simulation.fluid
    if fluid is not None and len(found.points) and cKDTree(found.points).query(place)[0] < fluid.spacing:
        yield Caution("the camera begins under water: move it out, if that is not meant", location)
    ground = _ground(scene, found)
    if place[1] < ground:
        text = f"the camera begins below the ground at y = {ground:.3g} m, which hides everything"
        yield Caution(f"{text}: move it up, or give render.ground.enabled: false", location)


def _ground(scene: Scene, found: Preview) -> float:
    """Height of the ground that is drawn [m]; nowhere without one, or where things may fall for who knows how far."""
    ground = scene.render.ground
    if not ground.enabled:
        return -np.inf
    if ground.height is not None:
        return ground.height
    found_there = filmed(found.placed)
    height = found_there["ground"]["height"]
    if height is None and any(wall.normal[1] > LEVEL for wall in found.placed.obstacles.walls):
        height = found_there["extent"]["min"][1]
    return -np.inf if height is None else height
