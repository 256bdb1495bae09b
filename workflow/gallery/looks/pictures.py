"""A picture of a look, by the commands of the stages."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import yaml
from PIL import Image

from common.distribution import HOME
from common.files import write_whole
from scene.load import load
from workflow.gallery.looks.exhibits import Exhibit, Exhibits
from workflow.plan.jobs import Plan

PICTURE = {"resolution": [240, 240], "samples": 64, "motion_blur": False}
MODELS = Path("docs/gallery/models")
"""Mesh files that stands name."""
QUALITY = 85
MOST_BYTES = 15_000


class NotMade(Exception):
    """A picture that cannot be made."""


def picture(exhibit: Exhibit, shown: Exhibits, path: Path, folder: Path) -> None:
    """Write a JPEG, by way of files in a folder; raises NotMade and SceneError."""
    scene = folder / "scene.yaml"
    shutil.copytree(HOME / MODELS, folder, dirs_exist_ok=True)
    stand = shown.stands[exhibit.on]
    render = {**PICTURE, **stand.get("render", {}), **yaml.safe_load(exhibit.lines)}
    scene.write_text(yaml.safe_dump({**stand, "render": render}, sort_keys=False))
    plan = Plan(load(scene), HOME)
    last = plan.scene.last_frame
    simulation, surface, frames = (folder / name for name in ("simulation", "surface", "frames"))
    _run("sim", "run", scene, "--out", simulation)
    there = ["--simulation", simulation, "--frames", f"{last}:{last}"]
    if plan.has_surface:
        _run("workflow.reconstruct", "--spec", plan.job("reconstruct", 0).spec, *there, "--out", surface)
        there += ["--surface", surface]
    _run("render", "--spec", plan.job("render", 0).spec, *there, "--out", frames)
    with Image.open(frames / f"{last:05d}.png") as made:
        write_whole(path, lambda part: made.convert("RGB").save(part, "JPEG", quality=QUALITY, optimize=True))
    if path.stat().st_size > MOST_BYTES:
        raise NotMade(f"{path} has {path.stat().st_size} bytes, more than {MOST_BYTES}: choose a plainer view")


def _run(module: str, *arguments: object) -> None:
    done = subprocess.run([sys.executable, "-m", module, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        raise NotMade(f"python -m {module} failed:\n{done.stderr}")
