"""`tidemill new`: a folder for films of one's own, and scenes to start from."""

from __future__ import annotations

import argparse
import re
import shlex
import shutil
import sys
import unicodedata
from collections.abc import Iterator, Sequence
from pathlib import Path

from scene.assets import resolve
from scene.diagnostics.suggestions import suggestion
from scene.document import SceneError
from scene.load import load
from tidemill import DISTRIBUTION
from workflow.plan.shelf import SCENE_FILES

REFUSED = 2
TEMPLATE = Path(__file__).with_name("template")
FIRST = "first"
"""The scene of the template, called after its folder where that leaves a name."""
SCHEMA = SCENE_FILES.folder / "schema.json"
PROFILE = Path("profiles", "default", "config.yaml")
NOT_PLAIN = re.compile(r"[^A-Za-z0-9_-]+")
"""What a name that needs no quotes in any shell cannot hold."""


class CannotMake(Exception):
    """What was asked for would overwrite something, or is no folder; holds the remedy too."""


def main(arguments: Sequence[str], called: str) -> int:
    """Carry out `tidemill new`; the exit status."""
    parser = argparse.ArgumentParser(
        prog=called,
        description="Make a folder for films of your own, with a first scene, or copy a scene that comes with Tidemill "
        "into the folder of this name.",
        epilog="Without NAME, --from adds the scene to this folder.",
    )
    parser.add_argument("name", nargs="?", metavar="NAME", type=Path, help="the folder to make")
    parser.add_argument("--from", dest="source", metavar="SCENE", help="start from a copy, such as of bowl")
    options = parser.parse_args(arguments)
    try:
        if options.name is None and options.source is None:
            raise CannotMake("give the folder a name, or a scene to copy\n  fix: tidemill new film")
        folder = Path() if options.name is None else options.name
        if options.name is not None:
            _refuse_used(folder)
        scene = None if options.source is None else shipped(options.source)
        if options.name is not None:
            make(folder)
        name = _add_first(folder) if scene is None else add(scene, folder)
    except (SceneError, CannotMake) as error:
        print(f"tidemill new: {error}", file=sys.stderr)
        return REFUSED
    except OSError as error:
        print(f"tidemill new: {error.filename}: {error.strerror}", file=sys.stderr)
        return 1
    _tell(folder, name)
    return 0


def shipped(name: str) -> Path:
    """The file of a scene that comes with this software; raises CannotMake."""
    known = SCENE_FILES.names(DISTRIBUTION)
    if name not in known:
        raise CannotMake(f"no scene '{name}' comes with Tidemill\n  fix: {suggestion(name, known)}")
    return DISTRIBUTION / SCENE_FILES.folder / f"{name}.yaml"


def make(folder: Path) -> None:
    """A folder with rules, profile and schema, and without scenes."""
    scenes = folder / SCENE_FILES.folder
    scenes.mkdir(parents=True)
    shutil.copyfile(TEMPLATE / "Snakefile", folder / "Snakefile")
    shutil.copyfile(TEMPLATE / "gitignore", folder / ".gitignore")
    shutil.copyfile(DISTRIBUTION / SCHEMA, folder / SCHEMA)
    (folder / PROFILE).parent.mkdir(parents=True)
    shutil.copyfile(DISTRIBUTION / PROFILE, folder / PROFILE)


def add(scene: Path, folder: Path) -> str:
    """Copy a scene and the files that it names to where they are in `folder`, in which nothing may be overwritten.

    Returns the scene's name; raises CannotMake, SceneError.
    """
    shelf = DISTRIBUTION / SCENE_FILES.folder
    copies = {file: folder / SCENE_FILES.folder / file.relative_to(shelf) for file in (scene, *_beside(scene, shelf))}
    for file, copy in copies.items():
        if copy.exists() and (file == scene or copy.read_bytes() != file.read_bytes()):
            raise CannotMake(f"{copy} is there already\n  fix: rename or remove it")
    for file, copy in copies.items():
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, copy)
    return scene.relative_to(shelf).with_suffix("").as_posix()


def plain(name: str) -> str:
    """A name without accents and spaces, for scenes: "Été à deux" becomes "Ete_a_deux". Empty if nothing is left."""
    letters = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    return NOT_PLAIN.sub("_", letters).strip("_-")


def _beside(scene: Path, shelf: Path) -> Iterator[Path]:
    """Files that a scene names, without those of packages."""
    loaded = load(scene)
    for name in loaded.assets:
        path = resolve(name, loaded.folder)
        if path.is_relative_to(shelf):
            yield path


def _add_first(folder: Path) -> str:
    name = plain(folder.resolve().name) or FIRST
    shutil.copyfile(TEMPLATE / SCENE_FILES.folder / f"{FIRST}.yaml", folder / SCENE_FILES.folder / f"{name}.yaml")
    return name


def _refuse_used(folder: Path) -> None:
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise CannotMake(f"{folder} is there already\n  fix: give a name that is free, or --from alone inside it")


def _tell(folder: Path, name: str) -> None:
    scene = folder / SCENE_FILES.folder / f"{name}.yaml"
    print(f"{scene}\n    the scene: change it in any editor")
    there = "" if folder == Path() else f"cd {shlex.quote(str(folder))} && "
    for words, what in {
        f"tidemill check {name}": "validate it",
        f"tidemill live {name}": "play it in the browser",
        f"tidemill render {name} --quality draft": f"make its film, in renders/{name}/",
    }.items():
        print(f"{there}{words}\n    {what}")
