"""Animations by Blender: USD, Alembic and .blend."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from workflow.formats.format import Made
from workflow.formats.spec import Animation
from workflow.plan.jobs import render_spec


def write(settings: Animation, made: Made, out: Path) -> int:
    """Let the render stage write it; returns the exit status."""
    scene = made.scene
    with tempfile.TemporaryDirectory(prefix="export-") as scratch:
        command = [sys.executable, "-m", "render", "--spec", "-"]
        command += ["--frames", str(made.frames), "--fps", repr(scene.simulation.fps)]
        command += ["--simulation", str(made.simulation)]
        command += ["--surface", str(made.surface)] if made.surface else []
        command += ["--out", scratch, "--export", str(out)]
        return subprocess.run(command, input=render_spec(scene), text=True, check=False).returncode
