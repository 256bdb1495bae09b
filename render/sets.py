"""Sets: what each gives for settings of lights, ground and background that the scene leaves open."""

from __future__ import annotations

from typing import Any, Literal

Set = Literal["none", "studio", "table", "tiles", "pool", "garden"]

DEFAULTS: dict[str, dict[str, Any]] = {
    "studio": {
        "lights": {"sun": {"strength": 0.0}, "softboxes": 4.0, "environment": {"light": "studio", "strength": 0.35}},
        "background": {"type": "plain", "color": "#dcdcda"},
        "ground": {"material": {"type": "matte", "color": "#d2d0cc"}},
    },
    "table": {
        "lights": {
            "sun": {"azimuth": -75.0, "elevation": 38.0, "angle": 8.0, "strength": 2.5},
            "softboxes": 1.0,
            "environment": {"light": "interior", "strength": 0.7, "rotation": 180.0},
        },
        "background": {"type": "environment", "blur": 9.0},
        "ground": {"material": {"type": "planks"}},
    },
    "tiles": {
        "lights": {"sun": {"strength": 2.0, "angle": 6.0}, "softboxes": 1.0, "environment": {"strength": 0.3}},
        "background": {"type": "plain", "color": "#dfe3e4"},
        "ground": {"material": {"type": "tiles", "color": "#d3d9d6", "joint": "#7f8a8a"}},
    },
    "pool": {
        "lights": {"sun": {"elevation": 55.0, "angle": 1.0}, "environment": {"strength": 0.7}},
        "background": {"type": "gradient", "horizon": "#d5e4ea", "zenith": "#7fb0d0"},
        "ground": {"material": {"type": "tiles", "color": "#58a7c4", "joint": "#dcebef", "tone_variation": 0.5}},
    },
    "garden": {
        "lights": {"sun": {"angle": 1.0}, "environment": {"light": "forest", "strength": 0.6}},
        "background": {"type": "environment", "blur": 4.0},
        "ground": {
            "material": {
                "type": "tiles",
                "color": "#a0927e",
                "joint": "#5a5547",
                "roughness": 0.8,
                "tone_variation": 0.6,
            }
        },
    },
}


def with_set(data: Any) -> Any:
    """The `render:` section as written, with what its set gives for all that it leaves out.

    What is not a section, or names no known set, stays as it is.
    """
    if not isinstance(data, dict) or not isinstance(data.get("set"), str):
        return data
    return _below(data, DEFAULTS.get(data["set"], {}))


def _below(own: dict[str, Any], defaults: dict[str, Any]) -> dict[str, Any]:
    """Groups key by key, unless the own one is of another type; a panorama's file stands for its name."""
    merged = dict(own)
    for key, value in defaults.items():
        if key not in own:
            merged[key] = value
        elif isinstance(own[key], dict) and isinstance(value, dict) and _of_a_type(own[key], value):
            merged[key] = _below(own[key], value)
    if own.get("file") is not None:
        merged.pop("light", None)
    return merged


def _of_a_type(own: dict[str, Any], defaults: dict[str, Any]) -> bool:
    return bool(own.get("type", defaults.get("type")) == defaults.get("type"))
