"""The arrays of points, springs and hinges that kernels take."""

from __future__ import annotations

import numpy as np

from sim.cloth.fabric.layout import Drag, Hinges, MassSpring, Points, Springs
from sim.device.compiler import ti
from sim.device.double import vec3


def integers(values: np.ndarray) -> ti.Ndarray:
    """On the device, with room for one at least."""
    return filled(ti.ndarray(ti.i32, max(len(values), 1)), np.asarray(values, np.int32))


def numbers(values: np.ndarray) -> ti.Ndarray:
    """On the device in double precision, with room for one at least."""
    return filled(ti.ndarray(ti.f64, max(len(values), 1)), np.asarray(values, np.float64))


def vectors(values: np.ndarray) -> ti.Ndarray:
    """On the device in double precision, with room for one at least; `values` of shape [n, 3]."""
    return filled(ti.Vector.ndarray(3, ti.f64, max(len(values), 1)), np.asarray(values, np.float64))


def filled(array: ti.Ndarray, values: np.ndarray) -> ti.Ndarray:
    """An array with values at its beginning, and zeros behind them."""
    whole = np.zeros((array.shape[0], *values.shape[1:]), values.dtype)
    whole[: len(values)] = values
    array.from_numpy(whole)
    return array


def clear(array: ti.Ndarray) -> None:
    """Set all elements of a table of vectors to zero: its own `fill` would compile a kernel every time, and keep it."""
    array.from_numpy(np.zeros((array.shape[0], *array.element_shape)))


def incidence(members: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Where each point's entries begin, shape [count + 1], and which they are: k m + slot for `members`, shape [n, k],
    in ascending order."""
    flat = members.ravel()
    order = np.argsort(flat, kind="stable")
    return np.searchsorted(flat[order], np.arange(count + 1)), order


def point_arrays(position: np.ndarray, velocity: np.ndarray, mass: np.ndarray, held: np.ndarray) -> Points:
    """`held`: whether a point goes where its pin takes it."""
    return Points(
        position=vectors(position),
        velocity=vectors(velocity),
        mass=numbers(mass),
        mobile=integers(~held),
    )


def spring_arrays(
    springs: np.ndarray, rest: np.ndarray, stiffness: np.ndarray, damping: np.ndarray, count: int
) -> Springs:
    """springs: both ends, shape [n, 2]; lengths at rest [m], stiffness [N/m], damping [N s/m]; count: of points."""
    first, entry = incidence(springs, count)
    return Springs(
        spring_ends=integers(springs.ravel()),
        rest_length=numbers(rest),
        spring_stiffness=numbers(stiffness),
        spring_damping=numbers(damping),
        first_spring=integers(first),
        of_spring=integers(entry),
    )


def hinge_arrays(hinges: np.ndarray, rest: np.ndarray, rigidity: np.ndarray, damping: np.ndarray, count: int) -> Hinges:
    """hinges: four points, shape [n, 4]; angles at rest [rad], rigidity [N m], damping [N m s]; count: of points."""
    first, entry = incidence(hinges, count)
    return Hinges(
        hinge_points=integers(hinges.ravel()),
        rest_angle=numbers(rest),
        rigidity=numbers(rigidity),
        bend_damping=numbers(damping),
        first_hinge=integers(first),
        of_hinge=integers(entry),
    )


def mass_spring(
    points: Points,
    springs: Springs,
    hinges: Hinges,
    drag: Drag,
    counts: tuple[int, int, int],
    gravity: np.ndarray,
    wind: vec3,
) -> MassSpring:
    """All of a cloth in one, of the same arrays; counts: of points, springs and hinges; gravity [m/s^2]; wind [m/s]."""
    parts = dict(zip(("point_count", "spring_count", "hinge_count"), counts, strict=True))
    members = {name: values for pack in (points, springs, hinges, drag) for name, values in pack.items}
    return MassSpring(**parts, gravity=vec3(*gravity), wind=wind, **members)


def matrices(count: int) -> ti.Ndarray:
    """Zeros of shape [3, 3] each, on the device in double precision, with room for one at least."""
    array = ti.Matrix.ndarray(3, 3, ti.f64, max(count, 1))
    array.fill(0.0)
    return array
