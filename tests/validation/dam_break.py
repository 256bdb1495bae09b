"""The dam break of Martin & Moyce (1952): a square-based column of water, twice as high as wide, that collapses.

Their channel was 2.25 inch deep in the third direction; here a thin slab of it between two planes stands for it.
Front and height are read from particles: the front is the end of the farthest slab of one spacing that holds at least
half of one layer of particles, so that neither a lone drop nor the film ahead of it counts; the height is where rows
of one spacing are half full, over the half of the column's width next to the wall.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tests.support.particles import positions, read_frame

A = 0.05715
"""Width of the column [m]: 2.25 inch."""
G = 9.81
DEPTH = 6
"""Thickness of the slab, in particles: the least even number of layers of which some, the two in the middle, are
farther from both planes than the support radius and see none. With 12 layers the front differs by less than 1 %."""
FPS = 250.0
FRONT_UNIT = np.sqrt(A / (2 * G))
"""The time T = 1 [s] of the front's table."""
HEIGHT_UNIT = np.sqrt(A / G)
"""The time tau = 1 [s] of the height's table."""
LAST = int(np.ceil(3.44 * HEIGHT_UNIT * FPS))
"""The frame at the end of both tables."""
HERE = Path(__file__).parent
FILES = {
    "front": HERE.parents[1] / "scenes" / "studies" / "reference" / "martin_moyce_front.csv",
    "height": HERE / "reference" / "martin_moyce_height.csv",
    "koshizuka_oka": HERE / "reference" / "koshizuka_oka_front.csv",
}


def reference(name: str) -> tuple[np.ndarray, np.ndarray]:
    """The measured times and values of `front` or `height`, or those of the front by `koshizuka_oka`."""
    table = np.genfromtxt(FILES[name], delimiter=",", skip_header=2)
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


def farthest(x: np.ndarray, spacing: float) -> float:
    """Where the farthest particle ends [m], drops and all."""
    return float(x[:, 0].max()) + spacing / 2


def height(x: np.ndarray, spacing: float) -> float:
    """Where rows of one spacing, over half of the column's width, are half full [m]: on the line from the highest that
    is as full to the next. A whole row is a fifth of the last height, and a few particles would decide which it is."""
    across = round(A / 2 / spacing)
    number = np.bincount(np.maximum(x[x[:, 0] < across * spacing, 1] // spacing, 0).astype(int))
    half, number = 0.5 * across * DEPTH, np.append(number, 0)
    top = np.flatnonzero(number >= half).max()
    return float(top + 0.5 + (number[top] - half) / (number[top] - number[top + 1])) * spacing


@dataclass(frozen=True)
class Curves:
    """What a run shows: times [s]; front and farthest particle over A; height over 2 A."""

    times: np.ndarray
    front: np.ndarray
    farthest: np.ndarray
    height: np.ndarray


def curves(out: Path, across: int, last: int = LAST) -> Curves:
    """Read from the frames of a run."""
    spacing = A / across
    frames = [positions(read_frame(out, frame)) for frame in range(last + 1)]
    return Curves(
        np.arange(last + 1) / FPS,
        np.array([front(x, spacing) for x in frames]) / A,
        np.array([farthest(x, spacing) for x in frames]) / A,
        np.array([height(x, spacing) for x in frames]) / (2 * A),
    )


def deviation(times: np.ndarray, values: np.ndarray, name: str, unit: float, shift: float = 0.0) -> float:
    """RMS of the relative difference to the measured values, at their own times less `shift`, in units of theirs."""
    moments, measured = reference(name)
    found = np.interp((moments - shift) * unit, times, values)
    return float(np.sqrt(np.mean((found / measured - 1) ** 2)))


def best_shift(times: np.ndarray, values: np.ndarray, name: str, unit: float) -> tuple[float, float]:
    """How much later than the simulation the experiment runs, in units of its time, and the deviation then."""
    shifts = np.linspace(-0.5, 0.5, 201)
    found = [deviation(times, values, name, unit, shift) for shift in shifts]
    return float(shifts[np.argmin(found)]), min(found)


def speed(moments: np.ndarray, values: np.ndarray) -> float:
    """dZ/dT of a straight line through the front's values from T = 1.43 on, where it runs evenly."""
    late = moments >= 1.43
    return float(np.polyfit(moments[late], values[late], 1)[0])
