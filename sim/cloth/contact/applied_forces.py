"""What a cloth does to its own points, on the host."""

from __future__ import annotations

import numpy as np

from sim.cloth.fabric.mesh import ClothMesh, fold


def pulls(mesh: ClothMesh) -> np.ndarray:
    """Forces of springs and hinges, or of a shell, with their dampers on all points [N], shape [n, 3]."""
    place, speed = (array.to_numpy()[: mesh.count] for array in (mesh.points.position, mesh.points.velocity))
    force = np.zeros((mesh.count, 3))
    if mesh.shell is not None:
        from sim.cloth.shell.forces import pushes

        return pushes(mesh.shell, place, speed)
    one, other = mesh.ends.T
    apart = place[one] - place[other]
    length = np.linalg.norm(apart, axis=1)
    along = apart / np.maximum(length, 1e-300)[:, None]
    rate = (along * (speed[one] - speed[other])).sum(axis=1)
    pull = (mesh.stiffness * (length - mesh.rest) + mesh.damping * rate)[:, None] * along
    np.add.at(force, one, -pull)
    np.add.at(force, other, pull)
    if mesh.hinges:
        corners = mesh.corners.T
        angle, slopes = fold(*(place[corner] for corner in corners))
        turned = (angle - mesh.rest_angle + np.pi) % (2 * np.pi) - np.pi
        rate = sum((slope * speed[corner]).sum(axis=1) for slope, corner in zip(slopes, corners, strict=True))
        moment = mesh.rigidity * turned + mesh.bend_damping * rate
        for slope, corner in zip(slopes, corners, strict=True):
            np.add.at(force, corner, -moment[:, None] * slope)
    return force
