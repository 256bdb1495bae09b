"""Motion of things while the shutter is open, as keyframes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from render.blender import versions

PLACE = ("location", "rotation_quaternion")


def blur(thing: Any, frame: int, exposure: float, place: Callable[[float], None]) -> None:
    """Keyframes at the ends of the exposure and at the frame, straight in between, where `place` brings the thing to
    where it is so many frames after the frame. `exposure` is in frames; 0 is none.
    """
    forget(thing)
    for offset in (-exposure / 2, exposure / 2, 0.0) if exposure > 0 else (0.0,):
        place(offset)
        if exposure > 0:
            for path in PLACE:
                thing.keyframe_insert(path, frame=frame + offset)
    if exposure > 0:
        for curve in versions.curves(thing):
            for key in curve.keyframe_points:
                key.interpolation = "LINEAR"


def show_only(thing: Any, seen: bool, frame: int) -> None:
    """Keep as keyframes whether a thing is in sight from a frame on."""
    thing.hide_render = thing.hide_viewport = not seen
    for path in ("hide_render", "hide_viewport"):
        thing.keyframe_insert(path, frame=frame)


def forget(thing: Any) -> None:
    """Remove a thing's keyframes. The action stays: to remove one, Blender looks through all that there is."""
    if thing.animation_data is not None:
        versions.curves(thing).clear()
        thing.animation_data.action.update_tag()  # else Blender moves the thing by the curves that it had
