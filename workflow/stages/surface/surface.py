"""The surface of a cloud of particles, by splashsurf (Löschner et al. 2023)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pysplashsurf
from scipy.spatial import cKDTree

from workflow.stages.surface.boundary import Boundary
from workflow.stages.surface.drops import APART, alone, spray
from workflow.stages.surface.layers import whole_layers
from workflow.stages.surface.mesh import Surface, area_normals, at_corners
from workflow.stages.surface.solids import Solid
from workflow.stages.surface.spec import ReconstructSpec
from workflow.stages.surface.volume import right_drops, right_volume


def reconstruct(
    positions: np.ndarray,
    velocities: np.ndarray,
    spec: ReconstructSpec,
    *,
    numbers: np.ndarray | None = None,
    solids: Sequence[Solid] = (),
    threads: int = 1,
) -> Surface:
    """The surface of particles at `positions` [m] with `velocities` [m/s], float32, shape [n, 3]; n may be 0. It ends
    flush with the planes of `spec` and with `solids`. By their `numbers`, shape [n], particles are the same drops of
    spray in all frames; without them, by their order."""
    surface, spacing, count = spec.surface, 2 * spec.particle_radius, len(positions)
    if surface.layers.enabled:
        positions, velocities = whole_layers(positions, velocities, spacing, surface.layers, spec.walls)
    drops, lone = Surface.empty(), np.zeros(len(positions), bool)
    walls_alone = Boundary.around(positions[:0], spec.walls, (), spacing)
    if surface.drops:
        lone = alone(positions, max(2 * surface.smoothing_length, APART) * spec.particle_radius)
        # What fills gaps in layers comes behind the particles, and has no volume of its own.
        own = np.flatnonzero(lone[:count])
        number = own if numbers is None else numbers[own]
        made = spray(positions[own], velocities[own], number, spacing, surface.spray, spec.walls)
        drops, cut = walls_alone.flush(made[0], positions[:0])
    held = np.arange(len(positions))[~lone] < count
    positions, velocities = positions[~lone], velocities[~lone]
    boundary = Boundary.around(positions, spec.walls, solids, spacing)
    found = _found(*boundary.continued((positions, velocities)), spec, threads)
    found, on = boundary.flush(found, positions)
    if surface.volume:
        found = right_volume(
            found, on, positions[held], boundary.of(positions, held), surface.normals.smoothing_iterations
        )
        if lone.any():
            drops = right_drops(drops, cut, *made[1:], walls_alone)
    return found + drops


def _found(positions: np.ndarray, velocities: np.ndarray, spec: ReconstructSpec, threads: int) -> Surface:
    """What splashsurf finds, with normals and velocities that are finite everywhere."""
    if not len(positions):
        return Surface.empty()
    surface = spec.surface
    smoothing = surface.smoothing
    found, _ = pysplashsurf.reconstruction_pipeline(
        positions,
        attributes_to_interpolate={"velocity": velocities},
        particle_radius=spec.particle_radius,
        rest_density=spec.rest_density,
        smoothing_length=surface.smoothing_length,
        cube_size=surface.cube_size,
        iso_surface_threshold=surface.surface_threshold,
        multi_threading=threads > 1,
        mesh_smoothing_iters=smoothing.iterations or None,
        mesh_smoothing_weights=smoothing.weighted and smoothing.iterations > 0,
        mesh_smoothing_weights_normalization=smoothing.normalization,
        mesh_cleanup=surface.cleanup.enabled,
        mesh_cleanup_snap_dist=surface.cleanup.snap_distance,
        decimate_barnacles=surface.cleanup.decimate_barnacles,
        compute_normals=True,
        sph_normals=surface.normals.source == "particles",
        normals_smoothing_iters=surface.normals.smoothing_iterations or None,
    )
    attributes, mesh = found.point_attributes, found.mesh
    if not isinstance(mesh, pysplashsurf.TriMesh3d):
        raise TypeError("splashsurf made quadrilaterals, which nobody asked for")
    vertices = np.asarray(mesh.vertices, np.float32)
    triangles = np.asarray(mesh.triangles).astype(np.int32)
    normals = _finite(np.asarray(attributes["normals"], np.float32), vertices, triangles)
    seen = _seen(np.asarray(attributes["velocity"], np.float32), vertices, (positions, velocities))
    return Surface(vertices, normals, seen, triangles)


def _seen(interpolated: np.ndarray, vertices: np.ndarray, particles: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Velocities at the vertices. Smoothing takes vertices of a small void to where no particle is within the support
    radius, so that splashsurf has nothing to interpolate there: they move as the nearest particle does."""
    bad = ~np.isfinite(interpolated).all(axis=1)
    if not bad.any():
        return interpolated
    positions, velocities = particles
    _, nearest = cKDTree(positions).query(vertices[bad])
    found = interpolated.copy()
    found[bad] = velocities[nearest]
    return found


def _finite(normals: np.ndarray, vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """`normals` with those that splashsurf could not find, where triangles have no area, taken from the faces around:
    first weighted by area, then from vertices beside, at last upwards."""
    bad = ~np.isfinite(normals).all(axis=1)
    if not bad.any():
        return normals
    near = triangles[bad[triangles].any(axis=1)]
    linked = np.zeros(len(vertices), bool)
    linked[near] = True
    from_faces = area_normals(vertices, triangles[linked[triangles].any(axis=1)])
    beside = at_corners(from_faces[near].sum(axis=1), near, len(vertices))
    repaired = normals.copy()
    for candidate in (np.array([0.0, 1.0, 0.0]) + np.zeros(vertices.shape), beside, from_faces):
        length = np.linalg.norm(candidate, axis=1)
        use = bad & (length > np.finfo(np.float32).tiny)
        repaired[use] = candidate[use] / length[use, None]
    return repaired
