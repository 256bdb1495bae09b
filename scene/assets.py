"""Where the files that a scene names lie, and what is in them."""

from __future__ import annotations

import hashlib
import importlib.util
import os
import re
from pathlib import Path

from scene.diagnostics.suggestions import similar
from scene.settings import Refused

# Two characters at least, so that the drive letter of a Windows path is not taken for a package.
_IN_PACKAGE = re.compile(r"(?P<package>[A-Za-z_]\w+):(?P<path>.+)", re.DOTALL)


def resolve(file: str, folder: Path) -> Path:
    """The absolute path of an asset.

    `file` is a path relative to `folder` (the scene's own), an absolute one, one that starts with `~`,
    or `PACKAGE:PATH`, a file inside an installed Python package, which is located without importing it.

    Raises `Refused` when there is no such readable file.
    """
    if match := _IN_PACKAGE.fullmatch(file):
        root = _package_folder(match["package"], file)
        inside = match["path"]
        path = (root / inside).resolve()
        if not path.is_relative_to(root.resolve()):
            raise Refused(f"asset {file!r} leads out of the package {match['package']!r}", remedy=_HOW_TO_NAME)
    else:
        root = Path(folder)
        inside = file
        try:
            path = (root / Path(file).expanduser()).resolve()
        except (RuntimeError, ValueError, OSError) as error:
            raise Refused(f"asset {file!r} is not a path: {error}", remedy=_HOW_TO_NAME) from error
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


_HOW_TO_NAME = (
    "Give a path relative to the scene file, an absolute path, or PACKAGE:PATH for a file of an installed package"
)


def _package_folder(package: str, file: str) -> Path:
    spec = importlib.util.find_spec(package)
    if spec is None:
        raise Refused(f"asset {file!r}: the Python package {package!r} is not installed", remedy=_HOW_TO_NAME)
    for folder in spec.submodule_search_locations or ():
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
