"""Pairwise forces that every pressure solver shares, written for one pair."""

import math
from typing import Any

import numpy as np

from sim.device.argument_packs import argpack
from sim.device.arrays import Vec4Array, mat3, real, vec3, vec4
from sim.device.compiler import ti
from sim.fluid.kernel import cubic_host, cubic_slope, cubic_slope_host
from sim.fluid.layout import Q
from sim.neighbors.spatial_hash import padded

Lens: Any = argpack(correction=Vec4Array, skew=Vec4Array)
"""Symmetric matrices L of particles: xx, yy, zz, and xy, xz, yz (`sim.fluid.pressure.gradient_correction`)."""

SOFTENING = 0.01
"""Added to the square of a pair's distance over h, so that pairs that meet are not torn apart."""


def _viscous_factor() -> float:
    """2 (dim + 2), and what the softening takes off (3.6 %): with it the integral over the kernel is nu."""
    r = (np.arange(20_000) + 0.5) / 20_000
    weight = cubic_slope_host(r, 1.0) * r**4
    return 10.0 * float(weight.sum() / (weight * r * r / (r * r + SOFTENING)).sum())


VISCOUS = _viscous_factor()


@ti.func
def pressure_sum(i: ti.i32, position: Vec4Array, near: ti.template(), inverse_h: real) -> vec3:
    """-sum_j (q_i + q_j) grad W_ij over the kernel's norm and its h^2, with q = p / rho^2 in position.w."""
    x = position[i]
    a = vec3(0.0)
    for k in range(padded(near.size[i])):
        xj = position[near.index[near.begin[i] + k]]
        d = x.xyz - xj.xyz
        a -= (x[Q] + xj[Q]) * cubic_slope(d.norm() * inverse_h) * d  # Monaghan 1992, eq. 3.3
    return a


@ti.func
def matrix(diagonal: vec4, skew: vec4) -> mat3:
    """A symmetric matrix by its elements: xx, yy, zz, and xy, xz, yz."""
    return mat3(
        [[diagonal.x, skew.x, skew.y], [skew.x, diagonal.y, skew.z], [skew.y, skew.z, diagonal.z]],
    )


@ti.func
def pair_pressures(
    i: ti.i32,
    position: Vec4Array,
    corrected: ti.template(),
    lens: ti.template(),
    near: ti.template(),
    inverse_h: real,
) -> vec3:
    """-sum_j (q_i L_i + q_j L_j) grad W_ij over the kernel's norm and its h^2, with q in position.w; where it is not
    `corrected`, L is the unit matrix, and `lens` is not read."""
    a = vec3(0.0)
    if ti.static(corrected):
        x = position[i]
        mine = x[Q] * matrix(lens.correction[i], lens.skew[i])
        for k in range(padded(near.size[i])):
            j = near.index[near.begin[i] + k]
            xj = position[j]
            d = x.xyz - xj.xyz
            a -= cubic_slope(d.norm() * inverse_h) * ((mine + xj[Q] * matrix(lens.correction[j], lens.skew[j])) @ d)
    else:
        a = pressure_sum(i, position, near, inverse_h)
    return a


@ti.func
def viscous(approach: real, nu: real) -> real:
    """Friction of a pair, over (x^2 + 0.01 h^2): 2 (dim + 2) nu (v.x), to multiply the volume and the gradient of the
    neighbour.

    The Laplacian of Brookshaw 1985 in the form of Monaghan 2005 that conserves momentum;
    approach = v_ij . x_ij [m^2/s].
    """
    return VISCOUS * nu * approach


@ti.func
def artificial(approach: real, strength: real) -> real:
    """The same for Monaghan 1992, eq. 4.1 without its quadratic term: only pairs that approach each other are
    slowed; strength = alpha c h / 2 [m^2/s]."""
    return strength * ti.min(approach, 0.0)


def cohesion_coefficient(surface_tension: float, spacing: float, h: float, mass: float, rest_density: float) -> float:
    """kappa [m^3/s^2] of Becker & Teschner 2007 that gives a surface tension in N/m.

    The pair force f(r) = kappa m r W(max(r, d)) has the surface tension
    gamma = pi/8 n^2 * integral of r^4 f(r) dr over the support, n = rho / m
    (Tartakovsky & Panchenko 2016, eq. 29).
    """
    r = (np.arange(20_000) + 0.5) * h / 20_000
    moment = float((r**5 * cubic_host(np.maximum(r, spacing), h)).sum()) * h / 20_000
    return 8.0 * surface_tension * mass / (math.pi * rest_density**2 * moment)
