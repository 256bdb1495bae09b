"""Where this software lies: in its checkout, or installed."""

from __future__ import annotations

import os
from pathlib import Path

HOME = Path(__file__).resolve().parents[1]
"""The folder of the packages, with the rules in `workflow`, and of the scenes and profiles that come with them."""


def reach_from_jobs() -> None:
    """Let the processes that this one starts find the packages, wherever they run, and nothing in their place: a
    folder of one's own may hold a `scene.py`."""
    before = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    others = [entry for entry in before if entry and entry != str(HOME)]
    os.environ["PYTHONPATH"] = os.pathsep.join([str(HOME), *others])
    os.environ["PYTHONSAFEPATH"] = "1"
