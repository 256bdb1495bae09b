"""Where the files that a scene names lie, and what is in them.

A scene may come from a stranger. It reads what lies in its own folder or below, in a folder `scenes` that this is in,
in Tidemill's own, in installed packages, and in folders that the user allows: nothing else, wherever links lead. Every
file that a scene or a study names is looked up here.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import re
from collections.abc import Iterable
from pathlib import Path

from common.distribution import HOME
from scene.diagnostics.suggestions import similar
from scene.settings import Refused

IN_PACKAGE = re.compile(r"(?P<package>[A-Za-z_]\w+):(?P<path>.+)", re.DOTALL)
"""How a file of a package is named; in two characters at least, so that the drive letter of a Windows path is none."""

ALLOWED = "TIDEMILL_ALLOW"
"""Of the environment: the folders that the user allows, parted as those of PATH, so that jobs find them."""


def allow(folders: Iterable[str]) -> None:
    """Let scenes read below these folders, too, also in processes that are started from here.

    Raises `Refused` for what is no folder.
    """
    wanted = [os.path.abspath(os.path.expanduser(folder)) for folder in folders]
    for folder in wanted:
        if not os.path.isdir(folder) or os.pathsep in folder:
            why = "there is no such folder" if os.pathsep not in folder else f"its name holds {os.pathsep!r}"
            raise Refused(f"{folder} cannot be allowed: {why}", remedy="Name a folder with the files of scenes")
    if wanted:
        os.environ[ALLOWED] = os.pathsep.join([*filter(None, [os.environ.get(ALLOWED)]), *wanted])


def resolve(file: str, folder: Path) -> Path:
    """The absolute path of an asset, links resolved.

    `file` is a path relative to `folder` (the scene's own), an absolute one, one that starts with `~`,
    or `PACKAGE:PATH`, a file inside an installed Python package, which is located without importing it.

    Raises `Refused` when there is no such readable file, and for one that lies where scenes may not read.
    """
    if match := IN_PACKAGE.fullmatch(file):
        root = _package_folder(match["package"], file)
        inside = match["path"]
        path = (root / inside).resolve()
        if not path.is_relative_to(root.resolve()):
            raise Refused(f"asset {file!r} leads out of the package {match['package']!r}", remedy=_HOW_TO_NAME)
    else:
        inside = file
        path = within_reach(file, folder)
    if path.is_dir():
        raise Refused(f"asset {file!r} is a folder ({path})", remedy="Name a file in it" + _examples(path))
    if not path.is_file():
        raise Refused(f"asset {file!r} does not exist; looked for {path}", remedy=_suggestion(path, inside))
    if not os.access(path, os.R_OK):
        raise Refused(f"asset {file!r} cannot be read ({path})", remedy="Give this user permission to read it")
    return path


def digest(path: Path) -> str:
    """SHA-256 of the file's content, as 64 hexadecimal digits."""
    with open(path, "rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


_HOW_TO_NAME = "Give a path relative to the scene file, or PACKAGE:PATH for a file of an installed package"
SHELF = "scenes"
"""Scenes that share a folder of this name, in it or further below, share their files."""
_OWN = HOME / SHELF
"""The folder of the scenes that Tidemill brings."""


def within_reach(file: str, folder: Path) -> Path:
    """The absolute path, links resolved, of what a file in `folder` names, there or not; raises `Refused` for one that
    lies where scenes may not read."""
    try:
        own = Path(folder).absolute()
        path = (own / Path(file).expanduser()).resolve()
    except (RuntimeError, ValueError, OSError) as error:
        raise Refused(f"asset {file!r} is not a path: {error}", remedy=_HOW_TO_NAME) from error
    shelf = next((above for above in (own, *own.parents) if above.name == SHELF), own).resolve()
    allowed = [Path(item).resolve() for item in os.environ.get(ALLOWED, "").split(os.pathsep) if item]
    if any(path.is_relative_to(place) for place in (own.resolve(), shelf, _OWN.resolve(), *allowed)):
        return path
    there = path.parent
    raise Refused(
        f"asset {file!r} leads to {path}, and the scene may read in {shelf} alone",
        remedy=f"Copy it there; or, if the scene can be trusted with {there}, allow that: --allow {there} with "
        f"python -m sim, --config allow={there} with snakemake, {ALLOWED}={there} with other commands",
    )


def _package_folder(package: str, file: str) -> Path:
    try:
        spec = importlib.util.find_spec(package)
    except ValueError:  # of __main__
        spec = None
    if spec is None:
        raise Refused(f"asset {file!r}: the Python package {package!r} is not installed", remedy=_HOW_TO_NAME)
    # A folder without __init__.py, which may be any beside the program that runs, is no package that was installed.
    for folder in spec.submodule_search_locations or () if spec.has_location else ():
        return Path(folder)
    raise Refused(f"asset {file!r}: {package!r} is a single module and brings no files", remedy=_HOW_TO_NAME)


def _suggestion(path: Path, inside: str) -> str:
    """Names that exist and look like the missing one, in the nearest folder that exists."""
    folder = path.parent
    wanted = path.name
    while not folder.is_dir() and folder != folder.parent:
        wanted = folder.name
        folder = folder.parent
    close = sorted(similar(wanted, _names(folder), most=3))
    if not close:
        return _HOW_TO_NAME + _examples(folder)
    written = Path(inside)
    depth = len(path.parts) - len(folder.parts)
    prefix = Path(*written.parts[:-depth]) if depth < len(written.parts) else Path()
    return "Did you mean " + " or ".join(str(prefix / name) for name in close) + "?"


def _examples(folder: Path) -> str:
    names = _names(folder)
    if not names:
        return ""
    return f"; {folder} holds {', '.join(names[:5])}" + (", ..." if len(names) > 5 else "")


def _names(folder: Path) -> list[str]:
    try:
        return sorted(entry.name for entry in folder.iterdir() if not entry.name.startswith((".", "__")))
    except OSError:
        return []
