"""The animation of a film for other programs: USD, Alembic, or a .blend that holds all it needs.

    python -m workflow.export bunny --out bunny.usdc
    python -m workflow.export bunny --out bunny.abc --frames 0:24
    python -m workflow.export bunny --out bunny.blend --blender /usr/bin/blender

It reads what the stages left in results/. Bodies and the camera are keyframes; water and cloth, whose triangles change,
are sequences of meshes: sampled in USD and Alembic, one object a frame in a .blend, which therefore needs no files and
no scripts. Older Blenders open no .blend of newer ones: --blender names the one that writes it.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from common.command import end_with
from render.__main__ import main as render
from scene.document import SceneError
from scene.load import load
from scene.presets import QUALITIES
from scene.settings import Refused
from workflow.plan.jobs import Plan
from workflow.plan.shelf import SCENE_FILES
from workflow.stages.film import tables
from workflow.stages.stage import frames


def gather(parts: list[Path], folder: Path) -> Path:
    """One folder with the files of all parts of a stage, as links, and with their tables as one."""
    folder.mkdir()
    for part in parts:
        for file in part.iterdir():
            link = folder / file.name
            if file.name not in tables.TABLES and not link.exists():
                link.symlink_to(file.resolve())
    for name in tables.TABLES:
        tables.concatenate([part / name for part in parts], folder / name)
    return folder


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m workflow.export", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scene", help="name of a scene, as bunny")
    parser.add_argument("--out", required=True, metavar="FILE", help="bunny.usdc, bunny.usda, bunny.abc or bunny.blend")
    parser.add_argument("--quality", choices=QUALITIES, help="of the film (default: the scene's)")
    parser.add_argument("--frames", type=frames, metavar="A:B", help="first and last, both included (default: all)")
    parser.add_argument("--blender", metavar="PATH", help="an installed Blender that writes the file")
    options = parser.parse_args(arguments)
    try:
        scene = load(SCENE_FILES.find(options.scene), quality=options.quality)
    except (SceneError, Refused) as error:
        print(f"export: {error}", file=sys.stderr)
        return 2
    plan = Plan(scene, Path(__file__).parents[1])
    simulated, meshed = ([Path(job.folder) for job in plan.jobs(stage)] for stage in ("simulate", "reconstruct"))
    missing = [folder for folder in (*simulated, *meshed) if not folder.is_dir()]
    if missing:
        print(f"export: {missing[0]} is missing: make the film first", file=sys.stderr)
        return 2
    asked = options.frames or f"0:{scene.last_frame}"
    settings = scene.render if options.blender is None else scene.render.model_copy(update={"blender": options.blender})
    with tempfile.TemporaryDirectory(prefix="export-") as name:
        scratch = Path(name)
        command = ["--spec", settings.model_dump_json(exclude_none=True), "--frames", str(asked)]
        command += ["--simulation", str(gather(simulated, scratch / "simulation"))]
        command += ["--surface", str(gather(meshed, scratch / "surface"))] if meshed else []
        command += ["--fps", repr(scene.simulation.fps), "--out", str(scratch / "out"), "--export", options.out]
        code = render(command)
    if code == 0:
        print(options.out)
    return code


if __name__ == "__main__":
    end_with(main, goes_on=True)
