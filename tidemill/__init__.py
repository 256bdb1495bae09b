"""From a scene file to a film: the command `tidemill`, folders of one's own, the rules for their Snakefiles, and for
scripts and notebooks `load`, `simulate`, `frames`, `reconstruct` and `render` (`tidemill.interface`).

Everything else lies beside this package in a checkout, and in `distribution/` of an installed one: there it takes no
names such as `scene` or `render` from other packages of the environment. Importing this one makes it importable.
"""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path
from typing import Any

_HERE = Path(__file__).resolve().parent
DISTRIBUTION = _HERE / "distribution" if (_HERE / "distribution").is_dir() else _HERE.parent
"""The folder of the packages common, scene, sim, render, workflow, with the rules, and live, of scenes and profiles."""
SNAKEFILE = str(DISTRIBUTION / "workflow" / "Snakefile")
"""The rules that make films, for a `module` of another Snakefile."""

if str(DISTRIBUTION) not in sys.path:
    sys.path.insert(0, str(DISTRIBUTION))


def __getattr__(name: str) -> Any:
    """What scripts use, loaded when it is asked for: the command starts without it."""
    interface = import_module("tidemill.interface")
    if name in interface.__all__:
        return getattr(interface, name)
    raise AttributeError(f"module 'tidemill' has no attribute '{name}'")
