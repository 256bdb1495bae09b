"""What Blender writes: animations in USD, Alembic, glTF and .blend, and volumes in OpenVDB."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from scene.settings import Refused
from workflow.formats.format import Made
from workflow.formats.spec import Animation, Volume
from workflow.plan.jobs import render_spec


def write(settings: Animation, made: Made, out: Path) -> int:
    """Let the render stage write it; returns the exit status. Raises Refused for particles of a scene without any."""
    fluid = made.scene.simulation.fluid
    if settings.particles and fluid is None:
        raise Refused("--spec: particles: the scene has no fluid", remedy="leave it out")
    more = ["--surface", str(made.surface)] if made.surface and settings.surface else []
    more += ["--particles", repr(fluid.particle_radius)] if settings.particles and fluid else []
    return _export(made, out, more)


def write_volumes(settings: Volume, made: Made, out: Path) -> int:
    """Likewise; raises Refused for a scene without fluid."""
    fluid = made.scene.simulation.fluid
    if fluid is None:
        raise Refused(f"--out {out}: the scene has no fluid", remedy="write another format")
    more = ["--particles", repr(fluid.particle_radius)]
    return _export(made, out, more + (["--voxel", repr(settings.voxel)] if settings.voxel else []))


def _export(made: Made, out: Path, more: Sequence[str]) -> int:
    scene = made.scene
    if scene.foam is not None and made.foam is None:
        print("export: warning: there is no foam yet, so none is written: make the film first", file=sys.stderr)
    with tempfile.TemporaryDirectory(prefix="export-") as scratch:
        command = [sys.executable, "-m", "render", "--spec", "-"]
        command += ["--frames", str(made.frames), "--fps", repr(scene.simulation.fps)]
        command += ["--simulation", str(made.simulation)]
        command += ["--foam", str(made.foam)] if made.foam else []
        command += ["--out", scratch, "--export", str(out), *more]
        return subprocess.run(command, input=render_spec(scene), text=True, check=False).returncode
