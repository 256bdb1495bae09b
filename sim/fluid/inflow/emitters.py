"""Outlets: where the layers of particles begin that an emitter sends."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scene import assets
from scene.settings import Refused, given
from sim.fluid.spec import Disc, Emitter, Fluid, Rectangle
from sim.geometry.pose import Pose
from sim.geometry.shapes import load_mesh
from sim.geometry.spec import MeshFace

EDGE = 1e-3
"""Share of the spacing by which an edge may miss a multiple of it: lengths are typed with few digits."""


@dataclass(frozen=True)
class Outlet:
    """The outlet of one emitter, and the square lattice of a layer of particles in it.

    centre: middle of the lattice [m], shape [3]; axes: unit vectors across, forward and across, shape [3, 3];
    cells: the lattice's points as row and column, shape [n, 2]; grid: number of rows and columns.
    """

    name: str
    location: tuple[str | int, ...]
    centre: np.ndarray
    axes: np.ndarray
    cells: np.ndarray
    grid: tuple[int, int]
    speed: float
    spacing: float
    nozzle: float
    """How far the particles are led straight on [m]."""
    start: float
    stop: float

    @functools.cached_property
    def points(self) -> np.ndarray:
        """The particles of a layer as its back leaves the outlet, half a spacing beyond it [m], shape [n, 3]."""
        across = _offsets(self.cells, self.grid, self.spacing)
        return self.centre + across @ self.axes[[0, 2]] + self.spacing / 2 * self.direction

    @property
    def direction(self) -> np.ndarray:
        """Unit vector along which particles leave, shape [3]."""
        return self.axes[1]

    @property
    def velocity(self) -> np.ndarray:
        """[m/s], shape [3]"""
        return self.speed * self.direction

    @property
    def rate(self) -> float:
        """[m^3/s]"""
        return len(self.cells) * self.spacing**2 * self.speed

    @property
    def particle_rate(self) -> float:
        """[1/s]"""
        return len(self.cells) * self.speed / self.spacing

    @functools.cached_property
    def lane(self) -> np.ndarray:
        """Where particles are led [m], every half spacing, shape [m, 3]."""
        ways = np.arange(0.0, self.nozzle - EDGE * self.spacing, self.spacing / 2)
        return (self.points + ways[:, None, None] * self.direction).reshape(-1, 3)

    @property
    def bounds(self) -> np.ndarray:
        """Box around the particles that are led [m], shape [2, 3]."""
        return np.array([self.lane.min(axis=0), self.lane.max(axis=0)])

    def distance(self, begin: float, end: float) -> float:
        """How far it lets fluid move [m] from one time to another [s]."""
        return self.speed * max(0.0, min(end, self.stop) - max(begin, self.start))


def find_outlet(name: str, emitter: Emitter, fluid: Fluid, folder: Path, location: tuple[str | int, ...]) -> Outlet:
    """Place an emitter; raises Refused for a shape that is too small, or a mesh without such a face."""
    pose, spacing = Pose.of(emitter), fluid.spacing
    try:
        centre, axes, cells, grid = _lattice(emitter.shape, pose, fluid, folder)
    except Refused as refused:
        raise refused.at(*location, "shape") from None
    if not len(cells):
        raise Refused(
            f"the outlet of '{name}' is smaller than one particle, {spacing:.3g} m",
            location=(*location, "shape"),
            remedy="make it larger, or use a smaller particle_radius",
        )
    return Outlet(
        name,
        location,
        centre,
        axes,
        cells,
        grid,
        emitter.speed if emitter.speed is not None else given(emitter.rate) / (len(cells) * spacing**2),
        spacing,
        fluid.support_radius,
        emitter.start,
        math.inf if emitter.stop is None else emitter.stop,
    )


def _lattice(shape: Disc | Rectangle | MeshFace, pose: Pose, fluid: Fluid, folder: Path):
    """Centre, axes, cells and grid of an Outlet."""
    spacing, most = fluid.spacing, fluid.max_particles
    match shape:
        case Disc():
            return pose.position, pose.rotation.T, *_disc(shape.radius * pose.scale, spacing, most)
        case Rectangle():
            along, across = (int(size * pose.scale / spacing + EDGE) for size in shape.size)
            grid = along, across
            return pose.position, pose.rotation.T, _cells(grid, most), grid
    triangles, axes = _face(shape, pose, folder)
    flat = (triangles - triangles[0, 0]) @ axes[[0, 2]].T
    low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
    centre = triangles[0, 0] + (low + high) / 2 @ axes[[0, 2]]
    along, across = (_across(size, spacing) for size in high - low)
    grid = along, across
    cells = _cells(grid, most)
    return centre, axes, cells[_inside(flat - (low + high) / 2, _offsets(cells, grid, spacing))], grid


def _disc(radius: float, spacing: float, most: int) -> tuple[np.ndarray, tuple[int, int]]:
    """Cells and grid, around one point or between four, whichever covers the area better."""
    least = _across(2 * radius, spacing)
    if not least:
        return _cells((0, 0), most), (0, 0)
    choices = []
    for grid in ((least, least), (least + 1, least + 1)):
        cells = _cells(grid, most)
        choices.append((cells[np.hypot(*_offsets(cells, grid, spacing).T) <= radius], grid))
    return min(choices, key=lambda choice: abs(len(choice[0]) * spacing**2 - math.pi * radius**2))


def _across(length: float, spacing: float) -> int:
    """Points of a lattice along a length that is not filled with whole cells; none where it is less than one."""
    return math.ceil(length / spacing - EDGE) if length > (1 - EDGE) * spacing else 0


def _cells(grid: tuple[int, int], most: int) -> np.ndarray:
    """Rows and columns of all points of the grid, shape [n, 2]; raises Refused for more points than `most`."""
    if math.prod(grid) > most:
        raise Refused(
            f"a layer of {grid[0]:,} times {grid[1]:,} particles is more than fluid.max_particles = {most:,}",
            remedy="make the outlet smaller, or use a larger particle_radius",
        )
    return np.argwhere(np.ones(grid, dtype=bool))


def _offsets(cells: np.ndarray, grid: tuple[int, int], spacing: float) -> np.ndarray:
    """Distances of the cells from the middle of the grid [m], shape [n, 2]."""
    return (cells - (np.array(grid) - 1) / 2) * spacing


def _face(shape: MeshFace, pose: Pose, folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """The triangles of a face in the world [m], shape [n, 3, 3], and the unit vectors along the longest edge of its
    outline, along its normal, and across both, shape [3, 3]."""
    try:
        mesh, _ = load_mesh(shape, assets.resolve(shape.file, folder), closed=False)
    except Refused as refused:
        raise refused.at("file") from None
    if shape.face >= len(mesh.faces):
        raise Refused(
            f"the mesh has {len(mesh.faces)} triangles",
            location=("face",),
            remedy=f"give a number from 0 to {len(mesh.faces) - 1}",
        )
    plane = next((facet for facet in mesh.facets if shape.face in facet), ())
    faces = mesh.faces[[shape.face, *(face for face in plane if face != shape.face)]]
    triangles = pose.to_world(mesh.vertices[faces.reshape(-1)]).reshape(-1, 3, 3)
    # An edge is of the outline where no other triangle has it, the other way round.
    edges = {
        (face[k - 1], face[k]): triangle[k] - triangle[k - 1]
        for face, triangle in zip(faces.tolist(), triangles, strict=True)
        for k in range(3)
    }
    along = max((edge for (a, b), edge in edges.items() if (b, a) not in edges), key=np.linalg.norm)
    forward = np.cross(*np.diff(triangles[0], axis=0))
    along, forward = along / np.linalg.norm(along), forward / np.linalg.norm(forward)
    return triangles, np.array([along, forward, np.cross(along, forward)])


def _inside(triangles: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Whether points, shape [n, 2], lie in any of the triangles, shape [m, 3, 2]; shape [n]."""
    found = np.zeros(len(points), dtype=bool)
    for a, b, c in triangles:
        sides = [_side(points, *edge) for edge in ((a, b), (b, c), (c, a))]
        found |= np.logical_and.reduce([side >= 0 for side in sides])
        found |= np.logical_and.reduce([side <= 0 for side in sides])
    return found


def _side(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Twice the signed area of the triangle of an edge and each point."""
    return (b[0] - a[0]) * (points[:, 1] - a[1]) - (b[1] - a[1]) * (points[:, 0] - a[0])
