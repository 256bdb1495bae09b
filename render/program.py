"""Which Blender renders: the package bpy, or an installed program that the user names. Never a scene: it may come from
a stranger, and would start whatever it names."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

VARIABLE = "TIDEMILL_BLENDER"
"""Of the environment, so that jobs find the program that the command above them was given."""


def chosen() -> str | None:
    """The path or name of the installed Blender; None for the package bpy."""
    return os.environ.get(VARIABLE) or None


def choose(blender: str) -> None:
    """Render with this one, also in processes that are started from here."""
    os.environ[VARIABLE] = blender


def found(blender: str) -> Path:
    """Where a Blender is, links resolved, if it is there at all: a name is looked up on the PATH."""
    return Path(shutil.which(blender) or blender).resolve()
