"""Along which contours surfaces cross, and which of their sides has to go back (Baraff et al. 2003).

A contour joins the crossings that share two crossing triangles, and has an image on each of the two surfaces. Where an
image cuts a piece off its surface, the smaller such piece is on the wrong side of the other surface.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components, dijkstra

from sim.cloth.fabric.fabric import edges_of
from sim.cloth.untangling.crossings import Crossings

ONE_WAY = 0.3
"""Length of the mean unit normal along a contour, from which on a piece can be pushed back that way."""
CLEAR = 0.3
"""A piece is on one side of a contour where this share more of its edges say so than not."""
AROUND = 1.5
"""Surfaces matter as far along them from the contour as the piece is deep, times this."""


class Topology:
    """How points hang together: edges, the triangles beside them, areas."""

    def __init__(self, triangles: np.ndarray, places: np.ndarray):
        """`places` of points as placed [m], shape [n, 3]."""
        self.triangles, self.count = triangles, len(places)
        pairs = np.sort(edges_of(triangles), axis=1)
        keys, number = np.unique(pairs[:, 0] * self.count + pairs[:, 1], return_inverse=True)
        self._keys = keys
        self.edges = np.column_stack([keys // self.count, keys % self.count])
        self.length = np.linalg.norm(places[self.edges[:, 0]] - places[self.edges[:, 1]], axis=1)
        number = number.ravel()
        order = np.argsort(number, kind="stable")
        self._beside, self._first = order % len(triangles), np.searchsorted(number[order], np.arange(len(keys) + 1))
        corners = places[triangles]
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
        self.area = np.bincount(triangles.ravel(), weights=np.repeat(areas / 3, 3), minlength=self.count)
        """Around points [m^2], shape [n]."""
        self._ways = self._graph(np.full(len(keys), True), self.length)

    def _graph(self, rows: np.ndarray, values: np.ndarray) -> coo_matrix:
        a, b = self.edges[rows].T
        return coo_matrix((values[rows], (a, b)), shape=(self.count, self.count)).tocsr()

    def number(self, ends: np.ndarray) -> np.ndarray:
        """Of edges by their points, the lower first, shape [n, 2]."""
        return np.searchsorted(self._keys, ends[:, 0] * self.count + ends[:, 1])

    def beside(self, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The triangles at edges: which of the edges given, and the triangle."""
        edges = self.number(ends)
        counts = self._first[edges + 1] - self._first[edges]
        row = np.repeat(np.arange(len(edges)), counts)
        within = np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts)
        return row, self._beside[self._first[edges[row]] + within]

    def pieces(self, cut: np.ndarray | None = None) -> np.ndarray:
        """A number for each point, the same for those that hang together but for the edges `cut`, shape [k, 2]."""
        whole = np.full(len(self.edges), True)
        if cut is not None:
            whole[self.number(cut)] = False
        return connected_components(self._graph(whole, np.ones(len(self.edges))), directed=False)[1]

    def away(self, sources: np.ndarray, furthest: float = np.inf) -> np.ndarray:
        """How far points are along edges from the nearest of some points [m]; infinite beyond `furthest`."""
        return dijkstra(self._ways, directed=False, indices=np.unique(sources), min_only=True, limit=furthest)


@dataclass(frozen=True)
class Contour:
    """Crossings along one line; `first`: whether the edge, not the triangle, is of the first surface."""

    rows: np.ndarray
    first: np.ndarray
    single: bool
    """Whether both images are one: the line runs into itself."""


def trace(topology: Topology, crossings: Crossings) -> list[Contour]:
    """The contours of crossings: those are joined whose pairs of triangles are the same, in the same order."""
    n, number = len(crossings), len(topology.triangles)
    row, beside = topology.beside(crossings.ends)
    face = crossings.triangle[row]
    keys, key = np.unique(np.concatenate([beside * number + face, face * number + beside]), return_inverse=True)
    nodes = np.concatenate([row, row + n])
    total = 2 * n + len(keys)
    links = coo_matrix((np.ones(len(nodes)), (nodes, 2 * n + key.ravel())), shape=(total, total))
    label = connected_components(links, directed=False)[1]
    ahead, back = label[:n], label[n : 2 * n]
    found = []
    for name in np.unique(np.minimum(ahead, back)):
        rows = np.flatnonzero((ahead == name) | (back == name))
        found.append(Contour(rows, ahead[rows] == name, bool((ahead[rows] == back[rows]).any())))
    return found


@dataclass(frozen=True)
class Piece:
    """What is on the wrong side of a surface along a contour."""

    points: np.ndarray
    """Of the piece, shape [n]."""
    direction: np.ndarray
    """The unit vector to where it belongs, shape [3]."""
    edges: np.ndarray
    """Crossings of the contour at which the edge is the piece's, as rows."""
    triangles: np.ndarray
    """Crossings of the contour at which the triangle is the piece's, as rows."""
    area: float
    """[m^2]"""


