"""What the quality presets mean, in the form of a scene; a scene's own values go above them.

Derived from the studies of the project: docs/accuracy.md says what each costs and how exact it is.
"""

from __future__ import annotations

from typing import Any, Literal

Quality = Literal["draft", "standard", "final"]
QUALITIES: tuple[Quality, ...] = ("draft", "standard", "final")

PRESETS: dict[str, dict[str, dict[str, Any]]] = {
    "draft": {
        "surface": {
            "cube_size": 1.25,
            "surface_threshold": 0.5,
            "smoothing": {"iterations": 15},
            "normals": {"smoothing_iterations": 5},
        },
        "render": {
            "resolution": [480, 270],
            "samples": 4,
            "noise_threshold": 0.05,
            "denoise_quality": "balanced",
            "motion_blur": False,
        },
        "rigid": {"max_step": 0.008},
        "cloth": {"max_step": 0.01},
    },
    "standard": {
        "surface": {"cube_size": 1.0, "surface_threshold": 0.5},
        "render": {"resolution": [640, 360], "samples": 8, "noise_threshold": 0.05},
    },
    "final": {
        "surface": {"cube_size": 0.75, "surface_threshold": 0.55},
        "render": {"resolution": [1920, 1080], "samples": 128, "noise_threshold": 0.01},
        "rigid": {"max_step": 0.002},
        "cloth": {"max_step": 0.0025},
    },
}
"""Smoothing takes the more off the volume the larger the cubes are: a lower threshold of the surface makes up for it.
Sections of materials hold only for scenes that have them, and leave the length of steps to them."""
ALWAYS = frozenset({"surface", "render"})


def below(own: dict[str, Any], quality: str) -> dict[str, Any]:
    """A scene with the preset's values for what it leaves out."""
    data, step = dict(own), own.get("step")
    paced = isinstance(step, dict) and "fixed" in step
    for section, values in PRESETS.get(quality, {}).items():
        absent: dict[str, Any] | None = {} if section in ALWAYS else None
        given = own.get(section, absent)
        if isinstance(given, dict) and (section in ALWAYS or not paced):
            data[section] = _merged(values, given)
    return data


def _merged(defaults: dict[str, Any], own: dict[str, Any]) -> dict[str, Any]:
    merged = {**defaults, **own}
    for key in defaults.keys() & own.keys():
        if isinstance(defaults[key], dict) and isinstance(own[key], dict):
            merged[key] = _merged(defaults[key], own[key])
    return merged
