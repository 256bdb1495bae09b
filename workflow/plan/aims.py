"""What films aim at besides a preset: a budget of time, an error that physics may have, or other settings."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

from pydantic import TypeAdapter, ValidationError

from scene.load import ACCURACY, BUDGET, CHANGED, Scene, load
from scene.settings import Refused
from scene.units import PositiveDuration
from workflow.plan.lookup import stop


class Aim(ABC):
    """Chooses the settings of scenes, once for each, on the machine at hand."""

    key: ClassVar[str]
    """Of `--config`."""
    quality: ClassVar[str]
    """What results are filed under."""
    example: ClassVar[str]
    option: ClassVar[str]
    """The same of `tidemill render`."""

    @abstractmethod
    def __init__(self, given: Any, cores: int, preset: str | None):
        """From what `--config` gives, and the preset that it chooses; ends the process where that cannot be."""

    def scene(self, path: Path, name: str) -> Scene:
        """The scene at `path` as its film is made; every failure but SceneError ends the process with its message."""
        from workflow.budget.pilot import PilotFailed

        try:
            return self._scene(path, name)
        except Refused as refused:
            stop(f"{refused.message}\n  fix: {refused.remedy}")
        except PilotFailed as failed:
            stop(f"--config {self.key}: a coarse copy of {path} failed, so that nothing can be predicted\n{failed}")

    @abstractmethod
    def _scene(self, path: Path, name: str) -> Scene:
        """Raises SceneError, Refused, PilotFailed. Imports what it needs: other films need nothing of it."""


class Within(Aim):
    """The finest film that is predicted to be done in a time."""

    key, quality, example, option = "budget", BUDGET, "budget=10min", "--budget 10min"

    def __init__(self, given: Any, cores: int, preset: str | None):
        try:
            self._budget = TypeAdapter(PositiveDuration).validate_python(given)
        except ValidationError:
            stop(f"--config budget={given}: no time\n  fix: give one with its unit, as 10min or 2h")
        self._cores = cores

    def _scene(self, path: Path, name: str) -> Scene:
        from workflow.budget.choose import chosen
        from workflow.budget.detail import Presets

        return Presets(path).at(chosen(path, name, self._budget, self._cores).detail)


class Exact(Aim):
    """The cheapest film whose physics is as exact as studies found."""

    key, quality, example, option = "error", ACCURACY, "error=5%", "--error 5%"

    def __init__(self, given: Any, cores: int, preset: str | None):
        found = re.fullmatch(r"(\d+(?:\.\d*)?|\.\d+) *%", str(given).strip())
        if not found or not 0 < float(found[1]) < 100:
            stop(f"--config error={given}: no share of what is right\n  fix: give it in percent, as error=5%")
        self._error = float(found[1]) / 100
        self._cores = cores

    def _scene(self, path: Path, name: str) -> Scene:
        from workflow.accuracy.choose import chosen

        return chosen(path, name, self._error, self._cores)


class Changed(Aim):
    """The film of a preset with other settings, as `python -m sim run --set` takes them."""

    key, quality = "set", CHANGED
    example, option = "set='[\"render.samples=32\"]'", "--set render.samples=32"

    def __init__(self, given: Any, cores: int, preset: str | None):
        if not isinstance(given, list) or not given or not all(isinstance(one, str) for one in given):
            stop(f"--config set={given}: no list of settings\n  fix: give one, as {self.example}")
        self._settings, self._preset = tuple(given), preset

    def _scene(self, path: Path, name: str) -> Scene:
        return replace(load(path, quality=self._preset, overrides=self._settings), quality=CHANGED)


AIMS: tuple[type[Aim], ...] = (Within, Exact, Changed)


def aim_of(config: Mapping[str, Any], cores: int) -> Aim | None:
    """What `--config` asks for besides a preset."""
    given = [aim for aim in AIMS if aim.key in config]
    if not given:
        return None
    if len(given) > 1 or ("quality" in config and given != [Changed]):
        one, other = [key for key in ("quality", *(aim.key for aim in AIMS)) if key in config][:2]
        stop(f"--config {one} and {other}: each chooses the settings\n  fix: leave one of them out")
    return given[0](config[given[0].key], cores, config.get("quality"))
