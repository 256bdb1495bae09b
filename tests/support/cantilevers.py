"""Heavy strips of cloth that are clamped at one end, against the elastica."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from tests.support.cloths import G, part, places, step
from tests.support.triangulations import triangulated, with_clamp, write

STATIC = {"implicit_euler": {"velocity_error": 1e-6, "linear_error": 1e-3, "max_newton": 200}}
"""With steps of seconds, implicit Euler finds equilibria as Newton's method would."""


def elastica(load: float) -> tuple[float, float]:
    """Drop and reach of a heavy cantilever over its length, load = w L^3 / B: B t'' = -w (L - s) cos t."""
    from scipy.integrate import cumulative_trapezoid, solve_bvp

    s = np.linspace(0, 1, 400)
    found = solve_bvp(
        lambda s, y: [y[1], -load * (1 - s) * np.cos(y[0])],
        lambda a, b: [a[0], b[1]],
        s,
        np.array([load * s / 6, load / 6 * (1 - s)]),
        tol=1e-8,
        max_nodes=20_000,
    )
    angle = found.sol(s)[0]
    return tuple(float(cumulative_trapezoid(f(angle), s)[-1]) for f in (np.sin, np.cos))


def cantilever(
    kind: str,
    folder: Path,
    load: float,
    cells: int,
    *,
    model: str = "fem",
    width: float = 0.3,
    weight: float = 0.2,
    **settings: Any,
) -> tuple[float, float]:
    """Drop and reach over the closed form, of a strip of 1 m that is clamped half a cell before its beginning."""
    edge = 1.0 / cells
    points, triangles = with_clamp(*triangulated(kind, 1.0, width, cells), edge)
    held = [[x, 0, z] for x, z in points[points[:, 0] < 1e-9]]
    file = str(write(points, triangles, folder / "strip.ply"))
    stiff = {"stretch_stiffness": 1e3, "bend_stiffness": weight * G / load, **settings}
    strip = {"shape": {"type": "mesh", "file": file}, "pins": [{"at": held}], "mass_per_area": weight, **stiff}
    made = part({"strip": strip | {"thickness": 1e-4}}, model=model, **STATIC)
    step(made, 9.0, 0.3)
    x, rest = places(made), made.sheets[0].fabric.points
    tip = rest[:, 0] > 1 - 1e-9
    length = 1 + edge / 2
    drop, reach = elastica(load * length**3)
    return -x[tip, 1].mean() / (drop * length), x[tip, 0].mean() / (reach * length - edge / 2)
