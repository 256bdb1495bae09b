"""docs/gallery.md, from docs/gallery."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from workflow.gallery.shots import FOLDER, Shot, Shots

STAGES = {"simulate": "simulation", "reconstruct": "surface", "foam": "foam", "wet": "wetness", "render": "pictures"}


def page(shots: Shots, root: Path) -> str:
    """The page in Markdown; shots without a film yet are named at its end."""
    made = [shot for shot in shots.shots if (root / FOLDER / f"{_file(shot)}.json").exists()]
    parts = ["# Gallery", shots.intro.strip(), *(_entry(shot, _record(shot, root)) for shot in made)]
    missing = [f"[{shot.scene}](../scenes/{shot.scene}.yaml)" for shot in shots.shots if shot not in made]
    if missing:
        parts.append(f"Not shown here yet: {', '.join(missing)}.")
    return "\n\n".join(parts) + "\n"


def _entry(shot: Shot, record: dict[str, Any]) -> str:
    name = _file(shot)
    return "\n\n".join(
        [
            f"## {shot.title}",
            shot.says.strip(),
            f"![{shot.seen}](gallery/{name}.jpg)",
            f"[![The film](gallery/{name}.webp)](gallery/{name}.mp4)",
            f"[`scenes/{shot.scene}.yaml`](../scenes/{shot.scene}.yaml) · [film](gallery/{name}.mp4) · "
            f"`{record['command']}`",
            _figures(record),
        ]
    )


def _figures(record: dict[str, Any]) -> str:
    width, height = record["size"]
    cells = {"frames": f"{record['frames']} of {width} x {height}, {record['fps']:g} a second"}
    names = {"particles": "fluid particles", "samples": "samples on solids", "steps": "steps"}
    cells |= {name: f"{record[key]:,}" for key, name in names.items() if key in record}
    cells |= {name: _duration(record["wall_s"][stage]) for stage, name in STAGES.items() if stage in record["wall_s"]}
    picture = record["picture"]
    if picture["quality"] != record["quality"]:
        particles = f", {picture['particles']:,} particles" if "particles" in picture else ""
        cells["large picture"] = picture["quality"] + particles
    lines = (cells.keys(), ("---" for _ in cells), cells.values())
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _duration(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min"


def _record(shot: Shot, root: Path) -> dict[str, Any]:
    return json.loads((root / FOLDER / f"{_file(shot)}.json").read_text())


def _file(shot: Shot) -> str:
    return shot.scene.rpartition("/")[2]
