"""What the fluid meets of solids: boundary samples on their surfaces, and where it can not start."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from sim.fluid.calibration import SAMPLE_DEPTH
from sim.fluid.friction import find_grip, sample_friction_host
from sim.fluid.kernel import cubic_slope_host
from sim.fluid.samples import Samples
from sim.fluid.system import FluidSystem
from sim.fluid.walls import along_walls_host
from sim.geometry.distance import MeshDistance
from sim.geometry.edges import on_edges
from sim.geometry.offset import inset
from sim.geometry.sampling import sample_surface
from sim.geometry.solids import BoxSolid, Solid
from sim.obstacles import Obstacle, Obstacles

if TYPE_CHECKING:
    import trimesh


ROUNDED = 0.95
"""A surface moved along its normals is this share of the way off, or more."""
EDGE_ROOM = 0.6
"""Samples of the faces nearer than this many spacings to one behind an edge give way to it."""


def boundary_samples(obstacles: Obstacles, spacing: float, depth: float) -> Samples:
    """Samples of all surfaces, with the index in `obstacles.placed` as their owner.

    They lie `depth` [m] below the surface, on the side away from the fluid, so that fluid comes to
    rest on the surface itself, and no deeper behind sharp edges, which fluid would cut off otherwise.
    Those of bodies that move lie where the body is placed.
    """
    points, guarded, owner = [np.zeros((0, 3))], [np.zeros((0, 3))], [np.zeros(0, dtype=np.int32)]
    for index, item in enumerate(obstacles.placed):
        faces, rows, edges = _samples(item, spacing, depth)
        points += [faces, rows]
        guarded += [np.full(faces.shape, np.nan), edges]
        owner.append(np.full(len(faces) + len(rows), index, dtype=np.int32))
    return Samples(np.concatenate(points), np.concatenate(owner), np.concatenate(guarded))


def pivots(obstacles: Obstacles) -> dict[int, np.ndarray]:
    """The own origins [m] of the bodies that move, as they are placed, by their index in `obstacles.placed`."""
    return {index: item.motion.pivot for index, item in enumerate(obstacles.placed) if item.motion}


def motions(obstacles: Obstacles, origin: np.ndarray, time: float) -> np.ndarray:
    """How the bodies that move have moved by `time` [s], as `sim.fluid.moving` wants it: shape [bodies, MOTION].

    Coordinates are relative to `origin` [m].
    """
    from sim.fluid.moving import MOTION

    rows = [
        np.concatenate((now.rotation.ravel(), now.position - origin, now.velocity, now.angular_velocity))
        for now in (item.movement(time) for item in obstacles.placed)
        if now is not None
    ]
    return np.array(rows).reshape(-1, MOTION)


def allowed(obstacles: Obstacles, points: np.ndarray, clearance: float, time: float) -> np.ndarray:
    """Whether fluid can be at `points` [m], shape [n, 3], at `time` [s]: `clearance` off every solid; shape [n]."""
    free = np.ones(len(points), dtype=bool)
    for wall in obstacles.walls:
        free &= points @ wall.normal - wall.offset > clearance
    for item in obstacles.placed:
        placed, near = _placed(item, points, clearance, time)
        distance = np.full(len(points), np.inf)
        distance[near & free] = item.solid.signed_distance(placed[near & free])
        free &= (distance < -clearance) if item.hollow else (distance > clearance)
    return free


def off_samples(
    obstacles: Obstacles, points: np.ndarray, clearance: float, spacing: float, depth: float, time: float
) -> np.ndarray:
    """Whether `points` [m], shape [n, 3], are `depth` and `clearance` [m] off what is sampled at `time` [s]; shape [n].

    Thin bodies and edges have no room for samples that lie `depth` below the surface.
    """
    free = np.ones(len(points), dtype=bool)
    reach = ROUNDED * (depth + clearance)
    for item in obstacles.placed:
        placed, near = _placed(item, points, reach, time)
        near &= free
        free[near] &= _distance(_surface(item, depth), placed[near]) > reach
        rows, _ = _behind_edges(item, spacing, depth)
        if len(rows):
            nearest, _ = cKDTree(rows).query(placed[near], distance_upper_bound=reach)
            free[near] &= np.isinf(nearest)
    return free


def _placed(item: Obstacle, points: np.ndarray, reach: float, time: float) -> tuple[np.ndarray, np.ndarray]:
    """The points [m] as the placed body sees them, shape [n, 3], and which are within `reach` [m] of its box."""
    movement = item.movement(time)
    placed = movement.carry_back(points) if movement else points
    low, high = item.solid.bounds
    return placed, np.all((placed > low - reach) & (placed < high + reach), axis=1)


def _distance(surface: Solid | trimesh.Trimesh, points: np.ndarray) -> np.ndarray:
    """Distance [m] of points [m], shape [n, 3], to a surface; shape [n]."""
    if isinstance(surface, Solid):
        return np.abs(surface.signed_distance(points))
    return MeshDistance(surface).unsigned(points)


def _samples(item: Obstacle, spacing: float, depth: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Samples behind faces, those behind edges, and the points of the edges [m]; each of shape [n, 3]."""
    faces = sample_surface(_surface(item, depth), spacing)
    rows, edges = _behind_edges(item, spacing, depth)
    if not len(rows):
        return faces, rows, edges
    distance, _ = cKDTree(rows).query(faces)
    return faces[distance > EDGE_ROOM * spacing], rows, edges


