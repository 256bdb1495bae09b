"""Particles that fill solids: as many as their volume holds, on a lattice that fits."""

from __future__ import annotations

import itertools
import math

import numpy as np

from scene.settings import Refused
from sim.geometry.analytic_solids import BoxSolid, CylinderSolid
from sim.geometry.solids import Solid

EDGE_TOLERANCE = 1e-3
"""Share of the spacing by which an edge may miss a multiple of it: lengths are typed with few digits."""
UNLIKE = 0.1
"""A lattice whose number of points inside is off by more than this share is taken with another step."""
_MOST_POINTS = 500_000_000
"""Beyond which memory runs out long before a film would be done."""
_HALVINGS = 20
_GOLDEN = (math.sqrt(5) - 1) / 2


def fill(solid: Solid, spacing: float) -> np.ndarray:
    """Particle positions [m], shape [n, 3], that fill a solid with n = V / spacing^3 particles, rounded.

    A box has whole layers along two of its edges and rows along the third, of numbers that differ by at most one,
    which is the cubic lattice of `spacing` [m] where the edges are multiples of that. A cylinder has layers of a square
    lattice along its axis. Any other shape has the cubic lattice along the world's axes, centred in its bounding
    box, or moved by half a spacing where that gives too few points, without the points nearest its surface that are
    too many. Where it is so thin that no such lattice comes near, the step of the lattice is another one.

    Raises `Refused` for a shape without volume, one of less than half a particle, or too many points.
    """
    number = particle_number(solid, spacing)
    match solid:
        case BoxSolid():
            return _fill_box(solid, spacing, number)
        case CylinderSolid():
            return _fill_cylinder(solid, spacing, number)
    return _fill_shape(solid, spacing, number)


def particle_number(solid: Solid, spacing: float) -> int:
    """V / spacing^3, rounded, of a solid. Raises `Refused` as `fill` does."""
    if not solid.closed or not math.isfinite(solid.volume):
        raise Refused(
            "the shape has no volume to fill",
            remedy="Use a closed shape: box, sphere, cylinder, capsule, torus or a closed mesh",
        )
    check_number(solid.volume / spacing**3, spacing)
    number = round(solid.volume / spacing**3)
    if number == 0:
        # A radius in metres larger than the body may be one in millimetres.
        meant = f", or {spacing / 2:g} mm if that was meant" if spacing > 1 else ""
        raise Refused(
            f"no particle fits into the shape: its {solid.volume:.4g} m^3 are less than half a particle's, "
            f"{spacing**3:.4g} m^3",
            remedy=f"Make the shape larger, or use a particle_radius below {solid.volume ** (1 / 3) / 2:.3g} m{meant}",
        )
    return number


def check_number(number: float, spacing: float) -> None:
    """Raises `Refused` for more points than memory holds."""
    if not spacing > 0:
        raise ValueError(f"spacing must be positive, got {spacing}")
    if number > _MOST_POINTS:
        raise Refused(
            f"{number:.3g} points at a spacing of {spacing:.4g} m are more than memory holds",
            remedy="Make the particle radius larger or the shape smaller",
        )


def outermost(depth: np.ndarray, number: int, unit: float) -> np.ndarray:
    """The indices of the `number` smallest depths [m], shape [n]; of equal ones, to 1e-6 of `unit` [m], some that are
    spread evenly."""
    level = np.round(depth / (1e-6 * unit))
    spread = (np.arange(len(depth)) * _GOLDEN) % 1.0
    return np.lexsort((spread, level))[:number]


def _fill_box(box: BoxSolid, spacing: float, number: int) -> np.ndarray:
    size = box.size * box.pose.scale
    layers = np.floor(size / spacing + EDGE_TOLERANCE)
    if np.all(np.abs(size / spacing - layers) <= EDGE_TOLERANCE) and layers.min() > 0:
        centred = [(np.arange(int(count)) - (count - 1) / 2) * spacing for count in layers]
        points = np.stack(np.meshgrid(*centred, indexing="ij"), axis=-1).reshape(-1, 3)
    else:
        points = _rows(size, spacing, number)
    return points @ box.pose.rotation.T + box.pose.position


