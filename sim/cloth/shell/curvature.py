"""The curvature of a triangle mesh around its points, as sums over the points beside each.

At a point, the curvature is the sum over its edges of l/2 (jump of the slope across the edge) n n^T over the area
around it, n across the edge (Cohen-Steiner & Morvan 2003): with a constant moment, it leaves inner points without
force. On unequal triangles that sum is not the curvature of a quadratic surface, so that it is multiplied by the
symmetric part of the matrix that would make it so. Both together converge on any mesh: hinges at edges do not
(Grinspun et al. 2006).

Bending is quadratic in the positions (Bergou et al. 2006), whose curvature is a vector along the normal as long as
triangles keep their shape.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from scene.settings import Refused
from sim.cloth.shell.membrane import normals_at_points, warp_on
from sim.cloth.spec import ClothSheet

LEAST = 0.5
"""Eigenvalues of the matrix, over the area, are taken for this at least: a curvature that a star hardly sees would
count for too much."""


@dataclass(frozen=True)
class Bending:
    """What bending takes: half the sum of all squares of `weights` times the places of `points` about each."""

    first: np.ndarray
    """Where entries of each point begin, shape [n + 1]."""
    points: np.ndarray
    """Those beside, shape [e]."""
    weights: np.ndarray
    """Three of each entry [(N/m)^0.5], shape [e, 3]; that of the point itself is minus their sum."""
    delay: np.ndarray
    """Moment by the rate of curvature over that by curvature [s], shape [n]."""

    def bent(self, places: np.ndarray) -> np.ndarray:
        """Three vectors of each point [J^0.5], shape [n, 3, 3]: of kinds of curvature, then of axes."""
        count = len(self.first) - 1
        found = np.empty((count, 3, 3))
        own = np.repeat(np.arange(count), np.diff(self.first))
        for kind in range(3):
            matrix = csr_array((self.weights[:, kind], self.points, self.first), shape=(count, count))
            total = np.bincount(own, self.weights[:, kind], minlength=count)
            found[:, kind] = matrix @ places - total[:, None] * places
        return found

    def spread(self, moments: np.ndarray) -> np.ndarray:
        """Of three vectors of each point, shape [n, 3, 3], what the places of points get, shape [n, 3]: the transpose
        of `bent`."""
        count = len(self.first) - 1
        own = np.repeat(np.arange(count), np.diff(self.first))
        found = np.zeros((count, 3))
        for kind in range(3):
            weighted = self.weights[:, kind, None] * moments[own, kind]
            np.add.at(found, self.points, weighted)
            np.add.at(found, own, -weighted)
        return found

    def matrix(self) -> csr_array:
        """Second derivatives of the energy by positions along one axis [N/m], shape [n, n]."""
        count = len(self.first) - 1
        own = np.repeat(np.arange(count), np.diff(self.first))
        whole = csr_array((count, count))
        for kind in range(3):
            weight = self.weights[:, kind]
            total = np.bincount(own, weight, minlength=count)
            rows, columns = np.r_[own, np.arange(count)], np.r_[self.points, np.arange(count)]
            one = csr_array((np.r_[weight, -total], (rows, columns)), shape=(count, count))
            whole = whole + one.T @ one
        return csr_array(whole)


@dataclass(frozen=True)
class _Corners:
    """Corners of triangles around points, numbered 3 triangle + corner."""

    point: np.ndarray
    beside: np.ndarray
    """The next point of the triangle."""
    behind: np.ndarray
    """The one after."""
    next: np.ndarray
    """The corner around the same point that shares the edge to `behind`; -1 at borders."""
    angle: np.ndarray
    """[rad]"""


def find_bending(sheet: ClothSheet, points: np.ndarray, triangles: np.ndarray, warp: np.ndarray) -> Bending:
    """Of one sheet with `points` at rest [m], shape [n, 3], and the direction of its warp there.

    Raises Refused where triangles do not form a surface that has two sides.
    """
    count = len(points)
    if not sheet.bends:
        return Bending(np.zeros(count + 1, int), np.zeros(0, int), np.zeros((0, 3)), np.zeros(count))
    corners = _corners(points, triangles)
    direction, turned = _directions(points, triangles, corners, warp)
    row, column, raw, seen = _stars(points, corners, direction, turned)
    areas = np.linalg.norm(np.cross(*(points[triangles[:, k]] - points[triangles[:, 0]] for k in (1, 2))), axis=1) / 2
    around = np.maximum(np.bincount(triangles.ravel(), np.repeat(areas / 3, 3), minlength=count), 1e-300)
    fabric = sheet.resistance
    twist = fabric.bias_bending - (fabric.warp_bending + fabric.weft_bending) / 4
    root = np.sqrt([fabric.warp_bending, fabric.weft_bending, twist])
    # With each kind of curvature times the root of its stiffness, energies are squares.
    exact = seen / around[:, None, None] * root[:, None] / root
    value, vector = np.linalg.eigh((exact + exact.transpose(0, 2, 1)) / 2)
    # Of the inverse, the root: weights count twice.
    share = vector / np.sqrt(np.maximum(value, LEAST))[:, None, :] @ vector.transpose(0, 2, 1)
    scale = share * root / np.sqrt(around)[:, None, None]
    weights = np.einsum("ekl,el->ek", scale[row], raw)
    # Who is beside whom is mutual, if with no weight: a corner of one triangle has no curvature.
    rows, columns, both = np.r_[row, column], np.r_[column, row], np.concatenate([weights, 0 * weights])
    parts = [csr_array((both[:, kind], (rows, columns)), shape=(count, count)) for kind in range(3)]
    for part in parts:
        part.sum_duplicates()
        part.sort_indices()
    whole = np.column_stack([part.data for part in parts])
    return Bending(parts[0].indptr, parts[0].indices, whole, np.full(count, sheet.woven.bend_damping_time))


def _corners(points: np.ndarray, triangles: np.ndarray) -> _Corners:
    point, beside, behind = (np.roll(triangles, -k, axis=1).ravel() for k in range(3))
    count = len(points)
    key = point * count + beside
    order = np.argsort(key, kind="stable")
    if (np.diff(key[order]) == 0).any():
        twice = order[np.flatnonzero(np.diff(key[order]) == 0)[0]]
        place = points[[point[twice], beside[twice]]].mean(axis=0)
        raise Refused(
            f"triangles beside the edge at {np.round(place, 4).tolist()} face different ways, or are more than two",
            remedy="give a mesh whose edges have two triangles at most, with their corners in the same sense, or "
            "take cloth.model: springs",
        )
    wanted = point * count + behind
    found = np.minimum(np.searchsorted(key[order], wanted), len(key) - 1)
    following = np.where(key[order][found] == wanted, order[found], -1)
    one, other = points[beside] - points[point], points[behind] - points[point]
    angle = np.arctan2(np.linalg.norm(np.cross(one, other), axis=1), (one * other).sum(axis=1))
    return _Corners(point, beside, behind, following, angle)


def _directions(
    points: np.ndarray, triangles: np.ndarray, corners: _Corners, warp: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """By corner, the direction of the edge to `beside` from the warp [rad], and over the angles of the mesh those by
    which the star of its point is laid flat: a whole turn, but at borders."""
    count = len(points)
    whole = np.bincount(corners.point, corners.angle, minlength=count)
    entered = np.zeros(len(corners.point), bool)
    entered[corners.next[corners.next >= 0]] = True
    first = np.full(count, -1)
    first[corners.point] = np.arange(len(corners.point))
    border = np.flatnonzero(~entered)
    if len(border) != len(np.unique(corners.point[border])):
        found, number = np.unique(corners.point[border], return_counts=True)
        raise Refused(
            f"pieces of the mesh meet in the point {np.round(points[found[number > 1][0]], 4).tolist()} alone",
            remedy="give each piece points of its own, or take cloth.model: springs",
        )
    first[corners.point[border]] = border
    flat = np.where(np.isin(np.arange(count), corners.point[border]), 1.0, 2 * np.pi / np.maximum(whole, 1e-300))
    start = np.zeros(len(corners.point))
    at, turn, begin = first[first >= 0], np.zeros(count)[first >= 0], first[first >= 0]
    while len(at):
        start[at] = turn
        turn, at = turn + corners.angle[at] * flat[corners.point[at]], corners.next[at]
        on = (at >= 0) & (at != begin)
        at, turn, begin = at[on], turn[on], begin[on]
    normal = normals_at_points(points, triangles)
    along = warp_on(normal, warp)
    edge = points[corners.beside[first]] - points[corners.point[first]]
    own = corners.point[first]
    towards = (edge * along[own]).sum(axis=1), (edge * np.cross(normal, along)[own]).sum(axis=1)
    offset = np.zeros(count)
    offset[own] = np.arctan2(towards[1], towards[0])
    return start + offset[corners.point], flat[corners.point]


def _stars(
    points: np.ndarray, corners: _Corners, direction: np.ndarray, turned: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Rows, columns and weights, shape [e, 3], of the sums of l/2 (jump) (n_x^2, n_y^2, 2 n_x n_y) [m^2 1/m], and what
    they make of the curvatures (k_xx, k_yy, 2 k_xy) of quadratic surfaces, shape [n, 3, 3]."""
    one = np.flatnonzero(corners.next >= 0)
    other = corners.next[one]
    point, middle = corners.point[one], corners.behind[one]
    right, left = corners.beside[one], corners.behind[other]
    reach = {
        end: np.linalg.norm(points[end_points] - points[point], axis=1)
        for end, end_points in (("middle", middle), ("right", right), ("left", left))
    }
    angle = {"right": corners.angle[one] * turned[one], "left": corners.angle[other] * turned[one]}
    along = {side: reach[side] * np.cos(angle[side]) for side in angle}
    apart = {side: np.maximum(reach[side] * np.sin(angle[side]), 1e-12 * reach["middle"]) for side in angle}
    length = reach["middle"]
    towards = direction[other]
    across = np.column_stack([-np.sin(towards), np.cos(towards)])
    tensor = np.column_stack([across[:, 0] ** 2, across[:, 1] ** 2, 2 * across[:, 0] * across[:, 1]])
    weight = {side: length / 2 / apart[side] for side in angle}
    weight["middle"] = -(along["right"] / apart["right"] + along["left"] / apart["left"]) / 2
    ends = {"middle": middle, "right": right, "left": left}
    seen = np.zeros((len(points), 3, 3))
    for end, at in (("middle", towards), ("right", towards - angle["right"]), ("left", towards + angle["left"])):
        x, y = reach[end] * np.cos(at), reach[end] * np.sin(at)
        surface = np.column_stack([x * x, y * y, x * y]) / 2
        np.add.at(seen, point, weight[end][:, None, None] * tensor[:, :, None] * surface[:, None, :])
    row = np.tile(point, 3)
    column = np.concatenate([ends[end] for end in ends])
    values = np.concatenate([weight[end][:, None] * tensor for end in ends])
    return row, column, values, seen
