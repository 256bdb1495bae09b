"""The scene that is played live: what may still be done to it, and the scene file that does it all again."""

from __future__ import annotations

import copy
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml

from scene.document import Document
from scene.load import Scene, compose, load
from scene.reader import assign
from scene.settings import Refused
from sim.spec import Event, SimulationSpec

HERE = "live"
"""The source that messages name instead of a file."""
OF_FILMS = ("wedge", "quality", "duration", "events")
"""What a saved scene does not take over as it is."""


@dataclass(frozen=True)
class Script:
    """A scene, and the checks and files of what is done to it."""

    scene: Scene

    def event(self, at: float, data: dict[str, Any], now: SimulationSpec, taken: Iterable[str]) -> Event:
        """The event at `at` [s] that `data` describes as in a scene file, where the settings in force are `now` and
        names were given to others.

        Raises SceneError, with the message that it has in a file.
        """
        current = now.model_dump(mode="json", exclude_none=True)
        current = {key: value for key, value in current.items() if key not in {"probes", "events"}}
        document = Document(HERE, {"duration": 1 / now.fps, **current, "events": [{"at": at, **data}]})
        scene = compose(document, self.scene.path, self.scene.quality)
        event = scene.simulation.events[0]
        for name in event.add.names():
            if name in taken:
                message, remedy = f"there is or was a body named '{name}'", "give it a name of its own"
                raise replace(scene, document=document).error(
                    Refused(message, location=("events", 0, "add"), remedy=remedy)
                )
        return event

    def save(self, path: Path, events: Iterable[Event], frames: int) -> Scene:
        """Write the scene file whose film shows what was done, and load it; raises SceneError, OSError."""
        duration = frames / self.scene.simulation.fps
        data = _lasting(self.scene)
        data = {"description": data.pop("description", f"{self.scene.name}, played live"), **data}
        data |= {"duration": duration, "quality": self.scene.quality}
        data["events"] = [_plain(event) for event in events if event.at < duration]
        head = f"# Played live from {self.scene.path.name} (python -m sim live {self.scene.path.name}).\n"
        text = head + yaml.safe_dump(data, sort_keys=False, allow_unicode=True, default_flow_style=None, width=120)
        path.parent.mkdir(parents=True, exist_ok=True)
        # Never through a link, which `exists` takes for nothing where it leads to nothing.
        with path.open("x", encoding="utf-8") as stream:
            stream.write(text)
        return load(path)


def _lasting(scene: Scene) -> dict[str, Any]:
    """What the scene file says for every preset, with the overrides, and without what belongs to a film."""
    document = Document(scene.written.source, copy.deepcopy(scene.written.data))
    for override in scene.overrides:
        assign(document, override)
        for quality, values in document.data.get("presets", {}).items():
            if _speaks_of(values, override.partition("=")[0].strip().split(".")):
                assign(document, f"presets.{quality}.{override}")
    data = {key: value for key, value in document.data.items() if key not in OF_FILMS}
    presets = {
        quality: {key: value for key, value in values.items() if key not in OF_FILMS}
        for quality, values in data.pop("presets", {}).items()
    }
    return {**data, **({"presets": presets} if presets else {})}


def _speaks_of(values: Any, keys: list[str]) -> bool:
    for key in keys:
        if not isinstance(values, dict):
            return True
        if key not in values:
            return False
        values = values[key]
    return True


def _plain(event: Event) -> dict[str, Any]:
    data = event.model_dump(mode="json", exclude_none=True, exclude_defaults=True)
    return {"at": event.at, **{key: value for key, value in data.items() if key != "at"}}
