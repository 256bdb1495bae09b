"""What bodies are to contacts: a field of distances around each, and features that are looked up in others' fields.

A feature is a point, a segment or a circle, rounded by a radius: a sphere is a rounded point, a capsule a rounded
segment, a torus a rounded circle, a cylinder its two rims, and to other cylinders its rounded axis without the ends, a
box its corners and edges, a mesh its vertices and samples of its faces and edges.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial import cKDTree

from sim.geometry import cache, thinning
from sim.geometry.distance import closest_points, sdf
from sim.geometry.distance.sdf import GRID, PLANE
from sim.geometry.meshes import edges, normal_cones, winding
from sim.geometry.primitives import primitive
from sim.geometry.solids import Solid

POINT, SEGMENT, CIRCLE, AXIS = range(4)
CELLS = 64
"""Of a mesh's grid of distances along its longest side."""
ROUNDED = 2.0**-36
"""Share of a mesh's size to which its vertices count."""
RIM = 3
"""Cells of a grid beyond its mesh, on each side."""


@dataclass
class Features:
    """Columns of equal length; coordinates in the body's own frame."""

    kind: list[int] = field(default_factory=list)
    centre: list[np.ndarray] = field(default_factory=list)
    """[m], shape [3]."""
    direction: list[np.ndarray] = field(default_factory=list)
    """From the centre of a segment or axis to its end [m], or (R, 0, 0) of a circle about y with the radius R."""
    rounding: list[float] = field(default_factory=list)
    """[m]"""
    cone: list[np.ndarray] = field(default_factory=list)
    """Of the directions in which the surface faces there (normal_cones), shape [4]."""

    def add(
        self,
        kind: int,
        centre: np.ndarray,
        direction: np.ndarray | None = None,
        rounding: float = 0.0,
        cone: np.ndarray | None = None,
    ) -> None:
        """Append one; without `direction` it is a point, and without `cone` the surface may face anywhere there."""
        self.kind.append(kind)
        self.centre.append(np.asarray(centre, dtype=float))
        self.direction.append(np.zeros(3) if direction is None else np.asarray(direction, dtype=float))
        self.rounding.append(rounding)
        self.cone.append(np.array(normal_cones.ANY) if cone is None else cone)


@dataclass(frozen=True)
class Grid:
    """Distances [m] at the corners of cubic cells, shape [x, y, z], from the corner `low` [m] on."""

    low: np.ndarray
    cell: float
    values: np.ndarray


@dataclass(frozen=True)
class ContactShape:
    """A shape in its own frame: the axes are its own, the origin is `origin` in the world as it is placed."""

    kind: int
    size: np.ndarray
    """Of a box its half edges, else radius and half length, or both radii of a torus [m], shape [3]."""
    features: Features
    origin: np.ndarray
    turn: np.ndarray
    """Rotation of its own axes as it is placed, shape [3, 3]."""
    bounds: np.ndarray
    """Box around it in its own frame [m], shape [2, 3]."""
    grid: Grid | None = None
    hollow: bool = False
    """Whether the solid is what the shape leaves free."""

    @property
    def reach(self) -> float:
        """Greatest distance from the origin [m]."""
        return float(np.linalg.norm(np.abs(self.bounds).max(axis=0)))


def plane_shape(normal: np.ndarray, offset: float) -> ContactShape:
    """The half-space normal . x < offset."""
    other = np.eye(3)[np.abs(normal).argmin()]
    side = np.cross(normal, other) / np.linalg.norm(np.cross(normal, other))
    turn = np.column_stack((side, normal, np.cross(side, normal)))
    endless = np.array([np.full(3, -np.inf), np.full(3, np.inf)])
    return ContactShape(PLANE, np.zeros(3), Features(), offset * normal, turn, endless)


def contact_shape(solid: Solid, *, hollow: bool = False) -> ContactShape:
    """The shape of a placed solid: of one without closed forms its surface as a mesh, which is thinned if it is large.

    Raises TypeError for a kind of primitive whose features are not known here: it would meet nothing.
    """
    shape, features = primitive(solid), Features()
    if shape.kind == GRID:
        return _mesh_shape(solid, hollow)
    radius, length = shape.size[:2]
    match shape.kind:
        case sdf.SPHERE:
            features.add(POINT, np.zeros(3), rounding=radius)
        case sdf.BOX:
            _add_box(features, shape.half)
        case sdf.CAPSULE:
            features.add(SEGMENT, np.zeros(3), np.array([0, length, 0]), radius)
        case sdf.CYLINDER:
            for end in (length, -length):
                features.add(CIRCLE, np.array([0, end, 0]), np.array([radius, 0, 0]))
            features.add(AXIS, np.zeros(3), np.array([0, length, 0]), radius)
        case sdf.TORUS:
            features.add(CIRCLE, np.zeros(3), np.array([radius, 0, 0]), length)
        case _:
            raise TypeError(f"bodies cannot meet a {type(solid).__name__}: contact_shape does not know its features")
    bounds = np.array([-shape.half, shape.half])
    return ContactShape(shape.kind, shape.size, features, shape.origin, shape.turn, bounds, hollow=hollow)


