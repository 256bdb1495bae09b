"""Which bodies are near each other: by boxes around them (sweep_and_prune), and by planes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim.geometry.distance.sdf import PLANE
from sim.neighbors.sweep_and_prune import near_pairs, near_planes
from sim.rigid.body import Body
from sim.rigid.collision.all_pairs import Boxes

SKIN = 1e-3
"""Contacts are followed from this share of the smaller body's size on, beyond what bodies go in a step."""


class BroadPhase:
    """Boxes around the solids in their own axes, and the planes, which come last among `bodies`.

    `reach`: how far from its pivot a body goes at most [m], shape [bodies]; 0 of planes.
    """

    def __init__(self, bodies: Sequence[Body], dynamic: np.ndarray):
        solids = [body for body in bodies if body.shape.kind != PLANE]
        planes = bodies[len(solids) :]
        bounds = np.array([body.bounds for body in solids]).reshape(-1, 2, 3)
        self._middle, self._half = bounds.mean(axis=1), (bounds[:, 1] - bounds[:, 0]) / 2
        self._dynamic = dynamic[: len(solids)]
        self.solids = len(solids)
        self.reach = np.zeros(len(bodies))
        self.reach[: len(solids)] = np.linalg.norm(np.abs(bounds).max(axis=1), axis=1)
        self._normals = np.array([body.shape.turn[:, 1] for body in planes]).reshape(-1, 3)
        self._offsets = np.array([body.shape.turn[:, 1] @ body.shape.origin for body in planes])
        self.skin = SKIN * np.array([body.size for body in bodies])
        """How far off contacts are followed, beyond what bodies go in a step [m]."""
        self.boxes = Boxes(
            own_middle=_some(self._middle),
            own_half=_some(self._half),
            farthest=self.reach,
            skin=self.skin,
            plane_normal=_some(self._normals),
            plane_offset=_some(self._offsets),
            box_middle=np.zeros((len(bodies), 3)),
            box_half=np.zeros((len(bodies), 3)),
            step_way=np.zeros(len(bodies)),
        )

    def near(self, position: np.ndarray, turn: np.ndarray, reach: np.ndarray | float) -> np.ndarray:
        """Pairs of bodies, one of them dynamic, whose boxes would overlap if larger by `reach` [m] all around.

        position [m] and turn of the bodies, shape [bodies, 3] and [bodies, 3, 3]; of pairs shape [n, 2].
        """
        turn = turn[: self.solids]
        middle = position[: self.solids] + np.einsum("nij,nj->ni", turn, self._middle)
        half = np.einsum("nij,nj->ni", np.abs(turn), self._half) + reach
        pairs = near_pairs(middle - half, middle + half, self._dynamic)
        walls = near_planes(middle, half, self._dynamic, self._normals, self._offsets)
        walls[:, 1] += self.solids
        return np.concatenate((pairs, walls))


def _some(values: np.ndarray) -> np.ndarray:
    """As they are, or a row of zeros where there are none: kernels take no empty arrays."""
    return values if len(values) else np.zeros((1, *values.shape[1:]))
