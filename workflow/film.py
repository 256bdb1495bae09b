"""Frames become what people look at: a film, a contact sheet, tables, plots and a summary.

example: the film of two blocks of frames
  python -m workflow.film --spec '{"name": "splash", "fps": 24, "last_frame": 8}' \\
      --frames-from run/frames/000 run/frames/001 --simulation run/simulation --out renders/splash

It writes splash.mp4, the formats that film.also asks for, frames/00000.png ..., contact.png and
summary.json; with --simulation also steps.csv, bodies.csv, probes.csv and plots.png. --spec takes
JSON, the name of a file with it, or - for standard input.

exit codes: 0 done, 1 failed, 2 refused (settings or files cannot be used as they are)
"""

from __future__ import annotations

import argparse
import shutil
import struct
from collections.abc import Sequence
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

from common.command import end_with
from common.files import write_json, write_whole
from common.stopwatch import Stopwatch
from scene.settings import Refused
from scene.spec_option import HELP, read_spec
from scene.units import as_ratio
from workflow.stages.film.spec import FilmJobSpec
from workflow.stages.stage import exit_code, refuse_spoiled


def run(
    spec: FilmJobSpec,
    blocks: Sequence[Path],
    out: Path,
    *,
    simulation: Sequence[Path] = (),
    surface: Sequence[Path] = (),
    foam: Sequence[Path] = (),
    wet: Sequence[Path] = (),
) -> None:
    """Write the folder of a film; raises Refused where a frame is missing or a picture cannot be used."""
    watch = Stopwatch()
    film = spec.film
    if spec.transparent:
        film.refuse_opaque()
    title = spec.name.rpartition("/")[2]
    with watch.phase("import"):
        from workflow.stages.film import plots, summaries, tables
        from workflow.stages.film.codecs import CODECS
        from workflow.stages.film.contact_sheet import contact_sheet
        from workflow.stages.film.encode import EncoderFailed, encode
    with watch.phase("check"):
        refuse_spoiled(blocks, "", frames=range(spec.last_frame + 1))
        refuse_spoiled(simulation, *tables.TABLES, "summary.json")
        refuse_spoiled([*surface, *foam, *wet], "summary.json")
    rendered = _frames(blocks, spec.last_frame)
    size = _common_size(rendered)
    with watch.phase("copy"):
        pictures = _copies(rendered, out / "frames")
    playback = film.playback_fps or spec.fps
    videos = {name: out / f"{title}{CODECS[name].suffix}" for name in ("h264", *film.also)}
    video = videos["h264"]
    with watch.phase("encode"):
        for name, path in videos.items():
            codec = CODECS[name].transparent() if spec.transparent else CODECS[name]
            make = partial(encode, out / "frames", fps=playback, crf=film.crf, codec=codec)
            try:
                write_whole(path, make)
            except EncoderFailed as error:
                raise Refused(f"the film cannot be encoded as {name}: {error}") from None
    with watch.phase("contact_sheet"):
        sheet = contact_sheet(pictures, fps=spec.fps, title=title, spec=film.contact_sheet)
        write_whole(out / "contact.png", lambda path: sheet.save(path, format="PNG"))
    with watch.phase("tables"):
        for name in tables.TABLES:
            tables.concatenate([folder / name for folder in simulation], out / name)
    steps = out / "steps.csv"
    with watch.phase("plots"):
        if steps.exists():
            frames, volumes = summaries.volumes(surface)
            curve = ([frame / spec.fps for frame in frames], volumes)
            write_whole(out / "plots.png", lambda path: plots.plot(steps, path, title=title, volume=curve))
    with watch.phase("copy"):
        copy = film.copy_path(Path.cwd())
        if copy is not None:
            copy.parent.mkdir(parents=True, exist_ok=True)
            write_whole(copy, lambda path: shutil.copyfile(video, path))
    stages = {"simulate": simulation, "reconstruct": surface, "foam": foam, "wet": wet, "render": blocks}
    summary = summaries.merged(stages, steps if steps.exists() else None)
    summary["versions"]["imageio-ffmpeg"] = version("imageio-ffmpeg")
    summary["wall_s"]["film"] = watch.report()
    summary["wall_s"]["total"] = round(sum(phases.get("total", 0.0) for phases in summary["wall_s"].values()), 3)
    about = {
        "name": spec.name,
        "quality": spec.quality,
        "frames": len(pictures),
        "fps": spec.fps,
        "playback_fps": playback,
        "playback_ratio": str(as_ratio(playback) or playback),
        "size": size,
        "film_bytes": video.stat().st_size,
    }
    write_json(out / "summary.json", {"status": summary.pop("status"), **about, **summary})
    print(f"film of {len(pictures)} frames, {size[0]} x {size[1]}, {video.stat().st_size / 1e6:.2f} MB")


