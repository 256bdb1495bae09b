"""The contacts that press, or may, solved at once where sweeps over them come no nearer (interior_point)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.sparse import csr_matrix

from sim.rigid.dynamics.interior_point import impulses

MOST = 200
"""Contacts that are solved so: of more, sweeps to their cap cost a tenth."""
NEAR = 100.0
"""Of what is open, contacts that would close if velocities changed by so many times what the last sweep changed."""
STUCK = 1 - 1e-9
"""Friction of less than this share of what slides has holds still."""

Arrays = Mapping[str, np.ndarray]


def settle_at_once(
    contacts: Arrays, motion: Arrays, dynamic: np.ndarray, change: float, error: float
) -> tuple[np.ndarray, np.ndarray] | None:
    """Impulses of n contacts along their normals, shape [n], and across, shape [n, 3] [N s]; None where sweeps are
    nearer, or more than MOST contacts press.

    contacts, motion: the members of `Contacts` and `Motion`; change: of velocities by the last sweep, and `error`, what
    it may be [m/s].
    """
    pair = contacts["body"].reshape(-1, 2)
    axes = _axes(contacts["normal"])
    velocity = _relative(contacts, pair, axes, motion)
    chosen = np.flatnonzero((contacts["normal_impulse"] > 0) | (velocity[:, 0] < NEAR * change))
    if not 0 < len(chosen) <= MOST:
        return None
    axes, slide = axes[chosen], contacts["kinetic_friction"][chosen]
    mobility = _mobility(pair[chosen], contacts["place"][chosen], axes, motion, dynamic)
    push, drag = contacts["normal_impulse"].copy(), contacts["friction_impulse"].copy()
    now = np.column_stack((push[chosen], np.einsum("cij,cj->ci", axes[:, 1:], drag[chosen])))
    without = velocity[chosen] - (mobility @ now.ravel()).reshape(-1, 3)
    holds = np.linalg.norm(now[:, 1:], axis=1) <= STUCK * slide * now[:, 0]
    friction = np.where(holds, contacts["static_friction"][chosen], slide)
    found, off = impulses(mobility, without, friction, error)
    if off > change:
        return None
    push[chosen] = found[:, 0]
    drag[chosen] = np.einsum("ci,cij->cj", found[:, 1:], axes[:, 1:])
    return push, drag


def _axes(normal: np.ndarray) -> np.ndarray:
    """The normal and two directions across, shape [n, 3, 3]."""
    across = np.cross(normal, np.where(np.abs(normal[:, :1]) < 0.5, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]]))
    across /= np.linalg.norm(across, axis=1)[:, None]
    return np.stack((normal, across, np.cross(normal, across)), axis=1)


def _relative(contacts: Arrays, pair: np.ndarray, axes: np.ndarray, motion: Arrays) -> np.ndarray:
    """Velocities of the first bodies as seen from the second, less the limits, along the axes, shape [n, 3] [m/s]."""
    first, second = (
        motion["velocity"][k] + np.cross(motion["spin"][k], contacts["place"] - motion["position"][k]) for k in pair.T
    )
    across = np.einsum("cij,cj->ci", axes[:, 1:], first - second + contacts["arc_velocity"])
    along = np.einsum("cj,cj->c", axes[:, 0], first - second) - contacts["limit"]
    return np.column_stack((along, across))


def _mobility(pair: np.ndarray, place: np.ndarray, axes: np.ndarray, motion: Arrays, dynamic: np.ndarray) -> csr_matrix:
    """Changes of relative velocities by impulses (Delassus' operator), shape [3 n, 3 n] [1/kg]."""
    count = len(pair)
    moving = np.flatnonzero(np.isin(np.arange(len(dynamic)), pair) & dynamic)
    column = np.searchsorted(moving, np.arange(len(dynamic)))
    jacobian, weighted, rows, columns = [], [], [], []
    for side, sign in ((0, 1.0), (1, -1.0)):
        c = np.flatnonzero(dynamic[pair[:, side]])
        k = pair[c, side]
        along = sign * axes[c]
        turning = np.cross((place[c] - motion["position"][k])[:, None], along)
        jacobian.append(np.concatenate((along, turning), axis=2))
        mobile = along * motion["inverse_mass"][k, None, None], turning @ motion["inverse_inertia"][k]
        weighted.append(np.concatenate(mobile, axis=2))
        rows.append(np.repeat(3 * c[:, None] + np.arange(3), 6, axis=1))
        columns.append(np.tile(6 * column[k, None] + np.arange(6), 3))
    spots = tuple(np.concatenate([part.ravel() for part in parts]) for parts in (rows, columns))
    shape = 3 * count, 6 * len(moving)
    first, second = (
        csr_matrix((np.concatenate([part.ravel() for part in parts]), spots), shape) for parts in (weighted, jacobian)
    )
    return first @ second.T
