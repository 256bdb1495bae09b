"""How strongly solids act on the fluid, so that a lattice at rest next to one stays at rest.

A particle next to a solid lacks the neighbours beyond it. What the solid adds to its density must be what they would
add, and the force that follows must be what they would exert. The force of a solid is derived from its share of
the density (the one way in which energy is conserved), and neighbours act twice, through their own pressure too;
so with the natural weight of a solid only one of the two can hold: fluid sinks in, or energy is made.
Both hold for a solid that is further away and weighs more. `Wall` solves for that distance and weight;
samples of surfaces keep a given depth, since thin parts have room for no more, and take the weight for the density.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.fluid.kernel import (
    cubic_host,
    cubic_slope_host,
    halfspace_area_host,
    halfspace_volume_host,
    lattice,
)

SAMPLE_DEPTH = 0.8
"""Samples lie this many spacings below the surface that the fluid is to meet, up to a support of two spacings."""
DEEPER = 0.7
"""By this share of a longer support they lie deeper: at one depth for all, they would weigh so little there that a
particle without neighbours passes through."""


@dataclass(frozen=True)
class Lack:
    """What the outermost layer of a lattice lacks: a share of the density, of the force [1/m], and of the sum that
    makes accelerations of differences of pressure along the wall; and the share of the density that is beyond both
    walls for the layer along an edge."""

    density: float
    force: float
    along: float
    edge: float


def lack(spacing: float, h: float) -> Lack:
    """Sums over the lattice points beyond the outermost layer, relative to all."""
    points = lattice(spacing, h)
    r = np.linalg.norm(points, axis=1)
    total = cubic_host(r, h).sum()
    beyond = points[:, 1] < -spacing / 2
    slopes = cubic_slope_host(r, h)
    slope = slopes[beyond] * points[beyond, 1]
    along = slopes * points[:, 0] ** 2
    beyond_both = beyond & (points[:, 0] < -spacing / 2)
    return Lack(
        float(cubic_host(r[beyond], h).sum() / total),
        float(slope.sum() / total),
        float(along[beyond].sum() / along.sum()),
        float(cubic_host(r[beyond_both], h).sum() / total),
    )


@dataclass(frozen=True)
class Wall:
    """A half-space: `distance` [m] of the outermost layer at rest, and the `weight` of its volume.

    `along`: of what is beyond the wall, the share that counts for accelerations along it. Two that add the shares u1
    and u2 to a density have in common u1 u2 / ((overlap + u1) (overlap + u2)).
    """

    distance: float
    weight: float
    overlap: float
    along: float


def calibrate_wall(spacing: float, h: float) -> Wall:
    """Distance and weight with weight V(s) = lack of density, weight |V'(s)| = twice the lack of force; the overlap
    makes the density along an edge right."""
    missing = lack(spacing, h)
    ratio = missing.density / (2 * missing.force * h)
    low, high = 0.0, 0.999
    for _ in range(60):
        q = (low + high) / 2
        low, high = (q, high) if halfspace_volume_host(q) / halfspace_area_host(q) > ratio else (low, q)
    overlap = missing.density * (missing.edge**-0.5 - 1.0)
    along = missing.along / halfspace_volume_host(spacing / (2 * h))
    return Wall(low * h, float(missing.density / halfspace_volume_host(low)), overlap, float(along))


def curvature_shift(spacing: float, h: float) -> tuple[float, float]:
    """By how much further a curved surface seems to be, over its mean curvature k [m^2], and the spacing [m].

    Between the tangent plane and a surface that bulges lies the depth k x^2 / 2, which the share of a half-space at
    distance s, V, lacks: k int W x^2 dA / 2 in all. The density next to the surface lacks the same part of the
    lattice's lack u, as if it were further by that over |u'|. Beyond a radius of a spacing the surface counts as that
    of one.
    """
    s = spacing / 2
    x = (np.arange(4000) + 0.5) / 4000 * h
    moment = float((cubic_host(np.hypot(s, x), h) * 2 * np.pi * x**3).sum()) * h / 4000
    missing = lack(spacing, h)
    missing_room = moment / (2 * float(halfspace_volume_host(s / h)))
    return missing_room * missing.density / (2 * missing.force), spacing


def sample_depth(spacing: float, h: float) -> float:
    """How far samples lie below the surface that the fluid is to meet [m]."""
    return SAMPLE_DEPTH * spacing + DEEPER * max(0.0, h - 2.0 * spacing)


def sample_weight(spacing: float, h: float) -> float:
    """Factor on the volume of boundary samples, `sample_depth` below the surface, that makes the density right."""
    distance = sample_depth(spacing, h) + 0.5 * spacing
    near = cubic_host(np.hypot(_across(spacing, h), distance), h).sum()
    return lack(spacing, h).density / (sample_volume(spacing, h) * float(near))


def sample_volume(spacing: float, h: float) -> float:
    """Volume [m^3] of a boundary sample in a square lattice, without weight (Akinci et al. 2012, eq. 4)."""
    return 1.0 / float(cubic_host(_across(spacing, h), h).sum())


def _across(spacing: float, h: float) -> np.ndarray:
    """Distances [m] of the points of a square lattice from one of them, shape [n]."""
    reach = int(np.ceil(h / spacing))
    axis = np.arange(-reach, reach + 1) * spacing
    x, z = np.meshgrid(axis, axis)
    return np.hypot(x, z).ravel()
