"""Friction of the fluid along solids at rest that it sticks to (no slip).

A plane wall continues the fluid with the velocity that vanishes on its surface, at distance y' beyond it -(y'/y) v
for a particle at distance y with velocity v (Morris, Fox & Zhu 1997, sec. 3.5). The sum over pairs of
`sim.fluid.forces` becomes an integral over the half-space, which depends on y alone:
    a = nu [T(y) v_t + N(y) v_n],   for the velocity v_t along and v_n towards the wall, with
    T = k pi / (4 y) int_y^h W'(r) (r^2 - y^2)^2 / (r^2 + 0.01 h^2) dr,
    N = k pi / (2 y) int_y^h W'(r) (r^4 - y^4) / (r^2 + 0.01 h^2) dr,
k the factor of the pairs.
"""

from dataclasses import dataclass

import numpy as np
import taichi as ti

from sim.arrays import Vec4Array, real, vec3
from sim.fluid.calibration import sample_depth, sample_volume, sample_weight
from sim.fluid.forces import SOFTENING, VISCOUS, viscous
from sim.fluid.kernel import cubic_slope, cubic_slope_host
from sim.fluid.spec import Fluid

NEAREST = 0.5
"""A wall slows particles nearer than this many spacings no more than those: a layer at rest is as near."""


def friction_host(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """T h^2 and N h^2 at distances q h > 0 from a wall, by quadrature; both are negative."""
    along, across = [], []
    for y in np.atleast_1d(q):
        r = y + (np.arange(2000) + 0.5) * (1.0 - y) / 2000
        weight = cubic_slope_host(r, 1.0) * r / (r * r + SOFTENING) * (1.0 - y) / 2000
        along.append(VISCOUS / 4 * np.pi / y * float((weight * (r * r - y * y) ** 2).sum()))
        across.append(VISCOUS / 2 * np.pi / y * float((weight * (r**4 - y**4)).sum()))
    return np.array(along), np.array(across)


def _fit() -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Polynomials of q, highest power first: q T h^2 over (1 - q)^5 and q N h^2 over (1 - q)^4."""
    q = (np.arange(200) + 0.5) / 200
    along, across = friction_host(q)
    far = 1.0 - q
    return (
        tuple(np.polyfit(q, q * along / far**5, 5, w=far**5).tolist()),
        tuple(np.polyfit(q, q * across / far**4, 5, w=far**4).tolist()),
    )


ALONG, ACROSS = _fit()


@ti.func
def wall_grip(distance: real, spacing: real, inverse_h: real) -> ti.types.vector(2, real):
    """T and N [1/m^2] at this distance [m] from a wall."""
    q = ti.math.clamp(distance, NEAREST * spacing, 1.0 / inverse_h) * inverse_h
    far = 1.0 - q
    along, across = ti.cast(0.0, real), ti.cast(0.0, real)
    for c in ti.static(ALONG):
        along = along * q + c
    for c in ti.static(ACROSS):
        across = across * q + c
    far4 = far * far * far * far
    return ti.Vector([along * far, across]) * far4 / q * inverse_h * inverse_h


@ti.func
def wall_friction(
    x: vec3, v: vec3, count: ti.i32, planes: Vec4Array, setback: real, spacing: real, inverse_h: real
) -> vec3:
    """sum over the walls of T v_t + N v_n [1/(m s)]: the acceleration is this times the viscosity.

    planes, setback: as `sim.fluid.walls.Walls` holds them, which moves them for the sake of the pressure.
    """
    a = vec3(0.0)
    for k in range(count):
        n = planes[k].xyz
        grip = wall_grip(n.dot(x) - planes[k].w - setback, spacing, inverse_h)
        a += grip.x * v + (grip.y - grip.x) * n.dot(v) * n
    return a


@ti.func
def wall_friction_diagonal(
    x: vec3, count: ti.i32, planes: Vec4Array, setback: real, spacing: real, inverse_h: real
) -> vec3:
    """The derivatives of `wall_friction` by each component of the velocity [1/m^2]."""
    a = vec3(0.0)
    for k in range(count):
        n = planes[k].xyz
        grip = wall_grip(n.dot(x) - planes[k].w - setback, spacing, inverse_h)
        a += grip.x + (grip.y - grip.x) * n * n
    return a


@ti.func
def sample_friction(d: vec3, v: vec3, nearest: real, inverse_h: real) -> vec3:
    """Friction of a pair with a boundary sample, to multiply the sample's volume, its viscosity and the kernel's norm.

    Along the line of the pair, so that angular momentum is kept; no stronger than at `nearest` h.
    """
    q = ti.max(d.norm() * inverse_h, nearest)
    return viscous(v.dot(d), 1.0) * cubic_slope(q) / (q * q + SOFTENING) * inverse_h * inverse_h * d


def sample_friction_host(r: np.ndarray, approach: np.ndarray, nearest: float, h: float) -> np.ndarray:
    """`sample_friction` with the kernel's norm, over the pairs' vectors d [1/(m^3 s)]; r = |d| [m], approach = v.d."""
    r = np.maximum(r, nearest * h)
    return VISCOUS * approach * cubic_slope_host(r, h) / (r * r + SOFTENING * h * h)


@dataclass(frozen=True)
class Grip:
    """How solids slow the fluid: viscosities [m^2/s] against walls and boundary samples, and the distance over h
    nearer than which samples slow it no more."""

    walls: float
    samples: float
    nearest: float


def find_grip(spec: Fluid) -> Grip:
    """What the settings ask for; nothing with free slip.

    Samples are fewer and lie deeper than a half-space's volume. Their viscosity makes them slow a layer at rest as
    much as a plane wall does, in the mean of the three directions: less along the surface, more towards it.
    """
    spacing, h = spec.spacing, spec.support_radius
    rest = sample_depth(spacing, h) / h + 0.5 * spacing / h
    if spec.wall_slip == "free_slip":
        return Grip(0.0, 0.0, rest)
    r = rest + (np.arange(2000) + 0.5) * (1.0 - rest) / 2000
    area = spacing * spacing / h**2
    # Integral of the pair's trace over a plane with one sample on each square of the spacing.
    pairs = (
        2.0
        * VISCOUS
        * np.pi
        * (cubic_slope_host(r, 1.0) / (r * r + SOFTENING) * r**3).sum()
        * (1.0 - rest)
        / 2000
        / area
    )
    along, across = friction_host(0.5 * spacing / h)
    factor = (2.0 * along[0] + across[0]) / (pairs * sample_weight(spacing, h) * sample_volume(spacing, h) / h**3)
    return Grip(spec.viscosity, spec.viscosity * float(factor), rest)
