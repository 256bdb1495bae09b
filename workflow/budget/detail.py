"""Scenes between presets: detail 0 is draft, 1 standard, 2 final, and numbers that these tell apart go along.

Below 0, for pilots, spacings go on as from standard to draft, or grow where presets leave them alone; all else is as
in a draft, since powers would soon leave what settings may be.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from scene import grid
from scene.load import BUDGET, Scene, load
from scene.presets import QUALITIES
from workflow.budget.spacings import is_spacing, scaled, spacing

FINEST = float(len(QUALITIES) - 1)
COARSER = 1.4
"""How many times spacings that no preset changes are larger where the detail is less by one."""
KEPT = frozenset({"fps"})
"""Paths of what stays as in the nearest preset: a film has whole frames."""


class Presets:
    """The scene at `path` at each of its presets, and between; `overrides` hold at all. Raises SceneError."""

    def __init__(self, path: Path, overrides: Sequence[str] = ()):
        self.path = path
        self._overrides = tuple(overrides)
        self._scenes = [load(path, quality=quality, overrides=overrides) for quality in QUALITIES]
        self._settings = [_settings(scene) for scene in self._scenes]

    def at(self, detail: float) -> Scene:
        """The scene with a detail of at most 2; raises SceneError."""
        nearest = self._scenes[_nearest(detail)]
        chosen = dict(_between("", self._settings, detail))
        if detail < 0 and spacing(self._scenes[0]) == spacing(self._scenes[1]):
            chosen |= scaled(nearest, COARSER**-detail)
        scene = load(self.path, quality=nearest.quality, overrides=(*self._overrides, *grid.overrides(chosen)))
        return replace(scene, quality=BUDGET)


def _settings(scene: Scene) -> dict[str, Any]:
    parts = {"surface": scene.surface, "render": scene.render}
    return scene.simulation.model_dump(mode="json") | {
        name: part.model_dump(mode="json") for name, part in parts.items()
    }


def _between(path: str, values: Sequence[Any], detail: float) -> Iterator[tuple[str, Any]]:
    """What has to be set where presets have these values, by path."""
    nearest = values[_nearest(detail)]
    if path in KEPT or all(value == nearest for value in values):
        return
    if all(isinstance(value, dict) and value.keys() == nearest.keys() for value in values):
        for key in nearest:
            yield from _between(f"{path}.{key}" if path else key, [value[key] for value in values], detail)
    elif detail < 0 and not is_spacing(path):
        return
    elif all(isinstance(value, list) and len(value) == len(nearest) for value in values):
        numbers = [_number(each, detail) for each in zip(*values, strict=True)]
        yield path, nearest if None in numbers else numbers
    else:
        number = _number(values, detail)
        yield path, nearest if number is None else number


def _nearest(detail: float) -> int:
    return max(0, round(detail))


def _number(values: Sequence[Any], detail: float) -> float | int | None:
    """By powers between the presets below and above; None for what is no number. Whole numbers stay whole, and even
    where all are."""
    if not all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        return None
    below = min(max(0, int(detail)), len(values) - 2)
    low, high, part = values[below], values[below + 1], detail - below
    found = low * (high / low) ** part if min(low, high) > 0 else low + (high - low) * part
    if not all(isinstance(value, int) for value in values):
        return float(f"{found:.6g}")
    step = 2 if all(value % 2 == 0 for value in values) else 1
    return max(step * math.floor(found / step + 0.5), min(values))
