"""What is chosen by name: built in, or added by installed packages through entry points.

A package adds one of KINDS by an entry point of the group `tidemill.KIND`: its name is that in scene files, its value a
class of settings (`scene.settings.Settings`). The class says by IMPLEMENTATION, as `module:attribute`, what does the
work; that is imported only when it is used.

    [project.entry-points."tidemill.forces"]
    wind = "tidemill_wind.settings:Wind"
"""

from __future__ import annotations

import sys
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from typing import Any, NoReturn

KINDS = ("solvers", "forces", "integrators", "shapes", "probes", "looks", "formats")
SETTINGS_TOGETHER = (("forces", "solvers"),)
"""Those whose settings stand in one group of a scene, so that their names must differ."""
REFUSED = 2
"""Exit status where what is installed cannot be used together."""


def names(kind: str, *own: str) -> tuple[str, ...]:
    """Names of one of KINDS that installed packages add; nothing of them is imported.

    Ends the process with exit status 2 where one of them is taken: by our `own`, or by another package.
    """
    return tuple(entry.name for entry in _named(kind, own))


@cache
def added(kind: str, *own: str) -> dict[str, Any]:
    """The classes of settings of one of KINDS that installed packages add, by name; ends as `names` does."""
    return {entry.name: entry.load() for entry in _named(kind, own)}


def packages(*kinds: str) -> set[str]:
    """The packages in which the work of what they add is done, of all KINDS unless some are given."""
    modules = (s.IMPLEMENTATION.partition(":")[0] for kind in kinds or KINDS for s in added(kind).values())
    return {module.partition(".")[0] for module in modules}


def _named(kind: str, own: tuple[str, ...]) -> list[EntryPoint]:
    found = sorted(_entries().select(group=f"tidemill.{kind}"), key=lambda entry: entry.name)
    taken = list(own)
    for together in SETTINGS_TOGETHER:
        if kind in together:
            taken += [name for other in together if other < kind for name in names(other)]
    for entry in found:
        if entry.name in taken:
            _refuse(kind, entry)
        taken.append(entry.name)
    return found


def _refuse(kind: str, entry: EntryPoint) -> NoReturn:
    package = entry.dist.name if entry.dist else entry.module
    print(
        f"the package {package} adds a {kind.removesuffix('s')} named '{entry.name}', and that name is taken: "
        f"give it another one in its entry points (tidemill.{kind}), or uninstall the package",
        file=sys.stderr,
    )
    raise SystemExit(REFUSED)


@cache
def _entries() -> Any:
    """Those of all installed packages, which takes as long as a file of each to read."""
    return entry_points()


def load(where: str) -> Any:
    """What `module:attribute` names."""
    module, _, attribute = where.partition(":")
    return getattr(import_module(module), attribute)
