"""What is chosen by name: built in, or added by installed packages through entry points.

A package adds one of KINDS by an entry point of the group `tidemill.KIND`: its name is that in scene files, its value a
class of settings (`scene.settings.Settings`). The class says by IMPLEMENTATION, as `module:attribute`, what does the
work; that is imported only when it is used.

    [project.entry-points."tidemill.forces"]
    wind = "tidemill_wind.settings:Wind"
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from typing import Any

KINDS = ("solvers", "forces", "integrators", "shapes", "probes", "looks", "formats")


def names(kind: str) -> tuple[str, ...]:
    """Names of one of KINDS that installed packages add; nothing of them is imported."""
    return tuple(sorted(_entries().select(group=f"tidemill.{kind}").names))


@cache
def added(kind: str) -> dict[str, Any]:
    """The classes of settings of one of KINDS that installed packages add, by name."""
    found = _entries().select(group=f"tidemill.{kind}")
    return {entry.name: entry.load() for entry in sorted(found, key=lambda entry: entry.name)}


def packages(*kinds: str) -> set[str]:
    """The packages in which the work of what they add is done, of all KINDS unless some are given."""
    modules = (s.IMPLEMENTATION.partition(":")[0] for kind in kinds or KINDS for s in added(kind).values())
    return {module.partition(".")[0] for module in modules}


@cache
def _entries() -> Any:
    """Those of all installed packages, which takes as long as a file of each to read."""
    return entry_points()


def load(where: str) -> Any:
    """What `module:attribute` names."""
    module, _, attribute = where.partition(":")
    return getattr(import_module(module), attribute)
