"""Reading what a run has written, with a library of its own: plyfile."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from plyfile import PlyData


def read_frame(folder: Path, frame: int) -> np.ndarray:
    """The records of `fluid_FRAME.ply`: fields x y z vx vy vz density id."""
    return PlyData.read(folder / f"fluid_{frame:05d}.ply")["vertex"].data


def positions(points: np.ndarray) -> np.ndarray:
    """Coordinates [m] in double precision, shape [n, 3]."""
    return np.column_stack([points[axis] for axis in "xyz"]).astype(np.float64)


def velocities(points: np.ndarray) -> np.ndarray:
    """[m/s] in double precision, shape [n, 3]."""
    return np.column_stack([points[f"v{axis}"] for axis in "xyz"]).astype(np.float64)


def read_table(path: Path) -> np.ndarray:
    """A CSV table as a record array; empty fields are nan."""
    return np.genfromtxt(path, delimiter=",", names=True, dtype=None, encoding="utf-8")
