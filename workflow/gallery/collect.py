"""From a finished film to the files of the gallery."""

from __future__ import annotations

import json
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from common.files import write_json, write_whole
from common.manifest import Manifest
from scene.load import CHANGED, load
from scene.presets import Quality
from workflow.gallery.shots import FOLDER, Shot
from workflow.plan.jobs import Job, Plan
from workflow.plan.shelf import SCENE_FILES

LARGE = {"resolution": [960, 540], "samples": 24}
"""Of the large picture, which is rendered anew: at least as many pixels, as many samples."""
LOOP_WIDTH = 480
LOOP_QUALITY = 55
STILL_QUALITY = 90
COUNTS = {"particles": "particles", "boundary_samples": "samples", "steps": "steps"}


class NotMade(Exception):
    """A film that is not there, or not as its scene now says."""


def collect(shot: Shot, root: Path) -> None:
    """Write NAME.mp4, NAME.webp, NAME.jpg and NAME.json; raises NotMade and SceneError."""
    plan = _plan(shot.scene, shot.quality, shot.set, root)
    film = plan.job("film")
    command = f"snakemake --cores 2 {film.folder}{_config(shot)}"
    _require(film, command)
    made, name = Path(film.folder), Path(film.folder).name
    summary = json.loads((made / "summary.json").read_text())
    pictures = sorted((made / "frames").glob("*.png"))
    if shot.frame >= len(pictures):
        raise NotMade(f"{made} has no frame {shot.frame}, only 0 to {len(pictures) - 1}")
    folder = root / FOLDER
    still = _still(
        _plan(shot.scene, shot.picture, (), root) if shot.picture else plan, shot.frame, folder / f"{name}.jpg"
    )
    shutil.copyfile(made / f"{name}.mp4", folder / f"{name}.mp4")
    _loop(pictures, folder / f"{name}.webp", summary["playback_fps"])
    write_json(folder / f"{name}.json", {**_record(summary, command), "picture": still})


def _plan(name: str, quality: Quality | None, settings: Sequence[str], root: Path) -> Plan:
    scene = load(SCENE_FILES.find(name), quality=quality, overrides=settings)
    return Plan(replace(scene, quality=CHANGED) if settings else scene, root)


def _config(shot: Shot) -> str:
    given = [f"quality={shot.quality}"] if shot.quality else []
    given += [f"set={shlex.quote(json.dumps(shot.set))}"] if shot.set else []
    return f" --config {' '.join(given)}" if given else ""


def _require(job: Job, command: str) -> None:
    manifest = Manifest.read(Path(job.folder))
    if manifest is None or manifest.plan != job.plan:
        raise NotMade(f"{job.folder} is not there, or not as the scene now says: run {command}")


def _record(summary: dict[str, Any], command: str) -> dict[str, Any]:
    return {
        "command": command,
        "quality": summary["quality"],
        "frames": summary["frames"],
        "fps": summary["fps"],
        "size": summary["size"],
        **_counts(summary),
        "wall_s": {stage: round(phases["total"], 1) for stage, phases in summary["wall_s"].items() if stage != "total"},
        "versions": summary["versions"],
    }


def _counts(summary: dict[str, Any]) -> dict[str, int]:
    counts = summary["counts"]
    return {name: counts[key] for key, name in COUNTS.items() if counts.get(key)}


def _loop(pictures: Sequence[Path], out: Path, fps: float) -> None:
    """The film as a small animated picture, which pages show without a player."""
    from PIL import Image

    frames = []
    for path in pictures:
        with Image.open(path) as picture:
            height = round(LOOP_WIDTH * picture.height / picture.width)
            frames.append(picture.convert("RGB").resize((LOOP_WIDTH, height), Image.Resampling.LANCZOS))
    first, *others = frames
    settings = {"duration": round(1000 / fps), "loop": 0, "quality": LOOP_QUALITY, "method": 6}
    write_whole(out, lambda partial: first.save(partial, "WEBP", save_all=True, append_images=others, **settings))


READ = {"--simulation": "simulate", "--surface": "reconstruct", "--foam": "foam", "--wet": "wet"}
"""Stages whose results pictures show, by the options of the render stage."""


def _still(plan: Plan, frame: int, out: Path) -> dict[str, Any]:
    """One frame, rendered larger from the files of a film; returns the record of it."""
    from PIL import Image

    index = next(k for k, job in enumerate(plan.jobs("simulate")) if job.frames.first <= frame <= job.frames.last)
    own = json.loads(plan.job("render").spec)
    large = {**LARGE, "resolution": max(own["resolution"], LARGE["resolution"])}
    settings = json.dumps({**own, **large})
    words = ["--spec", "-", "--frames", f"{frame}:{frame}", "--fps", repr(plan.timeline.fps)]
    for option, stage in READ.items():
        if plan.parts(stage):
            job = plan.job(stage, index)
            _require(job, f"snakemake --cores 2 {job.folder}")
            words += [option, job.folder]
    with tempfile.TemporaryDirectory() as scratch:
        done = subprocess.run([sys.executable, "-m", "render", *words, "--out", scratch], input=settings, text=True)
        if done.returncode:
            raise NotMade(f"frame {frame} of {plan.scene.name} cannot be rendered")
        with Image.open(Path(scratch, f"{frame:05d}.png")) as picture:
            whole = picture.convert("RGB")
    write_whole(out, lambda partial: whole.save(partial, "JPEG", quality=STILL_QUALITY))
    summary = json.loads(Path(plan.job("simulate", index).folder, "summary.json").read_text())
    return {"quality": plan.scene.quality, "render": large, **_counts(summary)}
