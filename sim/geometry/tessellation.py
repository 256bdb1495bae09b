"""Triangles of shapes that have closed forms."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from common.registry import load
from sim.geometry import cache
from sim.geometry.spec import Box, Capsule, Cylinder, Sheet, Sphere, Torus
from sim.geometry.triangles import Triangles

if TYPE_CHECKING:
    import trimesh

# Largest gap between a curved surface and its triangles, over its radius.
_CHORD_ERROR = 1e-3


def tessellate(shape, *, chord_error: float = _CHORD_ERROR) -> Triangles:
    """Triangles of a shape in its own frame [m]: watertight and outward, or an open rectangle for a sheet; of a shape
    that an installed package adds, what its implementation makes of it.

    All vertices lie on the surface; triangles are within about `chord_error` times the radius of it.
    """
    match shape:
        case Box():
            return _scaled("box", np.array(shape.size))
        case Sheet():
            x, z = np.array(shape.size) / 2
            corners = np.array([[-x, 0, -z], [-x, 0, z], [x, 0, z], [x, 0, -z]])
            return Triangles(corners, np.array([[0, 1, 2], [0, 2, 3]]))
        case Sphere():
            # The longest edge of an icosphere is 1.18 r / 2^n; the gap of a triangle edge^2 / (6 r).
            halvings = np.log2(1.18 / np.sqrt(6 * chord_error))
            return _scaled("icosphere", np.array(shape.radius), subdivisions=max(0, int(np.ceil(halvings))))
        case Cylinder():
            half = shape.height / 2
            profile = np.array([[0.0, -half], [shape.radius, -half], [shape.radius, half], [0.0, half]])
            return _revolved(profile, chord_error)
        case Capsule():
            angle = np.linspace(-np.pi / 2, np.pi / 2, 2 * _segments(np.pi / 2, chord_error) + 1)
            end = np.sign(angle) * shape.height / 2
            profile = shape.radius * np.column_stack([np.cos(angle), np.sin(angle)])
            profile[:, 1] += end
            equator = len(angle) // 2
            profile = np.insert(profile, equator, profile[equator], axis=0)
            profile[[equator, equator + 1], 1] = -shape.height / 2, shape.height / 2
            profile[[0, -1], 0] = 0.0
            return _revolved(profile, chord_error)
        case Torus():
            angle = np.linspace(0, 2 * np.pi, _segments(2 * np.pi, chord_error) + 1)[:-1]
            tube = shape.tube_radius * np.column_stack([np.cos(angle), np.sin(angle)])
            tube[:, 0] += shape.radius
            return _revolved(tube, chord_error, ring=True)
    make: Callable[..., trimesh.Trimesh] = load(shape.IMPLEMENTATION)
    return Triangles.of(make(shape))


def _scaled(name: str, by: np.ndarray, **arguments: int) -> Triangles:
    """A shape of edge or radius 1 that trimesh.creation makes, `by` times as large [m]."""
    unit = _unit(name, **arguments)
    return Triangles(unit["vertices"] * by, unit["faces"].copy())


@functools.cache
def _unit(name: str, **arguments: int) -> cache.Arrays:
    def compute() -> cache.Arrays:
        import trimesh

        mesh = getattr(trimesh.creation, name)(**arguments)
        return {"vertices": np.asarray(mesh.vertices), "faces": np.asarray(mesh.faces)}

    # Kept, since to load trimesh takes longer than to start many a scene.
    return cache.cached(name, compute, arguments=arguments, arrays=[], sources=[], packages=("numpy", "trimesh"))


def _segments(angle: float, chord_error: float) -> int:
    """Chords of an arc of `angle` [rad] whose gap is `chord_error` of the radius: r (1 - cos(angle / 2n))."""
    return max(3, int(np.ceil(angle / (2 * np.arccos(1 - chord_error)))))


def _revolved(profile: np.ndarray, chord_error: float, *, ring: bool = False) -> Triangles:
    """The closed surface swept by a profile of (radius, y), upward, about y; both ends on the axis, or a ring."""
    number, sections = len(profile), _segments(2 * np.pi, chord_error)
    angle = np.arange(sections) * (2 * np.pi / sections)
    vertices = np.empty((sections, number, 3))
    vertices[..., 0] = profile[:, 0] * np.cos(angle)[:, None]
    vertices[..., 1] = profile[:, 1]
    vertices[..., 2] = profile[:, 0] * np.sin(angle)[:, None]
    index = np.arange(sections * number).reshape(sections, number)
    if not ring:
        # All sections share the two poles.
        index[:, [0, -1]] = index[0, [0, -1]]
    ahead = np.roll(index, -1, axis=0)
    above, above_ahead = (np.roll(part, -1, axis=1) for part in (index, ahead))
    quads = np.stack([index, above, above_ahead, ahead], axis=-1)[:, : None if ring else -1].reshape(-1, 4)
    faces = np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    proper = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    used, faces = np.unique(faces[proper], return_inverse=True)
    return Triangles(vertices.reshape(-1, 3)[used], faces.reshape(-1, 3))
