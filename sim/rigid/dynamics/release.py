"""What is let go between two steps, as what it lay on stops, sets off or goes.

Velocities of what touches something are those of the middle of a step (`sim.rigid.dynamics.free_motion`). To its end,
what holds it still acts on it: without that, a crate on a lift that stops would have fallen for half a step while it
still stood.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from sim.geometry.components import groups


def borne_by(pairs: np.ndarray, dynamic: np.ndarray, seeds: Collection[int]) -> np.ndarray:
    """Which bodies that obey forces, `dynamic`, touch one of `seeds`, or hang together with one that does by contacts
    of these `pairs`, shape [contacts, 2]; planes and bodies that are moved hang nothing together. Shape [bodies]."""
    seeded = np.isin(pairs, list(seeds))
    both = dynamic[pairs].all(axis=1)
    _, group = groups(pairs[both, 0], pairs[both, 1], len(dynamic))
    return dynamic & np.isin(group, group[np.unique(pairs[seeded.any(axis=1)])])


def wrenches(
    pairs: np.ndarray, arm: np.ndarray, force: np.ndarray, position: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Sums of forces [N] on the first bodies of `pairs`, at `arm` [m] from their centres of mass `position` [m], and of
    the opposite ones on the second; and of their moments about each centre [N m]. Shape [bodies, 3] each."""
    total, turning = np.zeros((2, len(position), 3))
    place = position[pairs[:, 0]] + arm
    for side, sign in ((0, 1.0), (1, -1.0)):
        np.add.at(total, pairs[:, side], sign * force)
        np.add.at(turning, pairs[:, side], sign * np.cross(place - position[pairs[:, side]], force))
    return total, turning
