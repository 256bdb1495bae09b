"""Cloth that is pushed at some points, and gives way as a whole: projective dynamics (Bouaziz et al. 2014), at rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix, identity
from scipy.sparse.linalg import splu

FIRM = 1e-3
"""How firmly points stay where they are, over how firmly springs hold their length."""
ROUNDS = 20
"""In which springs turn to where points have gone."""


@dataclass(frozen=True)
class Pushes:
    """Sums of weighted places, and what they should be [m]."""

    points: np.ndarray
    """Shape [n, k]."""
    weight: np.ndarray
    """Shape [n, k]; 0 where there are fewer points."""
    wanted: np.ndarray
    """[m], shape [n, 3]."""

    def __len__(self) -> int:
        return len(self.points)

    @classmethod
    def of(cls, points: np.ndarray, weight: np.ndarray, wanted: np.ndarray) -> Pushes:
        """With room for five points."""
        spare = ((0, 0), (0, 5 - points.shape[1]))
        return cls(np.pad(points, spare), np.pad(weight, spare), wanted)

    @classmethod
    def joined(cls, parts: list[Pushes]) -> Pushes:
        """All of them one after the other; of no parts, none."""
        none = cls(np.zeros((0, 5), int), np.zeros((0, 5)), np.zeros((0, 3)))
        return cls(*(np.concatenate(part) for part in zip(*(vars(p).values() for p in [none, *parts]), strict=True)))

    def take(self, rows: np.ndarray) -> Pushes:
        """Those of the given rows, in their order."""
        return Pushes(self.points[rows], self.weight[rows], self.wanted[rows])

    def held(self, free: np.ndarray) -> np.ndarray:
        """Which of them no free point can follow."""
        return ~((self.weight != 0) & free[self.points]).any(axis=1)


def relax(
    places: np.ndarray, springs: np.ndarray, length: np.ndarray, free: np.ndarray, pushes: Pushes, force: float
) -> np.ndarray:
    """Places [m], shape [n, 3], of points once free ones have followed the pushes.

    springs: pairs of points that keep their `length` [m]; force: how firmly pushes are followed, over how firmly
    springs hold their length.
    """
    moving = np.flatnonzero(free)
    springs, length = springs[free[springs].any(axis=1)], length[free[springs].any(axis=1)]
    n, s, p = len(places), len(springs), len(pushes)
    ones = np.ones(s)
    stretch = coo_matrix((np.r_[ones, -ones], (np.tile(np.arange(s), 2), springs.T.ravel())), shape=(s, n)).tocsc()
    row = np.repeat(np.arange(p), pushes.points.shape[1])
    push = coo_matrix((pushes.weight.ravel(), (row, pushes.points.ravel())), shape=(p, n)).tocsc()
    fixed = np.flatnonzero(~free)
    own_stretch, own_push = stretch[:, moving], push[:, moving]
    of_fixed = stretch[:, fixed] @ places[fixed], push[:, fixed] @ places[fixed]
    matrix = FIRM * identity(len(moving)) + own_stretch.T @ own_stretch + force * (own_push.T @ own_push)
    solve = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve
    steady = FIRM * places[moving] + force * (own_push.T @ (pushes.wanted - of_fixed[1]))
    found = places.copy()
    for _ in range(ROUNDS):
        displacement = found[springs[:, 0]] - found[springs[:, 1]]
        displacement *= (length / np.maximum(np.linalg.norm(displacement, axis=1), 1e-300))[:, None]
        found[moving] = solve(steady + own_stretch.T @ (displacement - of_fixed[0]))
    return found
