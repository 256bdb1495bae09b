"""The surface of a cloud of particles, by splashsurf (Löschner, Böttcher, Jeske & Bender 2023)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pysplashsurf

from workflow.layers import whole_layers
from workflow.surface_spec import ReconstructSpec
from workflow.walls import continued, flush


@dataclass(frozen=True)
class Surface:
    """A closed triangle mesh."""

    vertices: np.ndarray
    """Positions [m], float32, shape [n, 3]."""
    normals: np.ndarray
    """Unit vectors out of the fluid, float32, shape [n, 3]."""
    velocities: np.ndarray
    """Of the fluid at the vertices [m/s], float32, shape [n, 3]."""
    triangles: np.ndarray
    """Indices of vertices, counter-clockwise from outside, int32, shape [m, 3]."""

    @property
    def volume(self) -> float:
        """Enclosed volume [m^3], by the divergence theorem."""
        if not len(self.triangles):
            return 0.0
        origin = self.vertices.mean(axis=0, dtype=np.float64)
        a, b, c = np.moveaxis(self.vertices[self.triangles].astype(np.float64) - origin, 1, 0)
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def reconstruct(positions: np.ndarray, velocities: np.ndarray, spec: ReconstructSpec, *, threads: int = 1) -> Surface:
    """The surface of particles at `positions` [m] with `velocities` [m/s], float32, shape [n, 3]; n may be 0."""
    surface = spec.surface
    smoothing = surface.smoothing
    if not len(positions):
        nothing = np.empty((0, 3), np.float32)
        return Surface(nothing, nothing, nothing, np.empty((0, 3), np.int32))
    if surface.layers.enabled:
        positions, velocities = whole_layers(positions, velocities, 2 * spec.particle_radius, surface.layers)
    positions, velocities = continued((positions, velocities), 2 * spec.particle_radius, spec.walls)
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
    attributes = found.point_attributes
    vertices = np.asarray(found.mesh.vertices, np.float32)
    triangles = np.asarray(found.mesh.triangles).astype(np.int32)
    normals = _finite(np.asarray(attributes["normals"], np.float32), vertices, triangles)
    return Surface(*flush(vertices, normals, np.asarray(attributes["velocity"], np.float32), spec.walls), triangles)


def _finite(normals: np.ndarray, vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """`normals` with those that splashsurf could not find, where triangles have no area, taken from the faces around:
    first weighted by area, then from vertices beside, at last upwards."""
    bad = ~np.isfinite(normals).all(axis=1)
    if not bad.any():
        return normals
    corners = vertices[triangles].astype(np.float64)
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    from_faces = np.zeros(vertices.shape)
    for corner in range(3):
        np.add.at(from_faces, triangles[:, corner], areas)
    beside = np.zeros(vertices.shape)
    for corner in range(3):
        np.add.at(beside, triangles[:, corner], from_faces[triangles].sum(axis=1))
    repaired = normals.copy()
    for candidate in (np.array([0.0, 1.0, 0.0]) + np.zeros(vertices.shape), beside, from_faces):
        length = np.linalg.norm(candidate, axis=1)
        use = bad & (length > np.finfo(np.float32).tiny)
        repaired[use] = candidate[use] / length[use, None]
    return repaired
