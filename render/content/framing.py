"""Where a camera must stand to see a box: projective geometry, without Blender."""

from __future__ import annotations

import bisect
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from render.content.axes import Vector, triple, z_up
from render.inputs import Box

FULL_FRAME = 0.036
"""Longer side of the sensor [m]."""
NEAREST, FARTHEST = 2.0, 12.0
"""How far off an orthographic camera stands that frames by itself, over the diagonal of the box."""


@dataclass(frozen=True)
class View:
    """A camera in Blender's axes: where it stands, what it looks at [m], and its field of view
    across the picture's width and height [rad]; an orthographic one has, instead of these, what it shows [m]."""

    position: Vector
    target: Vector
    width_angle: float = 0.0
    height_angle: float = 0.0
    shown: tuple[float, float] | None = None

    def project(self, point: Vector) -> tuple[float, float, float]:
        """Right and up in the picture, each from -1 to 1 within it, and the depth [m]."""
        right, up, back = _axes(_minus(self.position, self.target))
        offset = _minus(point, self.position)
        depth = -_dot(offset, back)
        if self.shown is not None:
            return 2 * _dot(offset, right) / self.shown[0], 2 * _dot(offset, up) / self.shown[1], depth
        return (
            _dot(offset, right) / depth / math.tan(self.width_angle / 2),
            _dot(offset, up) / depth / math.tan(self.height_angle / 2),
            depth,
        )


def direction(azimuth: float, elevation: float) -> Vector:
    """Unit vector towards an azimuth and elevation [deg] of the settings, in Blender's axes."""
    around, above = math.radians(azimuth), math.radians(elevation)
    return z_up((math.sin(around) * math.cos(above), math.sin(above), math.cos(around) * math.cos(above)))


def angles(resolution: tuple[int, int], field_of_view: float) -> tuple[float, float]:
    """Field of view across width and height [rad] from that across the longer side [deg]."""
    width, height = resolution
    half = math.tan(math.radians(field_of_view) / 2) / max(width, height)
    return 2 * math.atan(half * width), 2 * math.atan(half * height)


def frame_box(
    box: Box, toward_camera: Vector, resolution: tuple[int, int], field_of_view: float, margin: float
) -> View:
    """The nearest view along a direction that keeps `margin` of the half picture free around the box's corners."""
    width_angle, height_angle = angles(resolution, field_of_view)
    right, up, back = _axes(toward_camera)
    center = box.center
    corners = [_minus(corner, center) for corner in box.corners()]
    depths = [_dot(corner, back) for corner in corners]
    distance, shifts = 0.0, []
    for axis, angle in ((right, width_angle), (up, height_angle)):
        slope = math.tan(angle / 2) * (1 - margin)
        # a corner at (a, depth) is inside if |a - shift| <= slope * (distance - depth)
        positive = max(depth + _dot(corner, axis) / slope for corner, depth in zip(corners, depths, strict=True))
        negative = max(depth - _dot(corner, axis) / slope for corner, depth in zip(corners, depths, strict=True))
        distance = max(distance, (positive + negative) / 2)
        shifts.append(slope * (positive - negative) / 2)
    across, upward = shifts
    target = _sum(center, _scaled(right, across), _scaled(up, upward))
    return View(_sum(target, _scaled(back, distance)), target, width_angle, height_angle)


def frame_box_to_scale(box: Box, toward_camera: Vector, resolution: tuple[int, int], margin: float) -> View:
    """The orthographic view along a direction with `margin` of the half picture free around the box's corners.

    It is so far off that the lower edge of the picture begins above what the box stands on.
    """
    right, up, back = _axes(toward_camera)
    center = box.center
    corners = [_minus(corner, center) for corner in box.corners()]
    spans = [[_dot(corner, axis) for corner in corners] for axis in (right, up)]
    metres = max((max(span) - min(span)) / pixels for span, pixels in zip(spans, resolution, strict=True)) / (
        1 - margin
    )
    shown = (metres * resolution[0], metres * resolution[1])
    across, upward = ((max(span) + min(span)) / 2 for span in spans)
    target = _sum(center, _scaled(right, across), _scaled(up, upward))
    distance = min(max(NEAREST * box.diagonal, shown[1] * up[2] / max(back[2], 1e-9)), FARTHEST * box.diagonal)
    return View(_sum(target, _scaled(back, distance)), target, shown=shown)


