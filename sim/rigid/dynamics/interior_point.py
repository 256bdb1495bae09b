"""Impulses of contacts by an interior-point method, for where sweeps over them come no nearer.

A body that has more contacts than it needs to stand may press them against each other by any amount. Where such
contacts ask for velocities that do not quite go together, each sweep only shifts the same small impulse between them.
Newton's method on all of them sees that at once, and ends in the middle of all impulses that would do.

Coulomb's law is one of second-order cones once the velocity u of a contact has mu |u_t| added along its normal (De
Saxcé & Feng 1998): impulses lie in the cone of friction, these velocities in its dual, and they are at right angles.
Both are scaled to Lorentz' cone. Steps are those of Nesterov & Todd 1998 with the corrector of Mehrotra 1992, as
Kleinert et al. 2014 use them for grains. Here the derivative of |u_t| is part of the equations, which are not symmetric
for that, and no outer loop is needed.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.linalg.lapack import dgetrf, dgetrs
from scipy.sparse import csr_matrix, diags
from scipy.sparse.linalg import splu

ITERATIONS = 60
PATIENCE = 8
"""Iterations that may pass without coming nearer."""
SHY = 0.9
"""Steps go so far towards the boundary of the cones."""
SOFT = 1e-3
"""|u_t| is rounded off below this share of the speed that is left for contacts to open or slide."""
NARROW = 0.1
"""Where a step comes less far, it goes back to the middle between the cones' boundaries instead."""
FEW = 20
"""Contacts up to which matrices are full ones: sparse ones take longer to put together than to solve, and LAPACK uses
one thread for these, whatever the machine has."""
REFLECTION = np.array([1.0, -1.0, -1.0])
UNIT = np.array([1.0, 0.0, 0.0])


def impulses(
    mobility: csr_matrix, velocity: np.ndarray, friction: np.ndarray, error: float
) -> tuple[np.ndarray, float]:
    """Impulses of n contacts, normal and across, shape [n, 3] [N s], that come nearest to the laws of Signorini and
    Coulomb, and by how much velocities are off then [m/s].

    mobility: change of the relative velocities by impulses, shape [3 n, 3 n] [1/kg]; velocity: without impulses, along
    the normal less the limit, shape [n, 3] [m/s]; friction: coefficients. It ends early where no velocity is off by
    more than `error` [m/s].
    """
    count = len(friction)
    row = np.arange(3 * count).reshape(count, 3)
    spots = np.repeat(row, 3, axis=1).ravel(), np.tile(row, (1, 3)).ravel()
    blocks = np.asarray(mobility[spots]).reshape(count, 3, 3)
    along, across = 1 / blocks[:, 0, 0], 1 / np.linalg.eigvalsh(blocks[:, 1:, 1:])[:, 1]
    mass = float(np.median(along))
    scale = np.ones((count, 3))
    scale[:, 0] = 1 / np.where(friction > 0, friction, 1.0)
    scale[friction <= 0, 1:] = 0.0
    given = velocity * scale
    if count <= FEW:
        mobility = mobility.toarray()
        matrix = mass * scale.ravel()[:, None] * mobility * scale.ravel()
    else:
        matrix = (diags(mass * scale.ravel()) @ mobility @ diags(scale.ravel())).tocsr()
    fast = max(float(np.abs(given).max()), error)
    x, y = 0.1 * fast * np.tile(UNIT, (count, 1)), fast * np.tile(UNIT, (count, 1))
    nearest, best, since = np.inf, x, 0
    with np.errstate(all="ignore"):
        for _ in range(ITERATIONS):
            found = mass * scale * x
            left = (mobility @ found.ravel()).reshape(count, 3) + velocity
            off = _off(along, across, left, friction, found)
            since += 1
            if off < nearest:
                nearest, best, since = off, found, 0
            if nearest <= error or since > PATIENCE:
                break
            try:
                x, y = _step(matrix, spots, given, x, y)
            except RuntimeError:  # the equations are singular, by rounding near the end
                break
            if not (np.isfinite(x).all() and np.isfinite(y).all()):
                break
    return best, nearest


def _off(
    along: np.ndarray, across: np.ndarray, velocity: np.ndarray, friction: np.ndarray, impulse: np.ndarray
) -> float:
    """The greatest change of a velocity that the laws of one contact alone would make [m/s], as a sweep has it, with
    the effective masses along the normal and across [kg]."""
    push = np.maximum(impulse[:, 0] - along * velocity[:, 0], 0)
    drag = impulse[:, 1:] - across[:, None] * velocity[:, 1:]
    length = np.linalg.norm(drag, axis=1)
    drag *= np.minimum(friction * impulse[:, 0] / np.maximum(length, 1e-300), 1)[:, None]
    sliding = np.linalg.norm(drag - impulse[:, 1:], axis=1) / across
    return float(np.maximum(np.abs(push - impulse[:, 0]) / along, sliding).max())


