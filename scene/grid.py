"""Values to try by the dotted path of a setting: every combination of them, and how `load` takes one."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from scene.settings import Refused

Grid = Mapping[str, Sequence[Any]]


def combinations(grid: Grid) -> Iterator[dict[str, Any]]:
    """One value for every path, the last path varying fastest."""
    for values in itertools.product(*grid.values()):
        yield dict(zip(grid, values, strict=True))


def setting(settings: Mapping[str, Any], path: str) -> Any:
    """What stands at a path."""
    found: Any = settings
    for key in path.split("."):
        found = found[key]
    return found


def overrides(chosen: Mapping[str, Any]) -> tuple[str, ...]:
    """As `load` takes them."""
    return tuple(f"{path}={json.dumps(value)}" for path, value in chosen.items())


def refuse_more(most: int, grids: Sequence[Grid], noun: str, location: tuple[str, ...]) -> None:
    """Raise Refused where there are more combinations than `most`."""
    count = sum(math.prod(len(values) for values in grid.values()) for grid in grids)
    if count > most:
        remedy = f"leave values out until there are {most:,} at most"
        raise Refused(f"{count:,} {noun}", location=location, remedy=remedy)