def _behind_edges(item: Obstacle, spacing: float, depth: float) -> tuple[np.ndarray, np.ndarray]:
    """Samples behind edges, and the points of the edges that they stand behind [m]; both of shape [n, 3]."""
    if not item.solid.closed:
        return np.zeros((0, 3)), np.zeros((0, 3))
    # A row weighs less than a face: with a long support, for which faces lie deep, it has to stand nearer.
    behind = (depth + SAMPLE_DEPTH * spacing) / 2
    edges = on_edges(item.solid.mesh, spacing, convex=not item.hollow)
    return edges.points + (behind if item.hollow else -behind) * edges.behind, edges.points


def _surface(item: Obstacle, depth: float) -> Solid | trimesh.Trimesh:
    """The surface to be sampled, `depth` [m] below the one that the fluid meets."""
    solid = item.solid
    if not solid.closed:
        return solid
    if item.hollow:
        return inset(solid.mesh, -depth)
    if isinstance(solid, BoxSolid):
        size = solid.size - 2 * depth / solid.pose.scale
        return BoxSolid(solid.pose, solid.mesh, tuple(np.maximum(size, 1e-3 * solid.size)))
    return inset(solid.mesh, depth)


def reaction(system: FluidSystem, owner: int, centre: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force [N] and torque about `centre` [N m] of the fluid on the body with this index.

    Every pair of a particle and a sample acts on both with equal and opposite forces along one line (Akinci et
    al. 2012, eq. 9 and 11); coordinates and `centre` are relative to the world's origin.
    """
    samples, motion, volumes = system.boundary.of_body(owner)
    tree = cKDTree(samples)
    position = system.particles.numpy("position").astype(np.float64)
    velocity = system.particles.numpy("velocity").astype(np.float64)
    pairs = cKDTree(position[:, :3]).sparse_distance_matrix(tree, system.h, output_type="coo_matrix")
    d = position[pairs.row, :3] - samples[pairs.col]
    r = np.linalg.norm(d, axis=1)
    approach = ((velocity[pairs.row, :3] - motion[pairs.col]) * d).sum(axis=1)
    pressure, pressed = position[:, 3], None
    if hasattr(system.particles, "pressed"):
        pressed = system.particles.numpy("pressed").astype(np.float64)
        pressure = pressed[:, 3]
    slope = cubic_slope_host(r, system.h)
    strength = system.mass * system.spec.rest_density * volumes[pairs.col]
    push = (strength * pressure[pairs.row] * slope)[:, None] * d
    force = along_walls_host(position[pairs.row, :3], push, system.walls, system.h)
    damping = system.wall_damping * system.h / 2 * np.minimum(approach, 0.0)
    along = damping / (r**2 + 0.01 * system.h**2) / velocity[pairs.row, 3]
    grip = find_grip(system.spec)
    friction = grip.samples * sample_friction_host(r, approach, grip.nearest, system.h) / velocity[pairs.row, 3]
    along = along * slope + friction
    if system.spec.adhesion > 0:
        from sim.fluid.adhesion import adhesion_host, adhesion_strengths

        along -= adhesion_strengths(system)[0] * adhesion_host(r / system.h) / r / system.spec.rest_density
    force = force - (strength * along)[:, None] * d
    torque = np.cross(samples[pairs.col] - centre, force)
    total, turning = force.sum(axis=0), torque.sum(axis=0)
    for pushing, way in _pushes(system, position, pressed):
        # Each acts by the gradient where particles would have gone without it.
        before = position[:, :3] - way
        pairs = cKDTree(before).sparse_distance_matrix(tree, system.h, output_type="coo_matrix")
        d = before[pairs.row] - samples[pairs.col]
        along = pushing[pairs.row] * cubic_slope_host(np.linalg.norm(d, axis=1), system.h)
        push = (system.mass * system.spec.rest_density * volumes[pairs.col] * along)[:, None] * d
        force = along_walls_host(before[pairs.row], push, system.walls, system.h)
        total = total + force.sum(axis=0)
        turning = turning + np.cross(samples[pairs.col] - centre, force).sum(axis=0)
    return total, turning


def _pushes(
    system: FluidSystem, position: np.ndarray, pressed: np.ndarray | None
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Pressures as q that were found for a whole step, and the way [m] of particles since they were looked for."""
    if pressed is None:
        return []
    if not hasattr(system.particles, "corrected"):
        return [(position[:, 3], pressed[:, :3])]
    corrected = system.particles.numpy("corrected").astype(np.float64)
    return [(position[:, 3] - corrected[:, 3], pressed[:, :3]), (corrected[:, 3], corrected[:, :3])]
