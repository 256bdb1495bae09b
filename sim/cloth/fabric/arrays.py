"""The arrays of points, springs and hinges that kernels take."""

from __future__ import annotations

import numpy as np
import taichi as ti

from sim.cloth.fabric.layout import Angles, Points, Strands


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
    """`held`: whether a point goes where its pin leads it."""
    return Points(
        position=vectors(position),
        velocity=vectors(velocity),
        mass=numbers(mass),
        mobile=integers(~held),
    )


def strand_arrays(
    springs: np.ndarray, rest: np.ndarray, stiffness: np.ndarray, damping: np.ndarray, count: int
) -> Strands:
    """springs: both ends, shape [n, 2]; lengths at rest [m], stiffness [N/m], damping [N s/m]; count: of points."""
    first, entry = incidence(springs, count)
    return Strands(
        ends=integers(springs.ravel()),
        rest=numbers(rest),
        stiff=numbers(stiffness),
        damp=numbers(damping),
        first_spring=integers(first),
        of_spring=integers(entry),
    )


def angle_arrays(hinges: np.ndarray, rest: np.ndarray, rigidity: np.ndarray, damping: np.ndarray, count: int) -> Angles:
    """hinges: four points, shape [n, 4]; angles at rest [rad], rigidity [N m], damping [N m s]; count: of points."""
    first, entry = incidence(hinges, count)
    return Angles(
        corners=integers(hinges.ravel()),
        rest_angle=numbers(rest),
        rigid=numbers(rigidity),
        bend_damp=numbers(damping),
        first_hinge=integers(first),
        of_hinge=integers(entry),
    )


def matrices(count: int) -> ti.Ndarray:
    """Zeros of shape [3, 3] each, on the device in double precision, with room for one at least."""
    array = ti.Matrix.ndarray(3, 3, ti.f64, max(count, 1))
    array.fill(0.0)
    return array
