"""Animations by Blender: USD, Alembic, glTF and .blend."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from scene.settings import Refused
from workflow.formats.format import Made
from workflow.formats.spec import Animation
from workflow.plan.jobs import render_spec


def write(settings: Animation, made: Made, out: Path) -> int:
    """Let the render stage write it; returns the exit status. Raises Refused for particles of a scene without any."""
    scene, fluid = made.scene, made.scene.simulation.fluid
    if settings.particles and fluid is None:
        raise Refused("--spec: particles: the scene has no fluid", remedy="leave it out")
    if scene.foam is not None and made.foam is None:
        print("export: warning: there is no foam yet, so none is written: make the film first", file=sys.stderr)
    with tempfile.TemporaryDirectory(prefix="export-") as scratch:
        command = [sys.executable, "-m", "render", "--spec", "-"]
        command += ["--frames", str(made.frames), "--fps", repr(scene.simulation.fps)]
        command += ["--simulation", str(made.simulation)]
        command += ["--surface", str(made.surface)] if made.surface and settings.surface else []
        command += ["--foam", str(made.foam)] if made.foam else []
        command += ["--particles", repr(fluid.particle_radius)] if settings.particles and fluid else []
        command += ["--out", scratch, "--export", str(out)]
        return subprocess.run(command, input=render_spec(scene), text=True, check=False).returncode
