"""Typed settings of the camera: placed, moved by keyframes, or framing the action by itself."""

from __future__ import annotations

import itertools
from typing import Annotated, Any, Literal, Self

from annotated_types import Ge, Gt, Le, Len, Lt
from pydantic import model_validator
from pydantic_core import PydanticCustomError

from scene.settings import Settings
from scene.units import Angle, Dimensionless, Duration, Position, PositiveLength

Elevation = Annotated[Angle, Ge(-89), Le(89)]


def changed(settings: Settings, *names: str) -> list[str]:
    """Which of the settings differ from their defaults: what a canonical dump sets is not what a user wrote."""
    return [name for name in names if getattr(settings, name) != type(settings).model_fields[name].default]


class DepthOfField(Settings):
    """What is nearer or farther than the focus is blurred."""

    f_stop: Annotated[Dimensionless, Gt(0), Le(1000)] = 2.8
    """Focal length over aperture: the smaller, the more blur. The lens is that of a full-frame camera."""
    focus: Position | None = None
    """The point in focus [m]; without it, what the camera looks at."""


class CameraKeyframe(Settings):
    """Where the camera is at one time."""

    at: Duration
    """Simulated time [s]."""
    position: Position
    """Where it stands [m]."""
    target: Position
    """What it looks at [m]."""
    field_of_view: Annotated[Angle, Gt(1), Lt(170)] | None = None
    """Across the longer side of the picture; without it, that of the camera."""

    @model_validator(mode="after")
    def _faces_a_direction(self) -> Self:
        if self.position == self.target:
            raise ValueError("position and target must differ: move one of them")
        return self


class Camera(Settings):
    """Placed by `position` and `target`, or moved by `keyframes`; without them it frames the box of the action by
    itself."""

    position: Position | None = None
    """Where the camera stands [m]."""
    target: Position | None = None
    """What it looks at [m]."""
    keyframes: Annotated[tuple[CameraKeyframe, ...], Len(0, 1000)] = ()
    """A camera that moves: smoothly through these places, softly from the first and to the last."""
    azimuth: Angle = 24.0
    """Automatic framing: from which side it looks; 0 deg is from the front (+z), 90 deg from the right (+x)."""
    elevation: Elevation = 17.0
    """Automatic framing: how high above the horizon it stands."""
    margin: Annotated[Dimensionless, Ge(0), Le(0.8)] = 0.1
    """Automatic framing: share of the picture's half width and half height that stays free."""
    projection: Literal["perspective", "orthographic"] = "perspective"
    """`orthographic` shows everything at its size, however far away: parallel rays, as in a drawing to scale."""
    width: PositiveLength | None = None
    """Orthographic, of a camera that is placed: what is seen across the longer side of the picture [m]."""
    field_of_view: Annotated[Angle, Gt(1), Lt(170)] = 32.0
    """Across the longer side of the picture."""
    focal_length: PositiveLength | None = None
    """Instead of the field of view: that of a full-frame camera (36 mm across the longer side), as `50 mm`."""
    depth_of_field: DepthOfField | None = None
    """Without it everything is in focus."""

    @model_validator(mode="after")
    def _placed_or_automatic(self) -> Self:
        if (self.position is None) != (self.target is None):
            raise ValueError("position and target belong together: give both, or neither for automatic framing")
        if len(self.keyframes) == 1:
            raise ValueError("one keyframe is no move: give two or more, or position and target")
        if any(early.at >= late.at for early, late in itertools.pairwise(self.keyframes)):
            raise ValueError("the times of the keyframes must grow: sort them, no two at the same")
        if self.keyframes and self.position is not None:
            raise ValueError("keyframes and position exclude each other: remove one of them")
        if self.position is not None or self.keyframes:
            if self.position is not None and self.position == self.target:
                raise ValueError("position and target must differ: move one of them")
            idle = changed(self, "azimuth", "elevation", "margin")
            if idle:
                raise ValueError(
                    f"{', '.join(idle)} of the automatic framing and a camera that is placed exclude each other: "
                    "remove one of them"
                )
        if self.focal_length is not None and changed(self, "field_of_view"):
            raise ValueError("field_of_view and focal_length exclude each other: remove one of them")
        return self

    @model_validator(mode="after")
    def _lens_or_width(self) -> Self:
        if self.projection == "perspective":
            if self.width is not None:
                raise ValueError("width is of an orthographic camera: change projection, or give field_of_view")
            return self
        lens = changed(self, "field_of_view", "focal_length", "depth_of_field")
        if any(key.field_of_view is not None for key in self.keyframes):
            lens.append("field_of_view of a keyframe")
        if lens:
            raise ValueError(
                f"{', '.join(lens)} and an orthographic camera exclude each other, since parallel rays have no lens: "
                "remove it, or change projection"
            )
        placed = self.position is not None or bool(self.keyframes)
        if placed and self.width is None:
            raise ValueError("width is missing: say how many metres an orthographic camera that is placed shows across")
        if not placed and self.width is not None:
            raise ValueError("width and automatic framing exclude each other: remove it, or give position and target")
        return self


def camera_is_there(value: Any) -> Any:
    """Refuse `camera:` with nothing behind it."""
    if value is None:
        raise PydanticCustomError(
            "camera_missing",
            "camera missing: leave the key out for automatic framing, or give position and target",
        )
    return value
