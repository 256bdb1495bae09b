"""What a stage depends on of solvers, integrators and all else that installed packages add."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from common.registry import added
from workflow.plan import sources

KINDS = {
    "simulate": {"solvers": "fluid", "forces": "fluid", "integrators": "cloth", "shapes": "", "probes": ""},
    "render": {"looks": ""},
}
"""By the stage that uses them, with the material without which a scene does not."""


def digest(stage: str, materials: frozenset[str]) -> str:
    """Digest of the files with their settings and with what does their work, for scenes with these materials; empty
    where there are none."""
    kinds = [kind for kind, needed in KINDS.get(stage, {}).items() if not needed or needed in materials]
    files = sorted({file for kind in kinds for settings in added(kind).values() for file in _of(settings)})
    if not files:
        return ""
    return hashlib.sha256(b"\n".join(file.read_bytes() for file in files)).hexdigest()


def _of(settings: Any) -> Iterator[Path]:
    """The module of the settings, the one that does their work, and what these import of their own packages."""
    for module in (settings.__module__, settings.IMPLEMENTATION.partition(":")[0]):
        package, found = module.partition(".")[0], find_spec(module)
        if found is None or found.origin is None:
            continue
        file = Path(found.origin)
        if file.suffix != ".py":
            yield file
            continue
        above = len(module.split(".")) + (file.name == "__init__.py")
        yield from sources.closure(module, file.parents[above - 1], packages=(package,))
