"""Open surfaces without thickness, as vessels are modelled, and how they go into files."""

from __future__ import annotations

import numpy as np
import trimesh


def revolved(profile: np.ndarray, sections: int = 96) -> trimesh.Trimesh:
    """The open surface swept about y by a profile of (radius, y), shape [n, 2]."""
    profile = np.asarray(profile, dtype=float)
    angle = 2 * np.pi * np.arange(sections) / sections
    vertices = np.stack(
        (
            profile[:, :1] * np.cos(angle),
            np.broadcast_to(profile[:, 1:], (len(profile), sections)),
            profile[:, :1] * np.sin(angle),
        ),
        axis=-1,
    )
    index = np.arange(len(profile) * sections).reshape(len(profile), sections)
    index[profile[:, 0] == 0] = index[profile[:, 0] == 0][:, :1]
    ahead = np.roll(index, -1, axis=1)
    quads = np.stack((index[:-1], index[1:], ahead[1:], ahead[:-1]), axis=-1).reshape(-1, 4)
    faces = np.concatenate((quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]))
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    used, faces = np.unique(faces, return_inverse=True)
    return trimesh.Trimesh(vertices.reshape(-1, 3)[used], faces.reshape(-1, 3), process=False)


def bowl(radius: float = 1.0, parts: int = 24) -> trimesh.Trimesh:
    """The lower half of a sphere."""
    angle = np.linspace(0, np.pi / 2, parts + 1)
    profile = radius * np.column_stack((np.sin(angle), -np.cos(angle)))
    profile[-1, 1] = 0.0
    return revolved(profile)


def tray(size: tuple[float, float, float] = (2.0, 1.0, 3.0)) -> trimesh.Trimesh:
    """A box without its top."""
    box = trimesh.creation.box(size)
    return trimesh.Trimesh(box.vertices, box.faces[box.face_normals[:, 1] < 0.5], process=False)


def bottle() -> trimesh.Trimesh:
    """200 mm high, 74 mm wide, with a neck of 20 mm: its mouth is a half of a per cent of its surface."""
    profile = [(0, 0), (18, 0), (37, 0), (37, 40), (37, 80), (37, 120), (25, 140), (10, 155), (10, 180), (10, 200)]
    return revolved(np.array(profile) / 1000)
