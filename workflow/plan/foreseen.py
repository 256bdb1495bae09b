"""What is known of a film before it is made, and may not be what was meant, or cannot be rendered: a camera in the
water, changes that come after the end, pictures that are none."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from common.imported.image_files import MOST_PIXELS
from render import program
from render.errors import Unusable
from render.texturing import MARK, WHOLE
from render.texturing.spec import Imported, images_of
from scene import assets
from scene.diagnostics import idle
from scene.imported.bodies import about_image, found_in
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
    yield from _of_images(scene, found)
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


def refuse_pictures(scene: Scene, found: Preview) -> None:
    """Raise Refused for panoramas and textures that Blender cannot read, and for UV coordinates that a body has not.
    Without the package bpy, rendering tells of the former."""
    named = resolve(scene.simulation)
    textured = _textured(scene, found)
    for name, look in scene.render.materials.items():
        if getattr(look, "projection", None) == "uv" and not textured.get(name, True):
            location = ("render", "materials", name, "projection")
            raise Refused(f"the mesh of '{name}' has no UV coordinates", location=location, remedy="use box or sphere")
    pictures = {(file, index): place for place, file, index in scene.render.images()}
    if not pictures or importlib.util.find_spec("bpy") is None:
        return
    for file, index in _unreadable(scene, list(pictures)):
        what = f"'{file}'" if index is None else f"the image number {index} in '{file}'"
        remedy = "save it again, as .png, or a panorama as .hdr or .exr" if index is None else "export it again"
        remedy += f", with at most {MOST_PIXELS:,} pixels an edge"
        refused = Refused(f"Blender cannot read {what}", remedy=remedy)
        raise about_image(refused, pictures[file, index], named, scene.render)


def _unreadable(scene: Scene, pictures: list[tuple[str, int | None]]) -> list[tuple[str, int | None]]:
    """Those that a process of its own cannot read, or ends with."""
    command = [sys.executable, "-m", "render.texturing.images"]
    for file, index in pictures:
        command += [str(assets.resolve(file, scene.folder)), WHOLE if index is None else str(index)]
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    if done.returncode < 0:
        return pictures if len(pictures) == 1 else [one for one in pictures if _unreadable(scene, [one])]
    if done.returncode != Unusable.exit_code:
        return []
    line = next(line for line in done.stdout.splitlines() if line.startswith(MARK))
    return [pictures[int(place)] for place in line.removeprefix(MARK).split()]


def _textured(scene: Scene, found: Preview) -> dict[str, bool]:
    """Whether bodies that images lie on have UV coordinates, by their names."""
    wanted = {name for name, look in scene.render.materials.items() if any(images_of(look))}
    bodies = (item for placed in (found.placed, *found.later) for item in placed.obstacles.placed)
    surfaces = {item.name: item.solid.triangles for item in bodies if item.name in wanted}
    return {name: surface is not None and surface.uv is not None for name, surface in surfaces.items()}


def _of_images(scene: Scene, found: Preview) -> Iterator[Caution]:
    """What is not shown of the materials of mesh files, and settings of images that change nothing."""
    textured = _textured(scene, found)
    for name, item in resolve(scene.simulation).items():
        look: Any = scene.render.materials.get(name)
        if isinstance(look, Imported) and look.materials:
            left_out = found_in(item.body, scene.folder, item.location).left_out
            if left_out:
                text = f"of the materials of '{name}' no picture shows {'; '.join(left_out)}"
                yield Caution(text, (*item.location, "shape", "file"))
            if any(look.images()) and not textured.get(name, True):
                text = f"'{name}' has images and no UV coordinates: they lie on it as from a box"
                yield Caution(text, (*item.location, "shape", "file"))
        if getattr(look, "texture_size", None) and look.projection is None and textured.get(name, False):
            text = "changes nothing: the mesh file has UV coordinates; give projection: box too, or remove it"
            yield Caution(text, ("render", "materials", name, "texture_size"))


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
