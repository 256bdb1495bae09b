"""A cone of 64 sides."""

import trimesh
from outside.cone import SECTIONS


def triangles(shape):
    cone = trimesh.creation.cone(shape.radius, shape.height, sections=SECTIONS)
    cone.apply_transform([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    return cone
