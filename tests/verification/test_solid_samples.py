"""Boundary samples guard the whole surface, its edges and corners too.

A particle without neighbours is pushed by a solid when its density exceeds the rest density: what it adds itself,
m W(0), and what the samples add, rho0 sum V_b W. Where that reaches rho0 on the surface itself, nothing gets inside.
"""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from sim.fluid.calibration import lack, sample_depth
from sim.fluid.kernel import cubic_host, particle_mass
from sim.fluid.samples import Samples
from sim.obstacles import find_obstacles
from sim.spec import SimulationSpec
from tests.sharp_bodies import SPACING, sharp_bodies

pytestmark = pytest.mark.usefixtures("taichi")
RATIOS = (3.0, 4.0, 4.5, 5.0, 6.0)
"""Support radius over the particle radius."""


def lone_density(points, samples, h):
    """Density over the rest density of a particle alone at each of the points."""
    volumes = samples.volumes(np.arange(len(samples.points)), SPACING, h)
    pairs = cKDTree(points).sparse_distance_matrix(cKDTree(samples.points), h, output_type="coo_matrix")
    share = np.bincount(pairs.row, volumes[pairs.col] * cubic_host(pairs.data, h), minlength=len(points))
    return share + particle_mass(SPACING, h, 1.0) * cubic_host(np.zeros(1), h)[0]


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("name", ["plate", "box", "edge up", "wedge", "spike"])
def test_a_lone_particle_is_pushed_out_wherever_it_meets_the_surface(tmp_path, name, ratio):
    from sim.coupling.fluid_rigid import boundary_samples

    spec = SimulationSpec.model_validate({"rigid": {"bodies": {"body": sharp_bodies(tmp_path)[name]}}})
    obstacles = find_obstacles(spec, tmp_path)
    mesh = obstacles.placed[0].solid.mesh
    h = ratio * SPACING / 2
    samples = boundary_samples(obstacles, SPACING, sample_depth(SPACING, h))
    on_faces, _ = trimesh.sample.sample_surface(mesh, 5000, seed=1)
    along = np.linspace(0, 1, 50)[:, None]
    edges = mesh.face_adjacency_edges[mesh.face_adjacency_angles > 0.7]
    on_edges = [(1 - along) * mesh.vertices[a] + along * mesh.vertices[b] for a, b in edges]
    assert lone_density(np.concatenate([on_faces, *on_edges]), samples, h).min() >= 1.0


@pytest.mark.parametrize("ratio", RATIOS)
def test_a_lattice_at_rest_has_the_rest_density(ratio):
    """Half a spacing off a plane that samples lie behind in a square lattice, whatever the support."""
    h = ratio * SPACING / 2
    axis = np.arange(-8, 9) * SPACING
    x, z = np.meshgrid(axis, axis)
    flat = np.column_stack((x.ravel(), np.zeros(x.size), z.ravel()))
    above = np.array([[0, sample_depth(SPACING, h) + 0.5 * SPACING, 0]])
    own = particle_mass(SPACING, h, 1.0) * cubic_host(np.zeros(1), h)[0]
    assert lone_density(above, Samples.of_faces(flat), h)[0] - own == pytest.approx(lack(SPACING, h).density, rel=1e-3)


@pytest.mark.parametrize("thickness", [1.0, 1.5, 6.0])
@pytest.mark.parametrize("motion", ["static", "dynamic"])
def test_a_body_on_another_does_not_count_twice(tmp_path, motion, thickness):
    """What lies under a plate of a spacing or more is too far for the first layer on top of it."""
    from sim.coupling.fluid_rigid import boundary_samples

    size, h = thickness * SPACING, 2 * SPACING
    axis = np.linspace(-1, 1, 5) * SPACING
    first = np.array([[x, 0.5 * SPACING, z] for x in axis for z in axis])

    def density(number):
        plates = {
            f"plate{k}": {
                "shape": {"type": "box", "size": [0.6, size, 0.6]},
                "position": [0, -(k + 0.5) * size, 0],
                "motion": motion,
                "density": 500,
            }
            for k in range(number)
        }
        spec = SimulationSpec.model_validate({"rigid": {"bodies": plates}})
        samples = boundary_samples(find_obstacles(spec, tmp_path), SPACING, sample_depth(SPACING, h))
        of_each = [
            Samples(samples.points[mine], samples.owner[mine], samples.guarded[mine])
            for mine in (samples.owner == owner for owner in range(number))
        ]
        return sum(lone_density(first, one, h) - own for one in of_each)

    own = particle_mass(SPACING, h, 1.0) * cubic_host(np.zeros(1), h)[0]
    assert density(2) == pytest.approx(density(1), rel=0.01)
