"""Foam that floats, as a layer: how much of it there is at the vertices of the water's surface.

Every particle of it gives the area of its cross-section to the vertex next to it, from where it spreads along edges.
Nothing of it is lost: the integral of the density over the surface is the area of all that was laid on it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from mathutils.kdtree import KDTree

from common.attributes import FOAM
from render.content.ply import TriangleMesh
from render.errors import Unusable

SPRAY, FLOATING, BUBBLE = 0, 1, 2
"""The kinds of particles, by their numbers in files of foam (Ihmsen et al. 2012)."""
REACH = 2.5
"""How far from the surface floating foam lies on it, in edges of its triangles: where fewer particles are near than
within the fluid, that surface is nearer than the support radius, about 3.5 edges. Beside a wall, too, there are fewer,
but what is there is air in the water."""
SURFACED = 1.0
"""How far below it a bubble has come up to it, likewise: it is foam then."""
ALONG = 1e-9
"""One minus the cosine between directions that are the same up to rounding: water that ends flush with a wall or body
looks just where that does."""
FREE = 0.3
"""Share of its triangles by area, from which on a vertex is at the free surface: about half at the edge of a wall."""
UP = 0.5
"""Upward part of a normal, from which on that does not count: still water is as flat as a wall, and what it meets from
below hides it."""
SLIVER = 0.01
"""Area of a vertex, over that of a square on an edge, below which nothing is laid on it: all its triangles are slivers.
"""
SPREADING = 3
"""Rounds in which foam spreads from vertices to their neighbours, about one edge in all: of less, single vertices stand
out, of more, the streaks and holes of the flow are gone."""
SHARE = 0.5
"""Of what is at a vertex, which it gives away in a round at most."""


def laid(water: TriangleMesh, cloud: TriangleMesh) -> tuple[TriangleMesh, TriangleMesh, TriangleMesh]:
    """The water with the column FOAM: cross-section of the foam on it over its area [1]; and the points that are left,
    spray and bubbles. Raises Unusable for files of foam without kinds, and in a Blender without NumPy."""
    if not cloud.has("kind"):
        raise Unusable("the files of foam say no kinds\n  fix: delete them, and make them anew")
    try:
        import numpy as np
    except ImportError:
        raise Unusable(
            "foam as a layer needs NumPy, which this Blender comes without\n"
            "  fix: give render.foam another look, as {type: matte}, or render with the package bpy"
        ) from None
    place, vertices = (_points(source) for source in (cloud, water))
    normals = _normals(water)
    triangles = np.asarray(water.triangles).reshape(-1, 3)
    area, edge = _areas(vertices, triangles)
    open_air = (area > SLIVER * edge**2) & _free(vertices, normals, triangles)
    nearest, away, depth = _nearest(place, vertices, normals, open_air)
    kind = np.asarray(cloud.columns["kind"])
    floating = (kind == FLOATING) & (away < REACH * edge)
    floating |= (kind == BUBBLE) & (away < SURFACED * edge)
    section = np.pi * np.asarray(cloud.columns["radius"], np.float64) ** 2
    here = np.bincount(nearest[floating], section[floating], len(vertices))
    density = _spread(here, area, triangles)
    foamy = replace(water, columns=water.columns | {FOAM: density.astype(np.float32)})
    air = ~floating & ((kind == BUBBLE) | ((kind == FLOATING) & (depth > 0)))
    return foamy, _chosen(cloud, ~floating & ~air), _chosen(cloud, air)


def _points(source: TriangleMesh) -> Any:
    import numpy as np

    return np.stack([np.asarray(source.columns[axis], np.float64) for axis in "xyz"], axis=1)


def _normals(source: TriangleMesh) -> Any:
    import numpy as np

    return np.stack([np.asarray(source.columns[name], np.float64) for name in ("nx", "ny", "nz")], axis=1)


def _areas(vertices: Any, triangles: Any) -> tuple[Any, float]:
    """Of the vertices, a third of each of their triangles [m^2], shape [n]; and the mean edge [m]."""
    import numpy as np

    corner = vertices[triangles]
    sides = corner[:, [1, 2, 0]] - corner
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2
    edge = float(np.linalg.norm(sides, axis=2).mean()) if len(triangles) else 0.0
    return np.bincount(triangles.ravel(), np.repeat(area / 3, 3), len(vertices)), edge


def _free(vertices: Any, normals: Any, triangles: Any) -> Any:
    """Which vertices are not flush with what the water touches; shape [n]."""
    import numpy as np

    corner = vertices[triangles]
    across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    area = np.linalg.norm(across, axis=1)[:, None]
    along = np.einsum("ij,ikj->ik", across, normals[triangles])
    flush = along > (1 - ALONG) * area * np.linalg.norm(normals, axis=1)[triangles]
    flush_area, whole = (
        np.bincount(triangles.ravel(), (area * share).ravel(), len(vertices)) for share in (flush, np.ones((1, 3)))
    )
    return (whole - flush_area > FREE * whole) | (normals[:, 1] > UP)


def _nearest(places: Any, vertices: Any, normals: Any, counts: Any) -> tuple[Any, Any, Any]:
    """Of places, shape [n, 3]: the vertex next to each among those that count, how far it is [m], and how far below
    it the place is [m]."""
    import numpy as np

    tree = KDTree(int(counts.sum()))
    for index in np.flatnonzero(counts).tolist():
        tree.insert(vertices[index], index)
    tree.balance()
    found = [tree.find(place) for place in places] if counts.any() else []
    nearest = np.array([index for _, index, _ in found], dtype=np.int64)
    away = np.array([distance for _, _, distance in found])
    if not found:
        return np.zeros(len(places), np.int64), np.full(len(places), np.inf), np.zeros(len(places))
    depth = np.einsum("ij,ij->i", vertices[nearest] - places, normals[nearest])
    return nearest, away, depth


def _spread(here: Any, area: Any, triangles: Any) -> Any:
    """Density at vertices, shape [n], of areas of foam that are at them [m^2], after it has spread: along each edge
    flows a share of the difference in density, as much into one end as out of the other."""
    import numpy as np

    first, second = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    count = len(area)
    ends = np.bincount(first, minlength=count) + np.bincount(second, minlength=count)
    room = SHARE * area / np.maximum(ends, 1)
    conductance = np.minimum(room[first], room[second])
    safe = np.where(area > 0, area, 1.0)
    for _ in range(SPREADING):
        density = here / safe
        flow = conductance * (density[second] - density[first])
        here = here + np.bincount(first, flow, count) - np.bincount(second, flow, count)
    return here / safe


def _chosen(source: TriangleMesh, which: Any) -> TriangleMesh:
    import numpy as np

    return TriangleMesh({name: np.asarray(column)[which] for name, column in source.columns.items()}, source.triangles)
