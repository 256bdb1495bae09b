"""From the simulation's axes (y up) to Blender's (z up): (x, y, z) -> (x, -z, y)."""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from typing import Any

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


def triple(numbers: Iterable[float]) -> Vector:
    """Three numbers as a vector."""
    x, y, z = numbers
    return (x, y, z)


def z_up(vector: Sequence[float]) -> Vector:
    """Position, direction, velocity or angular velocity."""
    x, y, z = vector
    return (x, -z, y)


def z_up_quaternion(quaternion: Sequence[float]) -> Quaternion:
    """Rotation (w, x, y, z) of a body whose own mesh is turned to z up as well."""
    w, x, y, z = quaternion
    return (w, x, -z, y)


def z_up_columns(x: Any, y: Any, z: Any) -> Any:
    """Columns of n numbers (NumPy or `array`) to one flat buffer of n triples [3 n], float32."""
    if isinstance(x, array):
        flat = array("f", bytes(12 * len(x)))
        flat[0::3] = array("f", x)
        flat[1::3] = array("f", (-value for value in z))
        flat[2::3] = array("f", y)
        return flat
    import numpy as np

    return np.stack([x, -z, y], axis=1).astype(np.float32).ravel()