def _step(
    matrix: csr_matrix | np.ndarray,
    spots: tuple[np.ndarray, np.ndarray],
    given: np.ndarray,
    x: np.ndarray,
    y: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """One iteration on x, y in Lorentz' cone with y = matrix x + given + |y_t| and x o y = 0.

    spots: rows and columns of what a matrix has that acts on each contact by itself.
    """
    count = len(x)
    gap = float((x * y).sum()) / count
    sliding = np.sqrt((y[:, 1:] ** 2).sum(axis=1) + SOFT**2 * gap)
    toward = y[:, 1:] / sliding[:, None]
    missing = y - (matrix @ x.ravel()).reshape(count, 3) - given
    missing[:, 0] -= sliding

    def lifted(u: np.ndarray) -> np.ndarray:
        """Changes of y where those of matrix x + given are u."""
        return u + UNIT * (toward * u[:, 1:]).sum(axis=1)[:, None]

    scaling, unscaling = _scaling(x, y)
    both = _times(scaling, y)
    lift = np.tile(np.eye(3), (count, 1, 1))
    lift[:, 0, 1:] = toward
    if isinstance(matrix, np.ndarray):
        raised = (lift @ matrix.reshape(count, 3, -1)).reshape(matrix.shape)
    else:
        raised = csr_matrix((lift.ravel(), spots)) @ matrix
    system = _with_blocks(raised, unscaling @ unscaling, spots)
    solve = _solver(system)

    def towards(aim: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        right = (_times(unscaling, _quotient(both, aim)) + lifted(missing)).ravel()
        direction = solve(right)
        direction += solve(right - system @ direction)
        return direction.reshape(count, 3), lifted((matrix @ direction).reshape(count, 3) - missing)

    ahead_x, ahead_y = towards(-_product(both, both))
    far = min(1.0, _room(x, ahead_x), _room(y, ahead_y))
    left = float(((x + far * ahead_x) * (y + far * ahead_y)).sum()) / count
    centring = np.clip(left / gap, 0, 1) ** 3 * gap * UNIT
    bend = _product(_times(unscaling, ahead_x), _times(scaling, ahead_y))
    way_x, way_y = towards(centring - _product(both, both) - bend)
    far = min(1.0, SHY * min(_room(x, way_x), _room(y, way_y)))
    if far < NARROW:
        way_x, way_y = towards(gap * UNIT - _product(both, both))
        far = min(1.0, SHY * min(_room(x, way_x), _room(y, way_y)))
    return x + far * way_x, y + far * way_y


def _with_blocks(
    matrix: csr_matrix | np.ndarray, blocks: np.ndarray, spots: tuple[np.ndarray, np.ndarray]
) -> csr_matrix | np.ndarray:
    """A matrix and what acts on each contact by itself, shape [n, 3, 3], as one; a full one is changed."""
    if isinstance(matrix, np.ndarray):
        matrix[spots] += blocks.ravel()
        return matrix
    return matrix + csr_matrix((blocks.ravel(), spots))


def _solver(system: csr_matrix | np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """What solves equations with this matrix; raises RuntimeError for a singular one."""
    if isinstance(system, np.ndarray):
        factors, pivots, singular = dgetrf(system)
        if singular:
            raise RuntimeError("singular")
        return lambda right: dgetrs(factors, pivots, right)[0]
    return splu(system.tocsc()).solve


def _scaling(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Symmetric matrices S, shape [n, 3, 3], with S y = S^-1 x, and their inverses (Nesterov & Todd 1998)."""
    root_x, root_y = np.sqrt(_norm(x))[:, None], np.sqrt(_norm(y))[:, None]
    one_x, one_y = x / root_x, y / root_y
    middle = (one_x + one_y * REFLECTION) / np.sqrt(2 + 2 * (one_x * one_y).sum(axis=1))[:, None]
    v = (middle + UNIT) / np.sqrt(2 * (middle[:, :1] + 1))
    size = np.sqrt(root_x / root_y)[:, :, None]
    u = v * REFLECTION
    flip = np.diag(REFLECTION)
    return size * (2 * v[:, :, None] * v[:, None] - flip), (2 * u[:, :, None] * u[:, None] - flip) / size


def _norm(x: np.ndarray) -> np.ndarray:
    """x_n^2 - |x_t|^2, and above zero by rounding."""
    across = np.linalg.norm(x[:, 1:], axis=1)
    return np.maximum((x[:, 0] - across) * (x[:, 0] + across), 1e-30 * x[:, 0] ** 2 + 1e-300)


def _times(matrices: np.ndarray, x: np.ndarray) -> np.ndarray:
    return np.einsum("cij,cj->ci", matrices, x)


def _product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Jordan's product a o b."""
    return np.column_stack(((a * b).sum(axis=1), a[:, :1] * b[:, 1:] + b[:, :1] * a[:, 1:]))


def _quotient(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The c with a o c = b."""
    first = (a * REFLECTION * b).sum(axis=1) / _norm(a)
    return np.column_stack((first, (b[:, 1:] - first[:, None] * a[:, 1:]) / a[:, :1]))


def _room(x: np.ndarray, direction: np.ndarray) -> float:
    """How many times `direction` all of x stay in the cone."""
    a, b, c = (
        (direction * REFLECTION * direction).sum(axis=1),
        (x * REFLECTION * direction).sum(axis=1),
        _norm(x),
    )
    s = -(b + np.copysign(np.sqrt(b * b - a * c), b))
    far = np.where(direction[:, 0] < 0, -x[:, 0] / direction[:, 0], np.inf)
    for root in (s / a, c / s):
        far = np.where(root > 0, np.minimum(far, root), far)
    return float(far.min())
