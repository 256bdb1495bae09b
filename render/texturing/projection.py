"""Where images lie on a mesh: places in them (UV) at the corners of its triangles, (0, 0) being their lower left.

Everything is in the axes of the shape as it was given, before it was turned: y is up, and z to the front.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from typing import Any

from render.content.ply import TriangleMesh
from render.errors import Unusable

Point = tuple[float, float, float]
_SIDES = {
    (2, True): lambda x, y, z: (x, y),
    (2, False): lambda x, y, z: (-x, y),
    (0, True): lambda x, y, z: (-z, y),
    (0, False): lambda x, y, z: (z, y),
    (1, True): lambda x, y, z: (x, -z),
    (1, False): lambda x, y, z: (x, z),
}
"""Right and up as seen from outside, by the axis along which a side looks and whether it looks to its positive end; on
the upper side, up is to the back."""
_ON_AXIS = 1e-9
"""Distance from the axis, over that from the middle, below which a point is a pole."""


def project(source: TriangleMesh, look: Any, aspect: float, size: float | None = None) -> Any:
    """UV at the corners of a mesh, flat [6 m], as a look wants images to lie.

    `aspect` is the height of the images over their width, `size` their width [m] where the look has none: otherwise
    the longest edge of the mesh. Raises Unusable where the look wants what the mesh file had, and it had none.
    """
    projection = getattr(look, "projection", None) or ("box" if source.uv is None else "uv")
    if projection == "uv":
        if source.uv is None:
            raise Unusable("projection: its mesh has no UV coordinates: use box or sphere")
        return source.uv
    points = _own_axes(source)
    low, high = ([bound(point[axis] for point in points) for axis in range(3)] for bound in (min, max))
    middle = [(a + b) / 2 for a, b in zip(low, high, strict=True)]
    centred = [(x - middle[0], y - middle[1], z - middle[2]) for x, y, z in points]
    corners = source.triangles.tolist()
    triangles = [tuple(centred[corner] for corner in corners[at : at + 3]) for at in range(0, len(corners), 3)]
    flat = array("f")
    if projection == "sphere":
        for triangle in triangles:
            flat.extend(_around(triangle))
        return flat
    longest = max(b - a for a, b in zip(low, high, strict=True))
    width = getattr(look, "texture_size", None) or size or longest or 1.0
    for triangle in triangles:
        flatten = _SIDES[_side(triangle)]
        for corner in triangle:
            u, v = flatten(*corner)
            flat.extend((u / width + 0.5, v / (width * aspect) + 0.5))
    return flat


def _own_axes(source: TriangleMesh) -> list[Point]:
    columns = (source.columns[axis].tolist() for axis in "xyz")
    a, b, c, d, e, f, g, h, i = source.turned
    return [
        (a * x + d * y + g * z, b * x + e * y + h * z, c * x + f * y + i * z) for x, y, z in zip(*columns, strict=True)
    ]


def _side(triangle: Sequence[Point]) -> tuple[int, bool]:
    """The axis along which a triangle looks most, and whether it looks to its positive end."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = triangle
    ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
    normal = (uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx)
    # Between two axes, rounding must not decide: first the front, then the sides.
    weight = [abs(component) * factor for component, factor in zip(normal, (1.00001, 1.0, 1.00002), strict=True)]
    axis = weight.index(max(weight))
    return axis, normal[axis] >= 0


def _around(triangle: Sequence[Point]) -> list[float]:
    """Longitude and latitude of the corners; none is on the other side of the seam, which is at the back."""
    turns = [
        None if math.hypot(x, z) <= _ON_AXIS * math.hypot(x, y, z) else math.atan2(x, z) / (2 * math.pi) + 0.5
        for x, y, z in triangle
    ]
    known = [turn for turn in turns if turn is not None]
    if known and max(known) - min(known) > 0.5:
        turns = [turn + 1 if turn is not None and turn < 0.5 else turn for turn in turns]
        known = [turn for turn in turns if turn is not None]
    at_pole = sum(known) / len(known) if known else 0.5
    found = []
    for turn, (x, y, z) in zip(turns, triangle, strict=True):
        found += [at_pole if turn is None else turn, math.atan2(y, math.hypot(x, z)) / math.pi + 0.5]
    return found
