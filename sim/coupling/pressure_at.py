"""The pressure of the fluid at a point, as probes ask for it."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from sim.fluid.kernel import cubic_host
from sim.fluid.system import FluidSystem

MATERIALS = ("fluid",)
"""Of a scene, for this to be loaded."""

FEWEST = 8
"""Particles that a linear field is fitted to."""
FLATTEST = 0.02
"""Of the second moments of their places, the least over the greatest."""


class View(Protocol):
    """Particles on the host, in world coordinates: support radius [m], mass [kg], points [m], shape [n, 3], densities
    [kg/m^3] and pressures [Pa], shape [n]."""

    h: float
    mass: float

    @property
    def points(self) -> np.ndarray: ...

    @property
    def density(self) -> np.ndarray: ...

    @property
    def pressure(self) -> np.ndarray: ...


def pressure_at(view: View, system: FluidSystem, origin: np.ndarray, at: np.ndarray) -> float:
    """Pressure [Pa] at a point `at` [m], shape [3], in a system whose coordinates start at `origin` [m]: of the linear
    field that fits those of the particles around best (moving least squares, Lancaster & Salkauskas 1981); 0 in air.

    It is right next to a solid, too, where there are particles on one side only. What is behind the solid does not
    count; few particles, or such that lie in a plane, give their mean (Shepard 1968).
    """
    away = view.points - at
    near = np.linalg.norm(away, axis=1) < view.h
    if near.any() and system.boundary.shapes.count:
        faces = system.boundary.around(at[None] - origin)
        listed = slice(faces.begin.to_numpy()[0], faces.begin.to_numpy()[0] + faces.size.to_numpy()[0])
        found = faces.face.to_numpy()[listed].astype(np.float64)
        near &= np.all(away @ found[:, :3].T + found[:, 3] > 0, axis=1)
    away, pressure = away[near], view.pressure[near]
    weight = cubic_host(np.linalg.norm(away, axis=1), view.h) * view.mass / np.maximum(view.density[near], 1)
    total = weight.sum()
    if total <= 0:
        return 0.0
    mean, centre = weight @ pressure / total, weight @ away / total
    spread = (away - centre).T @ (weight[:, None] * (away - centre)) / total
    moments = np.linalg.eigvalsh(spread)
    if len(away) < FEWEST or moments[0] < FLATTEST * moments[-1]:
        return float(mean)
    slope = np.linalg.solve(spread, (away - centre).T @ (weight * (pressure - mean)) / total)
    return max(0.0, float(mean - slope @ centre))
