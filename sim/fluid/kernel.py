"""The cubic spline kernel, and its integrals over a half-space.

W(r) = 8 / (pi h^3) * (1 - 6 q^2 + 6 q^3) for q = r / h < 1/2, 2 (1 - q)^3 up to q = 1, 0 beyond
(Monaghan 1992, written for the support radius h).
"""

import math

import numpy as np

from sim.device.arrays import real
from sim.device.compiler import ti

SIGMA = 8.0 / math.pi
"""W h^3 is this times the spline, in three dimensions."""


@ti.func
def cubic_norm(inverse_h: real) -> real:
    """What `cubic` is multiplied by to be W [1/m^3]."""
    return SIGMA * inverse_h * inverse_h * inverse_h


@ti.func
def slope_norm(inverse_h: real) -> real:
    """What `cubic_slope` is multiplied by [1/m^5]."""
    return SIGMA * inverse_h**5


@ti.func
def cubic(q: real) -> real:
    """W h^3 pi / 8 at q = r / h."""
    rest = ti.max(1.0 - q, 0.0)
    return ti.select(q < 0.5, 1.0 - 6.0 * q * q * rest, 2.0 * rest * rest * rest)


@ti.func
def cubic_slope(q: real) -> real:
    """(dW/dr) / r * h^5 pi / 8: the gradient is this times the vector r.

    Both pieces are computed and one is chosen, so that loops over neighbours run in vectors.
    """
    rest = ti.max(1.0 - q, 0.0)
    return ti.select(q < 0.5, 18.0 * q - 12.0, -6.0 * rest * rest / q)


@ti.func
def halfspace_area(q: real) -> real:
    """Integral of W over the plane at distance q h, times h: what the density loses on the way out."""
    s = ti.min(ti.abs(q), 1.0)
    u = 1.0 - s
    near = 1.4 + s * s * (-8.0 + s * s * (24.0 - 19.2 * s))
    far = u * u * u * u * (8.0 - 6.4 * u)
    return ti.select(s < 0.5, near, far)


@ti.func
def halfspace_volume(q: real) -> real:
    """Integral of W over the half-space beyond a plane at signed distance q h: 1 deep inside, 0 far out."""
    s = ti.min(ti.abs(q), 1.0)
    u = 1.0 - s
    near = 0.5 - s * (1.4 + s * s * (-8.0 / 3.0 + s * s * (4.8 - 3.2 * s)))
    far = u * u * u * u * u * (1.6 - 16.0 / 15.0 * u)
    volume = ti.select(s < 0.5, near, far)
    return ti.select(q < 0.0, 1.0 - volume, volume)


def cubic_host(r: float | np.ndarray, h: float) -> np.ndarray:
    """W(r) [1/m^3] on the host, in double precision."""
    q = np.asarray(r, dtype=float) / h
    rest = np.clip(1.0 - q, 0.0, None)
    return 8.0 / (math.pi * h**3) * np.where(q < 0.5, 1.0 - 6.0 * q * q * rest, 2.0 * rest**3)


def cubic_slope_host(r: np.ndarray, h: float) -> np.ndarray:
    """(dW/dr) / r [1/m^5] on the host, in double precision."""
    q = np.asarray(r, dtype=float) / h
    rest = np.clip(1.0 - q, 0.0, None)
    return 8.0 / (math.pi * h**5) * np.where(q < 0.5, 18.0 * q - 12.0, -6.0 * rest**2 / np.maximum(q, 0.5))


def halfspace_area_host(q: float | np.ndarray) -> np.ndarray:
    """`halfspace_area` on the host, in double precision."""
    s = np.minimum(np.abs(q), 1.0)
    near = 1.4 + s * s * (-8.0 + s * s * (24.0 - 19.2 * s))
    return np.where(s < 0.5, near, (1.0 - s) ** 4 * (8.0 - 6.4 * (1.0 - s)))


def halfspace_volume_host(q: float | np.ndarray) -> np.ndarray:
    """`halfspace_volume` on the host, in double precision."""
    s = np.minimum(np.abs(q), 1.0)
    near = 0.5 - s * (1.4 + s * s * (-8.0 / 3.0 + s * s * (4.8 - 3.2 * s)))
    volume = np.where(s < 0.5, near, (1.0 - s) ** 5 * (1.6 - 16.0 / 15.0 * (1.0 - s)))
    return np.where(np.asarray(q) < 0, 1.0 - volume, volume)


def lattice(spacing: float, h: float) -> np.ndarray:
    """Points of the cubic lattice around one of its points that lie in the support, shape [n, 3]."""
    reach = math.ceil(h / spacing)
    axis = np.arange(-reach, reach + 1) * spacing
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    return points[np.linalg.norm(points, axis=1) < h]


def particle_mass(spacing: float, h: float, rest_density: float) -> float:
    """Mass [kg] with which the cubic lattice has the rest density."""
    return rest_density / float(cubic_host(np.linalg.norm(lattice(spacing, h), axis=1), h).sum())
