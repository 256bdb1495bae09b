"""What a shell does to its own points, on the host."""

from __future__ import annotations

import numpy as np

from sim.cloth.shell.elements import COLLAPSED
from sim.cloth.shell.shell import Shell


def pushes(shell: Shell, places: np.ndarray, velocities: np.ndarray) -> np.ndarray:
    """Forces of stretching and bending on all points [N], shape [n, 3], at places [m] and velocities [m/s]."""
    return _stretching(shell, places, velocities) + _bending(shell, places, velocities)


def _stretching(shell: Shell, places: np.ndarray, velocities: np.ndarray) -> np.ndarray:
    membrane = shell.membrane
    frame, rate = (
        np.einsum("tkd,tkx->tdx", membrane.slopes, values[membrane.corners]) for values in (places, velocities)
    )
    metric = np.einsum("tax,tbx->tab", frame, frame)
    strain = np.column_stack([(metric[:, 0, 0] - 1) / 2, (metric[:, 1, 1] - 1) / 2, metric[:, 0, 1]])
    mixed = np.einsum("tax,tbx->tab", rate, frame)
    strain_rate = np.column_stack([mixed[:, 0, 0], mixed[:, 1, 1], mixed[:, 0, 1] + mixed[:, 1, 0]])
    felt = strain + membrane.delay[:, None] * strain_rate
    warp, weft, both, shear = membrane.modulus.T
    stress = np.empty((len(felt), 2, 2))
    stress[:, 0, 0] = warp * felt[:, 0] + both * felt[:, 1]
    stress[:, 1, 1] = both * felt[:, 0] + weft * felt[:, 1]
    stress[:, 0, 1] = stress[:, 1, 0] = shear * felt[:, 2]
    pull = np.einsum("tab,tbx->tax", stress, frame)
    across = np.cross(frame[:, 0], frame[:, 1])
    spread = np.linalg.norm(across, axis=1)
    normal = across / np.maximum(spread, 1e-300)[:, None]
    above = np.maximum(spread, COLLAPSED)
    slope = membrane.barrier * (1 - 1 / above + (spread - above) / above**2)
    widening = np.stack([np.cross(frame[:, 1], normal), np.cross(normal, frame[:, 0])], axis=1)
    pull += slope[:, None, None] * widening
    corner = -membrane.area[:, None, None] * np.einsum("tka,tax->tkx", membrane.slopes, pull)
    force = np.zeros_like(places)
    np.add.at(force, membrane.corners, corner)
    return force


def _bending(shell: Shell, places: np.ndarray, velocities: np.ndarray) -> np.ndarray:
    bending, corners = shell.bending, shell.membrane.corners
    kinds, normal = bending.bent(places), shell.normals(places)
    # Of the normal: the part of its triangles that turns, over their size.
    faces = [places[corners[:, k]] for k in range(3)]
    size, turning = np.zeros((shell.count, 3)), np.zeros((shell.count, 3))
    np.add.at(size, corners.ravel(), np.repeat(np.cross(faces[1] - faces[0], faces[2] - faces[0]), 3, axis=0))
    rates = [velocities[corners[:, k]] for k in range(3)]
    rate = sum(np.cross(rates[k], faces[(k + 1) % 3] - faces[(k + 2) % 3]) for k in range(3))
    np.add.at(turning, corners.ravel(), np.repeat(rate, 3, axis=0))
    size = np.maximum(np.linalg.norm(size, axis=1), 1e-300)[:, None]
    turning = (turning - (turning * normal).sum(axis=1)[:, None] * normal) / size
    since = np.einsum("nkx,nx->nk", bending.bent(velocities), normal) + np.einsum("nkx,nx->nk", kinds, turning)
    flat, along = shell.flat[:, None], np.einsum("nkx,nx->nk", kinds, normal)
    moment = (1 - flat) * along + bending.delay[:, None] * since - shell.rest_curvature
    whole = flat[:, :, None] * kinds + moment[:, :, None] * normal[:, None, :]
    lean = np.einsum("nkx,nk->nx", kinds, moment)
    push = (lean - (lean * normal).sum(axis=1)[:, None] * normal) / size
    force = -bending.spread(whole)
    over = push[corners].sum(axis=1)
    for k in range(3):
        np.add.at(force, corners[:, k], -np.cross(faces[(k + 1) % 3] - faces[(k + 2) % 3], over))
    return force