def _rows(size: np.ndarray, spacing: float, number: int) -> np.ndarray:
    """`number` points in a box with edges `size` [m], in rows along the longest edge."""
    length, order = size / spacing, np.argsort(size, kind="stable")
    first, second, along = order
    choices = []
    for a in _steps(length[first]):
        # Layers may stand close only where the points in them stand further apart.
        even = length[second] / math.sqrt(length[second] * length[along] * a / number)
        choices += [(a, b) for b in {max(1, round(length[second])), max(1, math.floor(even)), math.ceil(even)}]

    def closest(choice: tuple[int, int]) -> float:
        a, b = choice
        return min(length[first] / a, length[second] / b, length[along] * a * b / max(number, a * b))

    # All rows have a particle, or there is but one.
    fitting = [choice for choice in choices if choice[0] * choice[1] <= number] or [(1, 1)]
    a, b = max(fitting, key=lambda choice: (round(closest(choice), 9), -choice[0], -choice[1]))
    row = _shared(number, a * b)
    inside = np.arange(number) - np.repeat(np.cumsum(row) - row, row)
    which = np.repeat(np.arange(a * b), row)
    points = np.empty((number, 3))
    points[:, first] = ((which // b + 0.5) / a - 0.5) * size[first]
    points[:, second] = ((which % b + 0.5) / b - 0.5) * size[second]
    points[:, along] = ((inside + 0.5) / row[which] - 0.5) * size[along]
    return points[np.lexsort(points.T[::-1])]


def _steps(length: float) -> range:
    """Into how many layers an edge of so many spacings may be divided."""
    return range(max(1, math.floor(length)), math.ceil(length) + 1)


def _shared(number: int, parts: int) -> np.ndarray:
    """`number` in whole parts that differ by at most one, the larger ones evenly among the smaller; shape [parts]."""
    return np.diff(np.arange(parts + 1) * number // parts)


def _fill_cylinder(cylinder: CylinderSolid, spacing: float, number: int) -> np.ndarray:
    height, radius = cylinder.height * cylinder.pose.scale, cylinder.radius * cylinder.pose.scale
    length = height / spacing

    def closest(layers: int) -> float:
        return min(length / layers, math.sqrt(layers / length))

    layers = min(max(_steps(length), key=lambda count: (round(closest(count), 9), -count)), number)
    shares = _shared(number, layers)
    step = spacing * math.sqrt(layers / length)
    discs = {int(count): _disc(radius, step, int(count)) for count in np.unique(shares)}
    levels = ((np.arange(layers) + 0.5) / layers - 0.5) * height
    points = np.concatenate([np.insert(discs[count], 1, y, axis=1) for count, y in zip(shares, levels, strict=True)])
    points = points[np.lexsort(points.T[::-1])]
    return points @ cylinder.pose.rotation.T + cylinder.pose.position


def _disc(radius: float, step: float, number: int) -> np.ndarray:
    """`number` points of a square lattice in a disc [m], shape [number, 2]."""

    def inside(shift: tuple[float, ...], step: float) -> np.ndarray:
        half = math.ceil(radius / step) + 1
        axes = [(np.arange(-half, half + 1) + part) * step for part in shift]
        points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
        return points[np.hypot(*points.T) < radius]

    points = _chosen(inside, step, number, axes=2)
    return np.delete(points, outermost(radius - np.hypot(*points.T), len(points) - number, step), axis=0)


def _fill_shape(solid: Solid, spacing: float, number: int) -> np.ndarray:
    low, high = solid.bounds

    def inside(shift: tuple[float, ...], step: float) -> np.ndarray:
        layers = np.maximum(1, np.ceil((high - low) / step - EDGE_TOLERANCE))
        check_number(float(layers.prod()), step)
        # A lattice that is moved by half a step has a layer more.
        layers += np.array(shift) > 0
        origin = (low + high) / 2 - (layers - 1) / 2 * step
        return origin + step * np.argwhere(solid.contains_lattice(origin, step, tuple(layers.astype(int))))

    points = _chosen(inside, spacing, number, axes=3)
    if len(points) == number:
        return points
    return np.delete(points, outermost(-solid.signed_distance(points), len(points) - number, spacing), axis=0)


def _chosen(inside, step: float, number: int, axes: int) -> np.ndarray:
    """The points of a lattice in a shape, `number` or few more.

    inside: the points in the shape of a lattice with a step [m], moved by 0 or 0.5 steps along each axis.
    """
    shifts = list(itertools.product((0.0, 0.5), repeat=axes))
    points = inside(shifts[0], step)
    if number <= len(points) <= (1 + UNLIKE) * number:
        return points
    found = [points, *(inside(shift, step) for shift in shifts[1:])]
    enough = [points for points in found if len(points) >= number]
    best = min(enough, key=len, default=None)
    if best is not None and len(best) <= (1 + UNLIKE) * number:
        return best
    return min((_adapted(inside, shift, step, number) for shift in shifts), key=len)


def _adapted(inside, shift: tuple[float, ...], step: float, number: int) -> np.ndarray:
    """The points of a lattice with about the longest step that puts `number` or more points in the shape."""
    short, long = step, 2 * step
    while len(points := inside(shift, short)) < number:
        long, short = short, 0.8 * short
    for _ in range(_HALVINGS):
        middle = (short + long) / 2
        tried = inside(shift, middle)
        if len(tried) >= number:
            short, points = middle, tried
        else:
            long = middle
        if len(points) == number:
            break
    return points
