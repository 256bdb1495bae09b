"""What points meet first when they go straight one way."""

from __future__ import annotations

import numpy as np

from sim.cloth.untangling.boxes import Boxes, overlapping
from sim.cloth.untangling.crossings import barycentric

RIM = 1e-9
"""Triangles are larger by this share for what meets their sides."""


def cast(
    points: np.ndarray, corners: np.ndarray, direction: np.ndarray, *, last: bool = False
) -> tuple[np.ndarray, ...]:
    """For those that meet one: the point, the triangle, weights of its corners there, and how far it is [m].

    points: [m], shape [n, 3]; corners: of triangles [m], shape [t, 3, 3]; direction: unit vector; last: what they meet
    last.
    """
    turn = _frame(direction)
    flat, faces = points @ turn.T, corners @ turn.T
    top = float(faces[:, :, 2].max(initial=0.0))
    ceiling = np.column_stack([flat[:, :2], np.maximum(flat[:, 2], top)])
    row, face = overlapping(Boxes(flat, ceiling), Boxes.around(faces)).T
    a, b, c = (faces[face, k, :2] - flat[row, :2] for k in range(3))
    weight = np.column_stack([_turn(b, c), _turn(c, a), _turn(a, b)])
    whole = weight.sum(axis=1, keepdims=True)
    weight = weight / np.where(whole == 0, 1.0, whole)
    height = (weight * faces[face, :, 2]).sum(axis=1) - flat[row, 2]
    hit = np.flatnonzero((whole[:, 0] != 0) & (weight >= -RIM).all(axis=1) & (height > 0))
    hit = hit[np.lexsort((-height[hit] if last else height[hit], row[hit]))]
    hit = hit[np.unique(row[hit], return_index=True)[1]]
    foot = points[row[hit]] + height[hit, None] * direction
    return row[hit], face[hit], barycentric(foot, corners[face[hit]]), height[hit]


def _frame(direction: np.ndarray) -> np.ndarray:
    """A proper rotation that turns a unit vector to z."""
    aside = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
    aside /= np.linalg.norm(aside)
    return np.stack([aside, np.cross(direction, aside), direction])


def _turn(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
