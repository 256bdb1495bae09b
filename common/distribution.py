"""Where this software lies: in its checkout, or installed."""

from __future__ import annotations

import os
from pathlib import Path

HOME = Path(__file__).resolve().parents[1]
"""The folder of the packages, with the rules in `workflow`, and of the scenes and profiles that come with them."""


def environment() -> dict[str, str]:
    """Variables with which a process finds the packages, wherever it runs, and nothing in their place: a folder of
    one's own may hold a `scene.py`."""
    before = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    others = [entry for entry in before if entry and entry != str(HOME)]
    return {"PYTHONPATH": os.pathsep.join([str(HOME), *others]), "PYTHONSAFEPATH": "1"}


def reach_from_jobs() -> None:
    """Let all processes that this one starts find the packages."""
    os.environ.update(environment())
