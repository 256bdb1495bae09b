"""Scenes, simulations and pictures from Python, as in a notebook; `tidemill` offers what is in here as its own."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from common.distribution import HOME, environment
from common.files import write_json
from common.ply import write_surface
from common.simulation_files import BodyTable
from scene.document import SceneError
from scene.load import Scene
from scene.load import load as load_file
from scene.settings import Refused
from tidemill.frame import Body, Frame, Sheet, frames
from workflow.plan.jobs import Plan
from workflow.plan.shelf import SCENE_FILES
from workflow.stages.surface.mesh import Surface
from workflow.stages.surface.spec import ReconstructSpec

__all__ = [
    "Body",
    "Frame",
    "Refused",
    "RenderFailed",
    "Scene",
    "SceneError",
    "Sheet",
    "Surface",
    "frames",
    "load",
    "reconstruct",
    "render",
    "simulate",
]


class RenderFailed(RuntimeError):
    """Blender made no picture; holds what it said."""


def load(scene: str | Path, quality: str | None = None, settings: Mapping[str, Any] | None = None) -> Scene:
    """A scene by its file or name, at a preset, with other settings by their paths: `{"fluid.viscosity": 0.01}`.

    Raises SceneError, whose text names line, field and remedy of every problem.
    """
    overrides = [f"{path}={json.dumps(value)}" for path, value in (settings or {}).items()]
    return load_file(SCENE_FILES.locate(str(scene)), quality=quality, overrides=overrides)


def simulate(
    scene: Scene,
    last: int | None = None,
    out: Path | str | None = None,
    threads: int | None = None,
    arch: str = "auto",
) -> Iterator[Frame]:
    """The frames of a scene to the frame `last` (default: all), each as soon as it is there.

    `out`: the folder for the files of the run, which `frames` reads again; by default they are removed with the last
    frame that is kept. `arch`: auto, cpu or cuda. Raises Refused before the first step, and sim.run.failure.Stopped
    where a step fails in spite of retries.
    """
    from sim.device import precision
    from sim.run.output import Output
    from sim.run.placing.extent import filmed
    from sim.run.stepping import Run

    last = scene.last_frame if last is None else last
    kept = TemporaryDirectory(prefix="tidemill-") if out is None else None
    folder = Path(kept.name if kept else out or "")
    precision.choose(scene.simulation.precision)
    spec = scene.simulation.before(last / scene.simulation.fps)
    run = Run(spec, scene.folder, threads=threads, arch=arch)
    run.start()
    output, table = Output(folder, run.spec), BodyTable(folder)
    try:
        write_json(folder / "summary.json", {"fps": spec.fps} | filmed(run.world))
        for number in range(last + 1):
            run.frames(number, output, write_first=number == 0, done=lambda: None)
            yield Frame(number, run.clock.time, folder, kept, table)
    finally:
        output.close()


def reconstruct(scene: Scene, frame: Frame, threads: int = 1) -> Surface:
    """The surface of the fluid in a frame, as films show it; raises Refused for a scene without fluid."""
    from workflow.stages.bodies import Bodies
    from workflow.stages.surface.surface import reconstruct as surface

    if scene.simulation.fluid is None:
        raise Refused(f"{scene.name} has no fluid, so no surface", remedy="render it without")
    spec = _surface_spec(scene)
    solids = Bodies([frame.folder]).solids(frame.number, spec.vessels) if spec.surface.walls else []
    numbers = None if frame.fluid is None else frame.fluid["id"]
    return surface(frame.positions, frame.velocities, spec, numbers=numbers, solids=solids, threads=threads)


def _surface_spec(scene: Scene) -> ReconstructSpec:
    return ReconstructSpec.model_validate_json(Plan(scene, HOME).job("reconstruct").spec)


def _attributes(scene: Scene, frame: Frame, surface: Surface) -> dict[str, np.ndarray]:
    """What the scene lets the vertices of a surface say of the fluid."""
    from workflow.stages.surface.attributes import sampled
    from workflow.stages.surface.known import Known

    if frame.fluid is None:
        return {}
    spec = _surface_spec(scene)
    of_particles = Known.of(spec, frame.folder)
    known = of_particles.columns(frame.fluid, frame.number)
    moving = surface.vertices, frame.positions, frame.velocities
    return sampled(of_particles.names, *moving, known, 2 * spec.particle_radius)


def render(scene: Scene, frame: Frame, out: Path | str, surface: Surface | None = None) -> Path:
    """Draw a frame into `out`, a PNG, and return its path. The surface is made where it is not given; foam is not
    drawn, nor what is wet. Raises RenderFailed."""
    spec = Plan(scene, HOME).job("render").spec
    with TemporaryDirectory(prefix="tidemill-") as name:
        words = ["--spec", "-", "--simulation", str(frame.folder), "--frames", f"{frame.number}:{frame.number}"]
        if scene.simulation.fluid is not None:
            found = reconstruct(scene, frame) if surface is None else surface
            path = Path(name, f"surface_{frame.number:05d}.ply")
            write_surface(path, **vars(found), attributes=_attributes(scene, frame, found))
            words += ["--surface", name]
        command = [sys.executable, "-m", "render", *words, "--out", f"{name}/picture"]
        command += ["--fps", f"{scene.simulation.fps:.17g}"]
        found_by = {**os.environ, **environment()}
        done = subprocess.run(command, input=spec, env=found_by, capture_output=True, text=True, check=False)
        if done.returncode:
            raise RenderFailed(done.stderr.strip())
        Path(out).parent.mkdir(parents=True, exist_ok=True)
        return Path(shutil.copyfile(Path(name, "picture", f"{frame.number:05d}.png"), out))
