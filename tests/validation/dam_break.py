"""The dam break of Martin & Moyce (1952): a square-based column of water, twice as high as wide, that collapses.

Their channel was 2.25 inch deep in the third direction; here a thin slab of it between two planes stands for it.
Front and height are read from particles: the front is the end of the farthest slab of one spacing that holds at least
half of one layer of particles, so that neither a lone drop nor the film ahead of it counts.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from tests.particles import positions, read_frame

A = 0.05715
"""Width of the column [m]: 2.25 inch."""
G = 9.81
DEPTH = 6
"""Thickness of the slab, in particles."""
FPS = 250.0
FRONT_UNIT = np.sqrt(A / (2 * G))
"""The time T = 1 [s] of the front's table."""
HEIGHT_UNIT = np.sqrt(A / G)
"""The time tau = 1 [s] of the height's table."""
LAST = int(np.ceil(3.44 * HEIGHT_UNIT * FPS))
"""The frame at the end of both tables."""


def reference(name: str) -> tuple[np.ndarray, np.ndarray]:
    """The measured times and values of `front` or `height`."""
    path = Path(__file__).parent / "reference" / f"martin_moyce_{name}.csv"
    table = np.genfromtxt(path, delimiter=",", skip_header=2)
    return table[:, 0], table[:, 1]


def scene(solver: str, across: int, **fluid: Any) -> dict[str, Any]:
    """The column `across` particles wide, in a channel too long for the front to reach its end."""
    spacing = A / across
    depth = DEPTH * spacing
    return {
        "fps": FPS,
        "gravity": [0, -G, 0],
        "containers": {
            "channel": {
                "type": "box",
                "size": [8 * A, 3 * A, depth],
                "position": [4 * A, 0, 0],
                "open": ["top", "right"],
            }
        },
        "fluid": {
            "solver": solver,
            "particle_radius": spacing / 2,
            "bodies": {"column": {"shape": {"type": "box", "size": [A, 2 * A, depth]}, "position": [A / 2, A, 0]}},
            **fluid,
        },
    }


def front(x: np.ndarray, spacing: float, fill: float = 0.5) -> float:
    """End [m] of the farthest slab of one spacing that is at least `fill` of one layer full."""
    number = np.bincount(np.maximum(x[:, 0] // spacing, 0).astype(int))
    return float(np.flatnonzero(number >= fill * DEPTH).max() + 1) * spacing


def height(x: np.ndarray, spacing: float) -> float:
    """The same upwards [m], at the wall that the column leans on: in the two layers next to it."""
    number = np.bincount(np.maximum(x[x[:, 0] < 2 * spacing, 1] // spacing, 0).astype(int))
    return float(np.flatnonzero(number >= DEPTH).max() + 1) * spacing


def curves(out: Path, across: int, last: int = LAST) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times [s], Z and H of a run."""
    spacing = A / across
    frames = [positions(read_frame(out, frame)) for frame in range(last + 1)]
    times = np.arange(last + 1) / FPS
    return (
        times,
        np.array([front(x, spacing) for x in frames]) / A,
        np.array([height(x, spacing) for x in frames]) / (2 * A),
    )


def deviation(times: np.ndarray, values: np.ndarray, name: str, unit: float) -> float:
    """RMS of the relative difference to the measured values, at their own times and without a shift."""
    moments, measured = reference(name)
    return float(np.sqrt(np.mean((np.interp(moments * unit, times, values) / measured - 1) ** 2)))