def _frames(blocks: Sequence[Path], last_frame: int) -> list[Path]:
    """The pictures of the frames 0 to `last_frame`, in order."""
    found = {path.name: path for block in blocks for path in block.glob("*.png")}
    names = [f"{frame:05d}.png" for frame in range(last_frame + 1)]
    missing = [name for name in names if name not in found]
    if missing:
        where = ", ".join(map(str, blocks)) or "no folder at all"
        raise Refused(
            f"{len(missing)} of {len(names)} frames are missing, first {missing[0]}, in {where}",
            remedy="render them first",
        )
    return [found[name] for name in names]


def _copies(pictures: Sequence[Path], target: Path) -> list[Path]:
    """Copies of pictures in one folder, and of their passes beside them."""
    target.mkdir(parents=True, exist_ok=True)
    for passes in (path.with_suffix(".exr") for path in pictures):
        if passes.exists():
            shutil.copyfile(passes, target / passes.name)
    return [Path(shutil.copyfile(path, target / path.name)) for path in pictures]


def _common_size(pictures: Sequence[Path]) -> list[int]:
    """Width and height [px], the same in all pictures."""
    from PIL import Image, UnidentifiedImageError

    sizes: dict[tuple[int, int], Path] = {}
    for path in pictures:
        try:
            with Image.open(path) as picture:
                sizes.setdefault(picture.size, path)
                picture.verify()
        except (UnidentifiedImageError, OSError, SyntaxError, ValueError, struct.error) as error:
            raise Refused(
                f"{path} is not a picture, or a broken one: {error}", remedy="delete it, and render its frames again"
            ) from None
    if len(sizes) > 1:
        listed = ", ".join(f"{path.name} has {width} x {height}" for (width, height), path in sizes.items())
        raise Refused(f"the frames differ in size: {listed}", remedy="render them all with the same resolution")
    return list(next(iter(sizes)))


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m workflow.film", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--spec", required=True, metavar="JSON", help=HELP)
    folders: dict[str, Any] = {"type": Path, "nargs": "*", "metavar": "DIR", "default": []}
    parser.add_argument("--frames-from", **{**folders, "nargs": "+"}, required=True, help="folders with 00000.png ...")
    parser.add_argument("--simulation", **folders, help="folders of the simulation, in order: tables and figures")
    parser.add_argument("--surface", **folders, help="folders of the surface, in order: volume and times")
    parser.add_argument("--foam", **folders, help="folders of the foam, in order: times")
    parser.add_argument("--wet", **folders, help="folders of what is wet, in order: times")
    parser.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder for the film")
    given = parser.parse_args(argv)

    def work() -> None:
        spec = read_spec(FilmJobSpec, given.spec)
        given.out.mkdir(parents=True, exist_ok=True)
        run(
            spec,
            given.frames_from,
            given.out,
            simulation=given.simulation,
            surface=given.surface,
            foam=given.foam,
            wet=given.wet,
        )

    return exit_code(work, "film")


if __name__ == "__main__":
    end_with(main, goes_on=True)