def view_of(camera: Any, box: Box | None, resolution: tuple[int, int], time: float = 0.0) -> View:
    """The view that the camera's settings ask for at a time [s]; `box` may be None for a placed camera."""
    if camera.projection == "orthographic":
        return _view_to_scale(camera, box, resolution, time)
    field_of_view = camera.field_of_view
    if camera.focal_length is not None:
        field_of_view = math.degrees(2 * math.atan(FULL_FRAME / 2 / camera.focal_length))
    if camera.keyframes:
        position, target, field_of_view = _moved(camera.keyframes, field_of_view, time)
        return View(z_up(position), z_up(target), *angles(resolution, field_of_view))
    if camera.position is not None:
        return View(z_up(camera.position), z_up(camera.target), *angles(resolution, field_of_view))
    return frame_box(
        _to_frame(box), direction(camera.azimuth, camera.elevation), resolution, field_of_view, camera.margin
    )


def _view_to_scale(camera: Any, box: Box | None, resolution: tuple[int, int], time: float) -> View:
    if camera.width is None:
        toward = direction(camera.azimuth, camera.elevation)
        return frame_box_to_scale(_to_frame(box), toward, resolution, camera.margin)
    position, target = camera.position, camera.target
    if camera.keyframes:
        position, target, _ = _moved(camera.keyframes, 0.0, time)
    metres = camera.width / max(resolution)
    return View(z_up(position), z_up(target), shown=(metres * resolution[0], metres * resolution[1]))


def _to_frame(box: Box | None) -> Box:
    if box is None:
        raise TypeError("a camera that is not placed needs a box to frame")
    return box


def _moved(keyframes: Sequence[Any], field_of_view: float, time: float) -> tuple[Vector, Vector, float]:
    """Position, target and field of view between keyframes: a cubic Hermite curve through them whose slopes are those
    of Catmull & Rom 1974, and zero at both ends, so that the camera sets off and comes to rest softly."""
    times = [key.at for key in keyframes]
    time = min(max(time, times[0]), times[-1])
    end = min(bisect.bisect_right(times, time), len(times) - 1)
    start = end - 1
    length = times[end] - times[start]
    share = (time - times[start]) / length
    square, cube = share**2, share**3
    values = [(*key.position, *key.target, key.field_of_view or field_of_view) for key in keyframes]

    def slope(channel: Sequence[float], index: int) -> float:
        if index in (0, len(times) - 1):
            return 0.0
        interval = times[index + 1] - times[index - 1]
        return (channel[index + 1] - channel[index - 1]) * (1 / interval)

    def between(channel: Sequence[float]) -> float:
        return (
            channel[start] * (2 * cube - 3 * square + 1)
            + slope(channel, start) * (length * (cube - 2 * square + share))
            + channel[end] * (3 * square - 2 * cube)
            + slope(channel, end) * (length * (cube - square))
        )

    found = [between(channel) for channel in zip(*values, strict=True)]
    return triple(found[:3]), triple(found[3:6]), found[6]


def _axes(back: Vector) -> tuple[Vector, Vector, Vector]:
    """Right, up and back of a camera whose back points along a vector; up leans towards +z."""
    back = _scaled(back, 1 / math.sqrt(_dot(back, back)))
    right = _cross((0.0, 0.0, 1.0), back)
    length = math.sqrt(_dot(right, right))
    right = (1.0, 0.0, 0.0) if length < 1e-6 else _scaled(right, 1 / length)
    return right, _cross(back, right), back


def rotation_matrix(toward: Vector) -> tuple[Vector, Vector, Vector]:
    """Rows of the rotation that turns a camera or lamp to face away from `toward`."""
    right, up, back = _axes(toward)
    x, y, z = zip(right, up, back, strict=True)
    return x, y, z


def _dot(a: Vector, b: Vector) -> float:
    return sum(p * q for p, q in zip(a, b, strict=True))


def _cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _minus(a: Vector, b: Vector) -> Vector:
    return triple(p - q for p, q in zip(a, b, strict=True))


def _scaled(a: Vector, factor: float) -> Vector:
    return triple(factor * p for p in a)


def _sum(*vectors: Vector) -> Vector:
    return triple(map(sum, zip(*vectors, strict=True)))
