"""Contacts on the host, with the forces that go on from step to step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass
class ContactSet:
    """Of n contacts, one row each."""

    key: np.ndarray
    """Kind and four points, shape [n, 5]."""
    thickness: np.ndarray
    """At which distance they touch [m], shape [n]."""
    weight: np.ndarray
    """Of the points, shape [n, 4]."""
    normal: np.ndarray
    """Towards the first side, shape [n, 3]."""
    limit: np.ndarray
    """How far the first side has to be from the other along the normal [m], shape [n]."""
    normal_force: np.ndarray
    """[N], shape [n]."""
    friction_force: np.ndarray
    """[N], shape [n, 3]."""

    @classmethod
    def none(cls) -> ContactSet:
        """Where nothing touches."""
        shapes = (0,), (0, 4), (0, 3), (0,), (0,), (0, 3)
        return cls(np.zeros((0, 5), np.int32), *map(np.zeros, shapes))

    def take(self, rows: np.ndarray) -> ContactSet:
        """Those of the given rows, in their order."""
        return ContactSet(*(values[rows] for values in vars(self).values()))

    def joined(self, other: ContactSet) -> ContactSet:
        """With those of another, in the order of their keys."""
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        whole = ContactSet(*(np.concatenate(pair) for pair in pairs))
        return whole.take(np.lexsort(whole.key.T[::-1]))

    @property
    def force(self) -> np.ndarray:
        """On the first sides [N], shape [n, 3]."""
        return self.normal_force[:, None] * self.normal + self.friction_force


def among(keys: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Which rows of `keys` are rows of `others`, shape [n]."""
    kind = np.dtype((np.void, keys.dtype.itemsize * keys.shape[1]))
    one, other = (np.ascontiguousarray(rows).view(kind).ravel() for rows in (keys, others))
    return np.isin(one, other)
