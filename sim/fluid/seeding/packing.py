"""Particles without a lattice, as in a fluid that has flowed.

A cube that repeats without end holds particles that began on a lattice, were moved at random and then by -h^2 grad C,
where C = sum_j V W_ij is the kernels' share of space (Colagrossi et al. 2012): what is left is as even as a lattice,
and the same in all directions.
"""

from __future__ import annotations

import functools

import numpy as np
from scipy.spatial import cKDTree

from sim.fluid.kernel import cubic_slope_host, particle_mass
from sim.fluid.seeding.settling import LONGEST, LOOKS, MOMENTUM, SUPPORT, bounded, gathered
from sim.geometry.filling import check_number, fill, outermost, particle_number
from sim.geometry.solids import Solid

PERIOD = 12
"""Edge of the cube, in spacings: farther than order reaches."""
DISORDER = 0.5
"""How far particles are moved at random, in spacings: to anywhere in their cell."""
FEW = 60
"""Particles that are all next to a surface: there is nothing in which they could be disordered."""
ROUNDS = 100
RATE = 0.05
"""Of the way in a round, in h^2 grad C: half of what makes neighbours swing."""


def fill_relaxed(solid: Solid, spacing: float) -> np.ndarray:
    """Particle positions [m], shape [n, 3], without a lattice: as many as `sim.geometry.filling.fill` has, the deepest
    ones, of which some may be a little outside. FEW and less are on a lattice. Raises `Refused` as `fill` does."""
    number = particle_number(solid, spacing)
    if number <= FEW:
        return fill(solid, spacing)
    low, high = solid.bounds
    middle, half = (low + high) / 2, (high - low) / 2 + spacing
    cubes = np.ceil(half / (PERIOD * spacing)).astype(int)
    check_number(float((2 * cubes).prod()) * PERIOD**3, spacing)
    points = []
    for cube in np.ndindex(*(2 * cubes)):
        offset = spacing * (_cube() + PERIOD * (cube - cubes))
        points.append(middle + offset[np.all(np.abs(offset) < half, axis=1)])
    found = np.concatenate(points)
    found = found[outermost(solid.signed_distance(found), number, spacing)]
    return found[np.lexsort(found.T[::-1])]


@functools.cache
def _cube() -> np.ndarray:
    """Particles of the cube that repeats, in spacings, shape [PERIOD^3, 3]."""
    count, h = PERIOD**3, SUPPORT
    mass = particle_mass(1.0, h, 1.0)
    place = np.argwhere(np.ones((PERIOD,) * 3, dtype=bool)) + 0.5
    place += DISORDER * np.random.default_rng(0).uniform(-1.0, 1.0, place.shape)
    way = np.zeros_like(place)
    for turn in range(ROUNDS):
        place %= PERIOD
        if turn % LOOKS == 0:
            a, b = cKDTree(place, boxsize=PERIOD).query_pairs(1.1 * h, output_type="ndarray").T
        apart = place[a] - place[b]
        apart -= PERIOD * np.round(apart / PERIOD)
        slope = mass * cubic_slope_host(np.linalg.norm(apart, axis=1), h)[:, None] * apart
        way = MOMENTUM * way - RATE * h * h * (gathered(a, slope, count) - gathered(b, slope, count))
        way = bounded(way, LONGEST)
        place = place + way
    return place % PERIOD
