"""Friction of the fluid along solids that it sticks to (no slip).

A plane wall continues the fluid with the velocity that vanishes on its surface, at distance y' beyond it -(y'/y) v
for a particle at distance y with velocity v (Morris et al. 1997, sec. 3.5). The sum over pairs of
`sim.fluid.forces.pairwise` becomes an integral over the half-space, which depends on y alone:
    a = nu [T(y) v_t + N(y) v_n],   for the velocity v_t along and v_n towards the wall, with
    T = HOLD k pi / (4 y) int_y^h W'(r) (r^2 - y^2)^2 / (r^2 + 0.01 h^2) dr,
    N = HOLD k pi / (2 y) int_y^h W'(r) (r^4 - y^4) / (r^2 + 0.01 h^2) dr,
k the factor of the pairs.
"""

from dataclasses import dataclass

import numpy as np

from sim.device.arrays import mat3, real, vec3, vec4
from sim.device.compiler import ti
from sim.fluid.boundary.calibration import sample_depth, sample_volume, sample_weight
from sim.fluid.forces.pairwise import SOFTENING, VISCOUS, viscous
from sim.fluid.kernel import cubic_slope, cubic_slope_host
from sim.fluid.layout import DISTANCE
from sim.fluid.spec import Fluid

HOLD = 1.1
"""What a wall holds over what the integral says. The fluid next to a wall lies in layers, whose pull on one another
is more than that of a fluid without order: with this factor a flow does not slip, without it by 0.04 spacings."""
NEAREST = 0.3
"""A wall slows particles nearer than this many spacings no more than those: few of a fluid in disorder are nearer."""
UNEVEN = 1.5
"""Samples slow a particle at most this many times as much as they do a layer at rest, in the mean over it."""


def friction_host(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """T h^2 and N h^2 at distances q h > 0 from a wall, by quadrature; both are negative."""
    along, across = [], []
    for y in np.atleast_1d(q):
        r = y + (np.arange(2000) + 0.5) * (1.0 - y) / 2000
        weight = cubic_slope_host(r, 1.0) * r / (r * r + SOFTENING) * (1.0 - y) / 2000
        along.append(HOLD * VISCOUS / 4 * np.pi / y * float((weight * (r * r - y * y) ** 2).sum()))
        across.append(HOLD * VISCOUS / 2 * np.pi / y * float((weight * (r**4 - y**4)).sum()))
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
def wall_coefficients(distance: real, spacing: real, inverse_h: real) -> ti.types.vector(2, real):
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
def face_friction(face: vec4, v: vec3, spacing: real, inverse_h: real) -> vec3:
    """T v_t + N v_n [1/(m s)] beside one half-space, with unit normal and distance [m] in `face`, that fluid passes at
    the velocity v: the acceleration is this times the viscosity."""
    t, n = wall_coefficients(face[DISTANCE], spacing, inverse_h)
    return t * v + (n - t) * face.xyz.dot(v) * face.xyz


@ti.func
def face_friction_block(face: vec4, spacing: real, inverse_h: real) -> mat3:
    """The derivatives of `face_friction` by the velocity [1/m^2]."""
    t, n = wall_coefficients(face[DISTANCE], spacing, inverse_h)
    return t * ti.Matrix.identity(real, 3) + (n - t) * face.xyz.outer_product(face.xyz)


@ti.func
def sample_friction(d: vec3, v: vec3, nearest: real, inverse_h: real) -> vec3:
    """Friction of a pair with a boundary sample, to multiply the sample's volume, its viscosity and the kernel's norm.

    Along the line of the pair, so that angular momentum is kept; no stronger than at `nearest` h.
    """
    q = ti.max(d.norm() * inverse_h, nearest)
    return viscous(v.dot(d), 1.0) * cubic_slope(q) / (q * q + SOFTENING) * inverse_h * inverse_h * d


@dataclass(frozen=True)
class WallFriction:
    """How solids slow the fluid: viscosities [m^2/s] against solids and samples of sheets, and the distance over h
    nearer than which samples slow it no more. `strongest`: h^2 times the greatest rate at which one of them slows a
    particle [m^2/s]."""

    walls: float
    samples: float
    nearest: float
    strongest: float


FREE_SLIP = WallFriction(0.0, 0.0, 1.0, 0.0)


def find_wall_friction(spec: Fluid) -> WallFriction:
    """What the settings ask for; nothing with free slip.

    Samples are fewer and lie deeper than a half-space's volume. Their viscosity makes them slow a layer at rest along
    the surface as much as a plane wall does. Towards the surface, where pairs point, it is some four times as much.
    """
    spacing, h = spec.spacing, spec.support_radius
    rest = sample_depth(spacing, h) / h + 0.5 * spacing / h
    if spec.wall_slip == "free_slip":
        return FREE_SLIP
    r = rest + (np.arange(2000) + 0.5) * (1.0 - rest) / 2000
    # Integrals of the pair's force over a plane with one sample on each square of the spacing.
    weight = VISCOUS * np.pi * cubic_slope_host(r, 1.0) * r / (r * r + SOFTENING) * (1.0 - rest) / 2000
    weight *= sample_weight(spacing, h) * sample_volume(spacing, h) / (h * spacing**2)
    pairs_along, pairs_across = float((weight * (r * r - rest * rest)).sum()), float((2 * weight).sum()) * rest**2
    along, across = friction_host(np.array([0.5, NEAREST]) * spacing / h)
    factor = along[0] / pairs_along
    strongest = max(-across[1], -UNEVEN * factor * pairs_across)
    return WallFriction(spec.viscosity, spec.viscosity * factor, rest, spec.viscosity * strongest)
