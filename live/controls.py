"""What of a scene can be changed while it runs, from the typed settings: paths, units, ranges, choices."""

from __future__ import annotations

import functools
import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import yaml

from scene.events import FIXED
from scene.reader import parse
from scene.settings import choices
from sim.cloth.spec import Cloth
from sim.fluid.spec import Fluid
from sim.spec import SimulationSpec

NOT_HERE = frozenset({"events", "probes", "precision", *FIXED})
PLACED = frozenset(
    [
        *("shape", "position", "rotation", "scale", "keyframes", "velocity", "angular_velocity", "pulls"),
        *("spacing", "pins", "type", "size", "open", "motion", "mass"),
    ]
)
"""Of bodies: where they are and what they are is changed by other means, or not at all."""
METHODS: dict[str, tuple[str, tuple[str, ...]]] = {
    "fluid": ("solver", choices(Fluid, "solver")),
    "cloth": ("integrator", choices(Cloth, "integrator")),
}
"""Groups of settings of which only the chosen one counts."""
USUAL = {"m/s^2": (-20.0, 20.0)}
"""What sliders go over where bounds are far."""
NOTCHES = 200
"""Of a slider."""
WIDEST = 100.0
"""Bounds up to here are those of sliders."""


@dataclass(frozen=True)
class Control:
    """A setting that can change."""

    path: str
    kind: Literal["number", "vector", "choice", "truth", "text"]
    value: Any
    unit: str = ""
    least: float | None = None
    most: float | None = None
    choices: tuple[str, ...] = ()

    @property
    def group(self) -> str:
        """Path of the settings that it is shown among."""
        return self.path.rpartition(".")[0] or self.path

    @property
    def label(self) -> str:
        """The setting's own name, with its unit."""
        name = self.path.rpartition(".")[2].replace("_", " ")
        return f"{name} [{self.unit}]" if self.unit not in ("", "1") else name

    @property
    def slides(self) -> tuple[float, float] | None:
        """What a slider of it goes over, if one would help."""
        if self.unit in USUAL:
            return USUAL[self.unit]
        least, most = self.least, self.most
        if self.kind != "number" or least is None or most is None or most - least > WIDEST:
            return None
        fine = 0 < abs(self.value) < (most - least) / NOTCHES
        return None if fine else (least, most)

    @property
    def notch(self) -> float:
        """The least move of a slider of it; 0 without one."""
        low, high = self.slides or (0.0, 0.0)
        return (high - low) / (10 * NOTCHES if self.kind == "vector" else NOTCHES)

    @property
    def form(self) -> tuple[Any, ...]:
        """What its field is made by, in which it may have any value."""
        return (self.kind, self.choices, self.slides)

    @property
    def hint(self) -> str:
        """The path, with the bounds of the value where there are any."""
        bounds = [f"from {self.least:g}" if self.least is not None else "", f"to {self.most:g}" if self.most else ""]
        return f"{self.path}: {' '.join(filter(None, bounds))}".removesuffix(": ")

    def shown(self) -> str:
        """The value as it would be written in a scene file."""
        return yaml.safe_dump(self.value, default_flow_style=True).removesuffix("\n...\n").strip()

    def read(self, text: str) -> Any:
        """The value that a text means in a scene file; raises SceneError."""
        return parse(f"{json.dumps(self.path)}: {text or 'null'}", source="live").data[self.path]


def controls(spec: SimulationSpec) -> list[Control]:
    """What can be changed of these settings."""
    schema = _schema()
    return list(_below("", spec.model_dump(mode="json"), schema, schema["$defs"]))


@functools.cache
def _schema() -> dict[str, Any]:
    return SimulationSpec.model_json_schema()


def _below(path: str, data: dict[str, Any], schema: dict[str, Any], known: dict[str, Any]) -> Iterator[Control]:
    method, all_of_them = METHODS.get(path, ("", ()))
    for key, value in data.items():
        here = f"{path}.{key}" if path else key
        if here in NOT_HERE or here == "fluid.bodies" or key in PLACED or (key in all_of_them and key != data[method]):
            continue
        found = _resolved(schema, key, value, known)
        if isinstance(value, dict):
            yield from _below(here, value, found, known)
        elif control := _control(here, value, found):
            yield control


def _resolved(schema: dict[str, Any], key: str, value: Any, known: dict[str, Any]) -> dict[str, Any]:
    """The schema of a key: a property's, or that of every name; of alternatives the one that fits the value."""
    named = next(iter(schema.get("patternProperties", {}).values()), schema.get("additionalProperties", {}))
    return _follow(schema.get("properties", {}).get(key) or named or {}, value, known)


def _follow(found: dict[str, Any], value: Any, known: dict[str, Any]) -> dict[str, Any]:
    if "$ref" in found:
        return _follow(known[found["$ref"].rpartition("/")[2]], value, known)
    options = found.get("oneOf") or (found.get("anyOf") if isinstance(value, dict) or value is None else None)
    if not options:
        return found
    mapping = found.get("discriminator", {}).get("mapping", {})
    if isinstance(value, dict) and value.get("type") in mapping:
        return _follow({"$ref": mapping[value["type"]]}, value, known)
    return _follow(next((item for item in options if item.get("type") != "null"), {}), value, known) | (
        {"unit": found["unit"]} if "unit" in found else {}
    )


def _control(path: str, value: Any, schema: dict[str, Any]) -> Control | None:
    unit = schema.get("unit", "")
    if isinstance(value, bool):
        return Control(path, "truth", value)
    if "enum" in schema:
        return Control(path, "choice", value, choices=tuple(schema["enum"]))
    if isinstance(value, list) and len(value) == 3 and all(isinstance(item, int | float) for item in value):
        inner = (schema.get("prefixItems") or [schema.get("items", {})])[0]
        return Control(path, "vector", value, inner.get("unit", unit), *_bounds(inner))
    if isinstance(value, list) or "." not in path:
        return None
    return Control(path, "number" if isinstance(value, int | float) else "text", value, unit, *_bounds(schema))


def _bounds(schema: dict[str, Any]) -> tuple[float | None, float | None]:
    for option in [schema, *schema.get("anyOf", [])]:
        least = option.get("minimum", option.get("exclusiveMinimum"))
        most = option.get("maximum", option.get("exclusiveMaximum"))
        if least is not None or most is not None:
            return least, most
    return None, None