def cut_off(
    topology: Topology,
    crossings: Crossings,
    contour: Contour,
    label: np.ndarray,
    places: np.ndarray,
    filled: np.ndarray,
) -> list[Piece]:
    """Pieces that a contour cuts off either surface, the smallest first. `label`: `Topology.pieces` of all cuts;
    `filled`: whether points are of solids with an inside, from which nothing goes back inward."""
    if contour.single:
        return []
    rows = [contour.rows[contour.first == side] for side in (True, False)]
    touched = [np.unique(label[crossings.ends[own]]) for own in rows]
    found = []
    for own, other, beyond in ((rows[0], rows[1], touched[1]), (rows[1], rows[0], touched[0])):
        if not len(own):
            continue
        cut = crossings.take(own)
        corners = places[topology.triangles[cut.triangle]]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        mean = (normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)).mean(axis=0)
        behind, before = _sides(label[np.where(cut.upward[:, None], cut.ends, cut.ends[:, ::-1])])
        if np.linalg.norm(mean) < ONE_WAY:
            continue
        sides = (
            [(behind, mean)] if filled[topology.triangles[cut.triangle]].all() else [(behind, mean), (before, -mean)]
        )
        for side, direction in sides:
            if not len(side) or len(np.intersect1d(side, beyond)):
                continue
            points = np.flatnonzero(np.isin(label, side))
            found.append(
                Piece(points, direction / np.linalg.norm(direction), own, other, float(topology.area[points].sum()))
            )
    return sorted(found, key=lambda piece: piece.area)


def _sides(label: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which pieces are behind and before the other surface, by those of edges' ends there, shape [n, 2]; none where
    most edges have the same piece on both sides. Edges that end close to the other surface may be mistaken."""
    names, number = np.unique(label, return_inverse=True)
    votes = np.stack([np.bincount(side, minlength=len(names)) for side in number.reshape(-1, 2).T])
    clear = np.abs(votes[1] - votes[0]) > CLEAR * votes.sum(axis=0)
    if votes[:, clear].sum() < votes.sum() / 2:
        return names[:0], names[:0]
    return names[clear & (votes[0] > votes[1])], names[clear & (votes[1] > votes[0])]


def patch(topology: Topology, crossings: Crossings, piece: Piece) -> np.ndarray:
    """Triangles of the other surface around the contour, as far as the piece is deep, shape [t]."""
    inside = np.zeros(topology.count, bool)
    inside[piece.points] = True
    ends = crossings.ends[piece.edges].ravel()
    corners = topology.triangles[crossings.triangle[piece.triangles]].ravel()
    deep = topology.away(np.concatenate([ends, corners]))[piece.points]
    deep = deep[np.isfinite(deep)].max(initial=0.0)
    others = [crossings.ends[piece.triangles].ravel(), topology.triangles[crossings.triangle[piece.edges]].ravel()]
    # From corners of triangles that the contour runs through, the way may be longer by an edge.
    spare = 2 * topology.length[topology.number(crossings.ends[np.r_[piece.edges, piece.triangles]])].max()
    near = np.isfinite(topology.away(np.concatenate(others), AROUND * deep + spare))
    return np.flatnonzero(near[topology.triangles].any(axis=1) & ~inside[topology.triangles].any(axis=1))


def shortening(topology: Topology, crossings: Crossings, contour: Contour, places: np.ndarray) -> np.ndarray:
    """How edges should move against the triangles that they cross for the contour to become shorter, shape [n, 3].

    The gradient of the contour's length (Volino & Magnenat-Thalmann 2006): R - 2 (R.e / N.e) N, of the sum R of the
    directions in which the contour goes on in the triangles beside the edge, along e, and the normal N of the other.
    One direction for the whole contour, where its parts agree on one.
    """
    cut = crossings.take(contour.rows)
    corners = places[topology.triangles[cut.triangle]]
    normal = _unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    along = _unit(places[cut.ends[:, 1]] - places[cut.ends[:, 0]])
    row, beside = topology.beside(cut.ends)
    own = places[topology.triangles[beside]]
    across = _unit(np.cross(own[:, 1] - own[:, 0], own[:, 2] - own[:, 0]))
    inward = own.mean(axis=1) - places[cut.ends[row, 0]]
    inward -= (inward * along[row]).sum(axis=1, keepdims=True) * along[row]
    on = _unit(np.cross(across, normal[row]))
    on *= np.where((on * inward).sum(axis=1, keepdims=True) < 0, -1.0, 1.0)
    total = np.zeros((len(cut), 3))
    np.add.at(total, row, on)
    steep = (normal * along).sum(axis=1, keepdims=True)
    steep = np.where(np.abs(steep) < ONE_WAY, np.where(steep < 0, -ONE_WAY, ONE_WAY), steep)
    wanted = total - 2 * (total * along).sum(axis=1, keepdims=True) / steep * normal
    if contour.single:
        return wanted
    sign = np.where(contour.first, 1.0, -1.0)[:, None]
    whole = (sign * wanted).sum(axis=0)
    strength = np.linalg.norm(wanted, axis=1).sum()
    return sign * _unit(whole) if np.linalg.norm(whole) > ONE_WAY * strength else wanted


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)
