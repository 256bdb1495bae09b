"""The combinations of a scene's `wedge:`, and their names: `honey@viscosity=0.001,size=0.1` is one of `honey`."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from scene import grid

MARK = "@"
"""Between the name of a scene and that of a combination."""
MOST = 1000
LONGEST = 80
_UNFIT = re.compile(r"[^A-Za-z0-9.+-]+")


@dataclass(frozen=True)
class Combination:
    """One value for every path of a wedge."""

    name: str
    chosen: Mapping[str, Any]

    @property
    def overrides(self) -> tuple[str, ...]:
        """As `load` takes them; the copy of the film that a scene asks for, and the wedge, are of the scene itself."""
        return grid.overrides({**self.chosen, "film.copy_to": None, "wedge": {}})


def split(name: str) -> tuple[str, str]:
    """The scene and the combination of a name; the latter is empty for the scene itself."""
    scene, _, combination = name.partition(MARK)
    return scene, combination


def combinations(wedge: Mapping[str, Sequence[Any]]) -> list[Combination]:
    """All combinations in order, the last path varying fastest; raises Refused where there are too many."""
    if not wedge:
        return []
    grid.refuse_more(MOST, [wedge], "combinations", ("wedge",))
    labels = _labels(list(wedge))
    found = {}
    for chosen in grid.combinations(wedge):
        name = ",".join(f"{labels[path]}={_word(value)}" for path, value in chosen.items())
        if name in found or len(name) > LONGEST:
            digest = hashlib.sha256(json.dumps(chosen, sort_keys=True).encode()).hexdigest()[:8]
            name = f"{name[:LONGEST]}-{digest}"
        found[name] = Combination(name, chosen)
    return list(found.values())


def _labels(paths: Sequence[str]) -> dict[str, str]:
    """The shortest ends of paths that tell them apart."""
    labels = {}
    for path in paths:
        parts = path.split(".")
        ends = (".".join(parts[-count:]) for count in range(1, len(parts) + 1))
        others = [other for other in paths if other != path]
        labels[path] = next(
            (end for end in ends if not any(other == end or other.endswith(f".{end}") for other in others)), path
        )
    return labels


def _word(value: Any) -> str:
    text = value if isinstance(value, str) else json.dumps(value)
    return _UNFIT.sub("_", text.replace(" ", "")).strip("_") or "_"
