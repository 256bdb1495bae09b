"""Single layers of particles, made whole and flat before their surface is looked for.

Where fluid lies in one layer, its particles are the bumps of its surface, and holes open as soon as they part.
Such layers are filled where they are stretched (Ando et al. 2012) and flattened by the mean of what is around (Yu &
Turk 2013, eq. 6). Those on walls are filled farther: a sheet in the air breaks up, a film wets what it lies on, and
holes that come and go from frame to frame are what water boils with. Only the surface sees the result.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import KDTree

from sim.bodies.wall import Wall
from sim.geometry.thinning import first_come
from workflow.stages.surface.mesh import sums
from workflow.stages.surface.spec import Layers

NEXT = 1.5
"""Particles nearer than this are next to one another, in spacings: 8 in a layer, 18 in bulk."""
LAYERED = 12
"""Particles with fewer next to them may be of a sheet; on the surface of bulk there are 13."""
LEAST = 4
"""Neighbours within reach that make a sheet of a particle; with fewer it is a drop or a thread."""
FLAT = 0.5
"""Thickness over extent, as standard deviations, below which it is a sheet: that of one layer is 0, of the half-space
below the surface of bulk 0.55."""
LAYER = 0.3
"""Standard deviation across a sheet, in spacings, below which it is one layer: two have 0.5, and would lose volume to
the smoothing of their surface if they were filled."""
ROOM = 0.72
"""Distance that a new particle keeps from all others, in spacings: more than from the middle of a square of four to
its corners, or sheets that are not stretched would be filled too."""
ON = 1.0
"""Particles nearer than this to a wall lie on it, in spacings."""
SUPPORT = 2.0
"""Reach of the mean that flattens, in spacings: the support radius of the fluid."""
SHARE = 0.9
"""Of the way to that mean (Yu & Turk 2013)."""

Cloud = tuple[np.ndarray, np.ndarray]
"""Positions [m] and velocities [m/s], float32, shape [n, 3]."""


def whole_layers(
    positions: np.ndarray, velocities: np.ndarray, spacing: float, spec: Layers, walls: Sequence[Wall] = ()
) -> Cloud:
    """The particles at `positions` [m] with `velocities` [m/s], float32, shape [n, 3], of `spacing` [m]: those of
    single layers moved into them, followed by new ones that fill gaps of up to `spec.reach` spacings, on `walls` of up
    to `spec.reach_on_walls`. Drops, threads and bulk stay as they are, to the last bit."""
    points = positions.astype(np.float64)
    tree = KDTree(points)
    few = np.flatnonzero(tree.query_ball_point(points, NEXT * spacing, return_length=True) - 1 < LAYERED)
    layer, normal = _layers(points, few, tree, spacing, spec.reach)
    film = _films(points, few, walls, spacing, spec.reach_on_walls)
    points[layer] += _into_layer(points, tree, layer, normal, spacing)
    first, second = _gaps(points, ((layer, spec.reach), (film, spec.reach_on_walls)), spacing)
    middle = (points[first] + points[second]) / 2
    between = (velocities[first] + velocities[second]) / 2
    cloud = np.concatenate([points, middle]), np.concatenate([velocities, between])
    return cloud[0].astype(np.float32), cloud[1].astype(np.float32)


def _films(points: np.ndarray, few: np.ndarray, walls: Sequence[Wall], spacing: float, reach: float) -> np.ndarray:
    """Which particles with `few` others next to them are of a single layer on a wall, whatever flies above it."""
    near = np.zeros(len(points), bool)
    for wall in walls:
        near |= wall.distance(points) < ON * spacing
    on = np.flatnonzero(near)
    some = np.flatnonzero(np.isin(on, few, assume_unique=True))
    if not len(some):
        return some
    layer, _ = _layers(points[on], some, KDTree(points[on]), spacing, reach)
    return on[layer]


def _layers(
    points: np.ndarray, some: np.ndarray, tree: KDTree, spacing: float, reach: float
) -> tuple[np.ndarray, np.ndarray]:
    """Which of `some` particles are of a single layer, shape [m], and the unit normals of it, shape [m, 3]: the cloud
    around them is thin in one direction and wide in two."""
    center, other, weight = _neighbours(points, some, tree, reach * spacing)
    way = points[other] - points[some[center]]
    total = np.bincount(center, weight, len(some))
    mean = sums(center, weight[:, None] * way, len(some)) / total[:, None]
    off = way - mean[center]
    covariance = np.empty((len(some), 3, 3))
    for row in range(3):
        covariance[:, row] = sums(center, (weight * off[:, row])[:, None] * off, len(some)) / total[:, None]
    variance, direction = np.linalg.eigh(covariance)
    thickness, width, length = np.sqrt(np.maximum(variance, 0.0)).T
    enough = np.bincount(center, minlength=len(some)) > LEAST
    layer = enough & (thickness < LAYER * spacing) & (thickness < FLAT * length) & (width > FLAT * length)
    return some[layer], direction[layer, :, 0]


def _gaps(
    points: np.ndarray, layers: Sequence[tuple[np.ndarray, float]], spacing: float
) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of particles of a layer with room for one between them, the nearest first, as two arrays; each layer with
    the widest gap, in spacings, that is filled."""
    found = [
        layer[KDTree(points[layer]).query_pairs(reach * spacing, output_type="ndarray")]
        for layer, reach in layers
        if len(layer)
    ]
    pairs = np.unique(np.sort(np.concatenate([*found, np.empty((0, 2), np.intp)]), axis=1), axis=0)
    length = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    wide = length > 2 * ROOM * spacing
    pairs, length = pairs[wide], length[wide]
    # equal lengths in the order of particles, for which a tree has none of its own
    pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0], length))]
    middle = points[pairs].mean(axis=1)
    nearest, _ = KDTree(points).query(middle, distance_upper_bound=ROOM * spacing)
    pairs, middle = pairs[nearest > ROOM * spacing], middle[nearest > ROOM * spacing]
    kept = first_come(middle, ROOM * spacing)
    return pairs[kept, 0], pairs[kept, 1]


def _into_layer(points: np.ndarray, tree: KDTree, which: np.ndarray, normal: np.ndarray, spacing: float) -> np.ndarray:
    """The ways [m] of those `which`: along the normal, most of the way to the weighted mean around each."""
    center, other, weight = _neighbours(points, which, tree, SUPPORT * spacing)
    height = np.einsum("ij,ij->i", points[other] - points[which[center]], normal[center])
    mean = np.bincount(center, weight * height, len(which)) / np.bincount(center, weight, len(which))
    return SHARE * mean[:, None] * normal


def _neighbours(
    points: np.ndarray, which: np.ndarray, tree: KDTree, radius: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pairs of an index into `which` and a particle nearer than `radius`, itself too, and their weights 1 - (r/R)^3."""
    found = KDTree(points[which]).sparse_distance_matrix(tree, radius, output_type="ndarray")
    order = np.lexsort((found["j"], found["i"]))
    center, other, length = found["i"][order], found["j"][order], found["v"][order]
    return center, other, 1.0 - (length / radius) ** 3
