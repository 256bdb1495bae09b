"""What was made of a scene for other programs: an animation, or what a format of an installed package writes.

    python -m workflow.export bunny --out bunny.usdc
    python -m workflow.export bunny --out bunny.abc --frames 0:24
    python -m workflow.export bunny --out bunny.glb --frames 48:48
    python -m workflow.export bunny --out bunny.blend --blender /usr/bin/blender
    python -m workflow.export bunny --out water.usdc --spec '{"surface": false, "particles": true}' --simulation out
    python -m workflow.export bunny --out bunny.vdb --spec '{"voxel": "2 cm"}'
    python -m workflow.export bunny --out bunny.csv --spec '{"columns": ["x", "y"]}'

It reads what the stages left in results/, so that nothing is made anew for it; or what `python -m sim run` left. The
last of these examples is for a package that adds the format csv.

In USD, Alembic, glTF and .blend, bodies and the camera are keyframes; water and cloth, whose triangles change, are
sequences of meshes: sampled in USD and Alembic, one object a frame in glTF and in a .blend, which therefore needs no
files and no scripts. Foam is points with widths, and so are the fluid's particles, of which --spec may ask:

    surface     the surface of the water (default true); without it, a run without its film will do
    particles   the particles of the fluid (default false)

OpenVDB has one file a frame, bunny_00042.vdb, with the grids density, velocity, age, a share for each source, and foam;
of it --spec may ask:

    voxel       edge of a cell [m] (default: the spacing of the particles)

Lengths are metres, and y is up, but in a .blend. Only a .blend has all of the materials, lights and surroundings; in
USD and glTF, water is a clear material with its index of refraction, and Alembic has no materials. Older Blenders open
no .blend of newer ones: --blender names the one that writes it.

exit codes: 0 done, 1 failed, 2 refused (the scene, settings or files cannot be used as they are)
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from common import manifest
from common.arguments import frame_range
from common.command import as_called, end_with
from common.distribution import HOME
from common.frames import Frames
from common.registry import load as implementation
from common.simulation_files import SOURCES
from render import program
from scene.diagnostics.suggestions import suggestion
from scene.document import SceneError
from scene.load import Scene, load
from scene.presets import QUALITIES
from scene.settings import Refused
from scene.spec_option import HELP, read_spec
from workflow.formats import formats
from workflow.formats.format import FormatSettings, Made
from workflow.plan.jobs import Plan
from workflow.plan.shelf import SCENE_FILES
from workflow.stages.film import tables
from workflow.stages.stage import FAILED, REFUSED, refuse_spoiled

COMMAND = "python -m workflow.export"
STAGES = ("simulate", "reconstruct", "foam")
"""Whose files formats read."""


def gather(parts: Sequence[Path], folder: Path) -> Path:
    """One folder with the files of all parts of a stage, as links, and with their tables as one; without a manifest,
    which would be that of one part."""
    folder.mkdir()
    for part in parts:
        for file in part.iterdir():
            link = folder / file.name
            if file.name not in (*tables.TABLES, manifest.NAME) and not link.exists():
                link.symlink_to(file.resolve())
    for name in tables.TABLES:
        tables.concatenate([part / name for part in parts], folder / name)
    if (parts[-1] / SOURCES).exists():
        # The last part has what all others have, too.
        (folder / SOURCES).unlink()
        (folder / SOURCES).symlink_to((parts[-1] / SOURCES).resolve())
    return folder


def export(scene: Scene, out: Path, settings: FormatSettings, asked: Frames, simulation: Path | None = None) -> int:
    """Write `out`; `simulation` is the folder of a run that is no film's. Returns the exit status; raises Refused."""
    parts = _parts(scene) if simulation is None else {"simulate": [simulation]}
    needs_surface = settings.needs_surface()
    needed = [*parts["simulate"], *(parts.get("reconstruct", []) if needs_surface else [])]
    missing = next((folder for folder in needed if not folder.is_dir()), None)
    if missing or (needs_surface and simulation and scene.simulation.fluid is not None):
        raise Refused(f"{missing or 'the surface of the water'} is missing", remedy=_remedy(settings, missing))
    there = {stage: folders for stage, folders in parts.items() if folders and all(map(Path.is_dir, folders))}
    refuse_spoiled([folder for folders in there.values() for folder in folders], "", frames=asked)
    with tempfile.TemporaryDirectory(prefix="export-") as scratch:
        gathered = {stage: gather(folders, Path(scratch) / stage) for stage, folders in there.items()}
        made = Made(scene, asked, gathered["simulate"], gathered.get("reconstruct"), gathered.get("foam"))
        return implementation(settings.IMPLEMENTATION)(settings, made, out) or 0


def _remedy(settings: FormatSettings, missing: Path | None) -> str:
    """What to do where something is missing; one that needs no surface may do without it."""
    can_do_without = missing is None and "surface" in type(settings).model_fields
    also = """, or give --spec '{"surface": false, "particles": true}'""" if can_do_without else ""
    return f"make the film first{also}"


def _parts(scene: Scene) -> dict[str, list[Path]]:
    """Folders of each stage of a film that a format may read, there or not."""
    plan = Plan(scene, HOME)
    return {stage: [Path(job.folder) for job in plan.jobs(stage)] for stage in STAGES}


def _settings(out: Path, given: str) -> FormatSettings:
    """Those of the format that the name of a file asks for; raises Refused."""
    known, name = formats(), out.suffix.removeprefix(".")
    if name not in known:
        raise Refused(f"--out {out}: no format '{name}'", remedy=suggestion(name, known))
    return read_spec(known[name], given)


def main(arguments: list[str] | None = None, called: str = COMMAND) -> int:
    parser = argparse.ArgumentParser(
        prog=called,
        description=as_called(__doc__, called),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("scene", help="name of a scene, such as bunny, or its file")
    parser.add_argument("--out", required=True, type=Path, metavar="FILE", help=f"{', '.join(formats())}: by its end")
    parser.add_argument("--spec", default="{}", metavar="JSON", help=f"of the format: {HELP}")
    parser.add_argument("--quality", choices=QUALITIES, help="of the film (default: the scene's)")
    parser.add_argument(
        "--frames", type=frame_range, metavar="A:B", help="first and last, both included (default: all)"
    )
    parser.add_argument("--simulation", type=Path, metavar="DIR", help="a run's folder in place of the film's")
    parser.add_argument("--blender", metavar="PATH", help="an installed Blender that writes the file")
    options = parser.parse_args(arguments)
    try:
        settings = _settings(options.out, options.spec)
        scene = load(SCENE_FILES.locate(options.scene), quality=options.quality)
        if options.blender is not None:
            program.choose(options.blender)
        asked = options.frames or Frames(0, scene.last_frame)
        status = export(scene, options.out, settings, asked, options.simulation)
    except (SceneError, Refused) as error:
        print(f"export: {error}", file=sys.stderr)
        return REFUSED
    except OSError as error:
        print(f"export: {error.filename or options.out}: {error.strerror or error}", file=sys.stderr)
        return FAILED
    if status == 0:
        print(options.out if options.out.exists() else options.out.with_stem(f"{options.out.stem}_*"))
    return status


if __name__ == "__main__":
    end_with(main, goes_on=True)
