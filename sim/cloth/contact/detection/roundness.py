"""Which way solids face that are round, though their surfaces are made of triangles.

A contact presses along a normal. Those of a ball's flat faces point away from its centre only in their middle, so that
a ball which turns would push aside what nothing holds to it. Where triangles meet at a small angle, their surface is
taken for round, and normals of corners are interpolated between them (Phong 1975); at larger ones it has an edge.
"""

from __future__ import annotations

import numpy as np
import trimesh
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from sim.cloth.contact.detection.search import EDGE, PLANE

CREASE = np.radians(30)
"""Triangles that meet at a larger angle have an edge between them."""
ASIDE = np.cos(np.radians(35))
"""Cosine of the angle from which on a round surface faces elsewhere: what stands on it touches it with its foot."""
FLAT = 1e-6
"""Part of a corner's normal along its triangle below which there is nothing round."""
BORDER = 1e-9
"""Weight of a corner below which the opposite side of its triangle is touched."""


class Roundness:
    """Normals at the corners of `triangles`, shape [t, 3], in the frame of each, which moves as the solid does.

    places: of all points [m], shape [n, 3]; solids may be turned and shifted from there. Solids have the points from
    `first` on.
    """

    def __init__(self, triangles: np.ndarray, places: np.ndarray, first: int):
        self._first, self._points, self._triangles = first, len(places), triangles
        mesh = trimesh.Trimesh(places, triangles, process=False)
        smooth = mesh.face_adjacency_angles < CREASE
        pairs, edges = mesh.face_adjacency[smooth], mesh.face_adjacency_edges[smooth]
        group = _groups(triangles, pairs, edges)
        weighted = mesh.face_angles[..., None] * mesh.face_normals[:, None]
        normals = np.zeros((len(triangles), 3, 3))
        np.add.at(normals.reshape(-1, 3), group, weighted.reshape(-1, 3))
        normals = normals.reshape(-1, 3)[group].reshape(-1, 3, 3)
        normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-30)
        self._corner = np.einsum("tij,tci->tcj", _frames(places[triangles]), normals)
        self.flat = not (np.abs(self._corner[..., :2]) > FLAT).any()
        """Whether there is nothing round."""
        self._triangle_of = _Numbers(self._codes(triangles), np.arange(len(triangles)))
        self._triangle_at_edge = _Numbers(self._codes(edges), pairs[:, 0])
        self._triangle_at_point = np.full(self._points, -1)
        self._triangle_at_point[triangles] = np.arange(len(triangles))[:, None]
        of_point = np.unique(np.column_stack([triangles.ravel(), group]), axis=0)[:, 0]
        self._triangle_at_point[np.bincount(of_point, minlength=self._points) > 1] = -1

    def normals(
        self, key: np.ndarray, weight: np.ndarray, normal: np.ndarray, start: np.ndarray, end: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Normals of contacts, shape [n, 3], which are `normal` for the triangles, and whether it is there that they
        touch, shape [n].

        key, weight: as `Known` has them, of some time while all points go from `start` to `end` [m].
        """
        corner, share = key[:, 1:], np.abs(weight)
        solid = (corner >= self._first) & (key[:, :1] < PLANE)
        touched = self._touched(key[:, 0] == EDGE, corner, np.where(solid, share, 0.0), solid)
        rows = np.flatnonzero(touched >= 0)
        out, real = normal.copy(), np.ones(len(key), bool)
        if not len(rows):
            return out, real
        triangle = touched[rows]
        members = self._triangles[triangle]
        same = (members[:, :, None] == corner[rows][:, None]) & solid[rows][:, None]
        at = (same * share[rows][:, None]).sum(axis=2)
        local = np.einsum("nc,ncj->nj", at, self._corner[triangle])
        when = _time(corner[rows], weight[rows], normal[rows], start, end)[:, None, None]
        there = start[members] + when * (end[members] - start[members])
        found = np.einsum("nij,nj->ni", _frames(there), local)
        found /= np.maximum(np.linalg.norm(found, axis=1, keepdims=True), 1e-30)
        along = (found * normal[rows]).sum(axis=1)
        out[rows] = np.sign(along)[:, None] * found
        real[rows] = np.abs(along) > ASIDE
        return out, real

    def _touched(self, edge: np.ndarray, corner: np.ndarray, share: np.ndarray, solid: np.ndarray) -> np.ndarray:
        """A triangle that each contact is with where the surface is round; -1 where it is not, shape [n]."""
        part = share > BORDER
        number = part.sum(axis=1)
        out = np.full(len(corner), -1)
        inside = np.flatnonzero(~edge & (number == 3) & solid[:, 1:].all(axis=1))
        out[inside] = self._triangle_of.of(self._codes(corner[inside, 1:]))
        between = np.flatnonzero(number == 2)
        out[between] = self._triangle_at_edge.of(self._codes(corner[between][part[between]].reshape(-1, 2)))
        alone = np.flatnonzero(number == 1)
        out[alone] = self._triangle_at_point[corner[alone][part[alone]]]
        return out

    def _codes(self, members: np.ndarray) -> np.ndarray:
        """A number for each set of two or three points, shape [n]."""
        code = np.zeros(len(members), np.int64)
        for column in np.sort(members, axis=1).T:
            code = code * self._points + column
        return code


class _Numbers:
    """The `number` that belongs to each code."""

    def __init__(self, code: np.ndarray, number: np.ndarray):
        order = np.argsort(code, kind="stable")
        self._code, self._number = code[order], number[order]

    def of(self, code: np.ndarray) -> np.ndarray:
        """-1 of codes that there are not."""
        if not len(self._code):
            return np.full(len(code), -1)
        at = np.minimum(np.searchsorted(self._code, code), len(self._code) - 1)
        return np.where(self._code[at] == code, self._number[at], -1)


def _time(corner: np.ndarray, weight: np.ndarray, normal: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The share of their displacement at which the sides of contacts lay along their normals, shape [n]."""
    aside = [(weight[..., None] * places[np.maximum(corner, 0)]).sum(axis=1) for places in (start, end)]
    before, after = (apart - (apart * normal).sum(axis=1)[:, None] * normal for apart in aside)
    change = after - before
    return np.clip(-(before * change).sum(axis=1) / np.maximum((change**2).sum(axis=1), 1e-30), 0.0, 1.0)


def _groups(triangles: np.ndarray, pairs: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Of all corners of triangles, one after the other, which share a normal: those of a point with no edge between."""
    size = triangles.size
    found = [
        3 * triangle + np.argmax(triangles[triangle] == point[:, None], axis=1)
        for point in edges.T
        for triangle in pairs.T
    ]
    ends = np.array(found).reshape(2, 2, -1)
    one, other = ends[:, 0].ravel(), ends[:, 1].ravel()
    return connected_components(coo_matrix((np.ones(len(one)), (one, other)), shape=(size, size)), directed=False)[1]


def _frames(corners: np.ndarray) -> np.ndarray:
    """Axes of triangles as columns, the third one normal; corners shape [n, 3, 3]."""
    along = corners[:, 1] - corners[:, 0]
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-30)
    across = np.cross(along, corners[:, 2] - corners[:, 0])
    across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-30)
    return np.stack([along, np.cross(across, along), across], axis=2)