def _add_box(features: Features, half: np.ndarray) -> None:
    signs = np.array([[1 - 2 * ((corner >> axis) & 1) for axis in range(3)] for corner in range(8)])
    for corner in signs:
        features.add(POINT, corner * half)
    for axis in range(3):
        for corner in signs[signs[:, axis] > 0]:
            centre = corner * half
            centre[axis] = 0
            features.add(SEGMENT, centre, np.eye(3)[axis] * half)


def _mesh_shape(solid: Solid, hollow: bool) -> ContactShape:
    """In the mesh's own frame as scaled, the origin in the middle of its bounding box."""
    mesh, turn, scale = solid.mesh, solid.pose.rotation, solid.pose.scale
    if mesh is None:
        raise TypeError(f"bodies cannot meet a {type(solid).__name__}: it has neither closed forms nor a surface")
    local = _rounded((np.asarray(mesh.vertices, dtype=np.float64) - solid.pose.position) @ turn)
    low, high = local.min(axis=0), local.max(axis=0)
    middle, half = (low + high) / 2, (high - low) / 2
    faces = np.asarray(mesh.faces)
    cell = float(2 * half.max()) / CELLS
    stored = cache.cached(
        "contact_shape",
        lambda: _measured(local - middle, faces, cell),
        arguments={"cell": cell, "rim": RIM},
        arrays=[local, faces],
        sources=[__file__, *(str(used.__file__) for used in (closest_points, edges, normal_cones, thinning, winding))],
        packages=("libigl", "numpy", "scipy", "trimesh"),
    )
    features = Features()
    out = np.array([-1, -1, -1, 1]) if hollow else np.ones(4)
    for point, cone in zip(stored["points"], stored["cones"], strict=True):
        features.add(POINT, point, cone=out * cone)
    origin = solid.pose.position + turn @ middle
    grid = Grid(stored["low"], cell, stored["values"])
    bounds = np.array([-half, half])
    return ContactShape(GRID, np.full(3, scale), features, origin, turn, bounds, grid, hollow)


def _rounded(vertices: np.ndarray) -> np.ndarray:
    """The same wherever the mesh is placed, so that what is known of it is found in the cache."""
    unit = ROUNDED * 2.0 ** np.ceil(np.log2(np.ptp(vertices, axis=0).max()))
    return unit * np.round(vertices / unit)


def _measured(vertices: np.ndarray, faces: np.ndarray, cell: float) -> cache.Arrays:
    """Distances around a mesh on a grid, and points of its surface: all vertices of its convex hull, which are what
    touches planes, and samples a cell apart of all else, sharp edges first; with the cones of their directions."""
    import trimesh

    mesh = trimesh.Trimesh(vertices, faces, process=False)
    low = vertices.min(axis=0) - RIM * cell
    size = np.ceil((vertices.max(axis=0) + RIM * cell - low) / cell) + 1
    shape = int(size[0]), int(size[1]), int(size[2])
    axes = [low[axis] + cell * np.arange(shape[axis]) for axis in range(3)]
    corners = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    away = closest_points.MeshDistance(mesh).unsigned(corners).reshape(shape)
    inside = winding.WindingNumber(mesh).on_lattice(low, cell, shape) > 0
    hull = mesh.convex_hull.vertices if len(vertices) > 4 else vertices
    sharp = edges.on_edges(mesh, cell)
    surface, face, _ = closest_points.cover(vertices[faces], int(mesh.area / cell**2))
    points = np.concatenate((hull, sharp.points, vertices, surface))
    at_vertex, between = normal_cones.of_vertices(mesh), normal_cones.of_edges(mesh, sharp.faces)
    at_sharp = np.where(sharp.vertex[:, None] < 0, between, at_vertex[sharp.vertex])
    at_hull = at_vertex[cKDTree(vertices).query(hull)[1]]
    cones = np.concatenate((at_hull, at_sharp, at_vertex, normal_cones.smooth(mesh)[face]))
    kept = thinning.first_come(points[len(hull) :], 0.7 * cell) + len(hull)
    kept = np.concatenate((np.arange(len(hull)), kept))
    values = np.where(inside, -away, away).astype(np.float32)
    return {"values": values, "low": low, "points": points[kept], "cones": normal_cones.rounded(cones[kept])}
