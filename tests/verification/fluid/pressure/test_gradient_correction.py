"""Corrected gradients and hyperviscosity, for particles in disorder: what is exact, whatever their arrangement.

Linear velocities v = A x have the divergence tr A (Bonet & Lok 1999), next to a wall too, if the wall moves as they say
there. Accelerations by pressure are the adjoint of the rate of compression, so that momentum and angular momentum stay.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.fluid.systems import load

SPACING, LAYERS, DT = 0.02, 10, 1e-3
H = 2 * SPACING
SHEAR = np.array([[0.3, 1.0, -0.4], [0.2, -0.8, 0.5], [-0.7, 0.1, 0.9]])
"""A velocity gradient [1/s] whose trace is not nought."""
WALL = {"plane": {"shape": {"type": "plane", "normal": [0, 1, 0]}, "position": [0, 0, 0], "motion": "static"}}
SIDE = {"side": {"shape": {"type": "plane", "normal": [1, 0, 0]}, "position": [0, 0, 0], "motion": "static"}}


def block(rng: np.random.Generator, disorder: float = 0.2) -> np.ndarray:
    """Points [m] above y = 0, moved from a lattice by up to this share of a spacing."""
    axis = SPACING * (np.arange(LAYERS) + 0.5)
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    return points + disorder * SPACING * rng.uniform(-1, 1, points.shape)


def system_of(x: np.ndarray, v: np.ndarray, gravity: np.ndarray, tmp_path, *, wall: bool | dict):
    """A system with DFSPH's arrays, its solver, and the velocities as particles lie."""
    from sim.bodies.obstacles import find_obstacles
    from sim.coupling.fluid_solids import boundary_solids
    from sim.fluid.boundary.boundary import Boundary
    from sim.fluid.boundary.shapes import Shapes
    from sim.fluid.pressure.dfsph import Dfsph
    from sim.fluid.spec import Fluid
    from sim.fluid.system import FluidSystem
    from sim.spec import SimulationSpec

    spec = Fluid(particle_radius=SPACING / 2, solver="dfsph")
    bodies = {"rigid": {"bodies": wall if isinstance(wall, dict) else WALL}} if wall else {}
    obstacles = find_obstacles(SimulationSpec.model_validate(bodies), tmp_path)
    solids = boundary_solids(obstacles, SPACING, H) if wall else []
    boundary = Boundary(Shapes(solids, np.zeros(3), SPACING, H), SPACING, H, H)
    system = FluidSystem(spec, gravity, boundary, Dfsph.ARRAYS)
    load(system, x, v, 1000.0)
    solver = Dfsph(system, 1.0)
    system.find_neighbors()
    return system, solver, here(system, "velocity")[:, :3]


def here(system, name: str) -> np.ndarray:
    return system.particles.numpy(name).astype(np.float64)


def third_of_the_trace(system, *, wall: bool) -> np.ndarray:
    """Of the sum over particles, over what it is where they fill all that the wall leaves, shape [n]."""
    from sim.fluid.kernel import cubic_slope_host, halfspace_area_host, halfspace_volume_host

    x = here(system, "position")[:, :3]
    r = np.linalg.norm(x[:, None] - x[None], axis=2)
    trace = -(system.mass / 1000.0 * cubic_slope_host(r, H) * r**2).sum(axis=1)
    q = x[:, 1] / H if wall else np.full(len(x), 1.0)
    return trace / 3 / (1 - halfspace_volume_host(q) - q * halfspace_area_host(q) / 3)


@pytest.mark.parametrize("wall", [False, True])
def test_linear_velocities_have_the_divergence_of_their_gradient(taichi, tmp_path, wall):
    """The rate over rho0 is -tr A wherever gradients are corrected in full: all that have a full support, and most of
    those next to a wall at y = 0, where linear velocities are those of the wall."""
    from sim.fluid.pressure.gradient_correction import FULL, compression_rates

    gradient = SHEAR.copy()
    if wall:
        gradient[:, [0, 2]] = 0.0
    x = block(np.random.default_rng(1))
    system, _, _ = system_of(x, x @ gradient.T, np.zeros(3), tmp_path, wall=wall)
    system.update_half_spaces(0.0)
    before = here(system, "velocity")[:, 3]
    compression_rates(system, DT, 0.0)
    rate = (here(system, "source") - (before - 1000.0)) / DT / 1000.0
    corrected = third_of_the_trace(system, wall=wall) > FULL
    low = here(system, "position")[:, 1] < SPACING
    assert corrected.sum() > 200
    assert (corrected & low).any() == wall
    np.testing.assert_allclose(rate[corrected], -np.trace(gradient), atol=1e-3 * np.abs(gradient).sum())


@pytest.mark.parametrize(("wall", "error"), [(WALL, 1e-3), (WALL | SIDE, 5e-3)], ids=["wall", "edge"])
def test_a_gradient_of_pressure_along_a_wall_pushes_all_layers_alike(taichi, tmp_path, wall, error):
    """q = x_z over a lattice: layers next to a wall are accelerated as those inside are, or water at rest would sink or
    rise along upright walls. In an edge the product of what both walls take is nearly what both together do."""
    from sim.device.arrays import vec4
    from sim.fluid.forces.pairwise import Lens
    from sim.fluid.pressure.gradient_correction import compression_rates
    from tests.support.fluid.pushed import push_along

    x = block(np.random.default_rng(1), 0.0)
    system, _, _ = system_of(x, np.zeros_like(x), np.zeros(3), tmp_path, wall=wall)
    system.update_half_spaces(0.0)
    compression_rates(system, DT, 0.0)
    particles, near, faces = system.particles, system.neighbors, system.boundary.faces
    place = here(system, "position")
    place[:, 3] = place[:, 2]
    particles.position.from_numpy(
        np.pad(place, ((0, particles.position.shape[0] - len(place)), (0, 0))).astype(np.float32)
    )

    out = taichi.ndarray(vec4, len(x))
    push_along(
        particles.position,
        particles.bundle(Lens),
        near.lists,
        faces.lists,
        1.0 / H,
        out,
    )
    a = out.to_numpy()[:, 2]
    layer = np.floor(place[:, :3] / SPACING).astype(int)
    rows = (layer[:, 2] == LAYERS // 2) & (layer[:, 1] < LAYERS - 3) & (layer[:, 0] < LAYERS - 3)
    rows &= (layer[:, 0] > 2) | ("side" in wall)
    inside = a[(layer == LAYERS // 2).all(axis=1)].mean()
    np.testing.assert_allclose(a[rows], inside, rtol=error)


@pytest.mark.parametrize("disorder", [0.0, 0.3])
def test_pressure_keeps_momentum_and_angular_momentum(taichi, tmp_path, disorder):
    """sum a = 0 and sum x cross a = 0 for any pressures, of particles with and without full supports."""
    from sim.fluid.pressure.gradient_correction import compression_rates

    rng = np.random.default_rng(2)
    x = block(rng, disorder)
    system, solver, before = system_of(x, rng.normal(size=x.shape), np.zeros(3), tmp_path, wall=False)
    system.update_half_spaces(0.0)
    compression_rates(system, DT, 0.0)
    solver.divergence.solve(DT, 0.0, 3, 3, warm=False, ahead=0.0)
    change, place = here(system, "velocity")[:, :3] - before, here(system, "position")[:, :3]
    strength = np.abs(change).sum()
    assert strength > 1.0
    assert np.abs(change.sum(axis=0)).max() < 1e-5 * strength
    centred = place - place.mean(axis=0)
    assert np.abs(np.cross(centred, change).sum(axis=0)).max() < 1e-5 * strength * np.abs(centred).max()


def test_no_energy_comes_of_taking_compression_away(taichi, tmp_path):
    """A projection: each iteration lowers what is left, and energy falls."""
    from sim.fluid.pressure.gradient_correction import compression_rates

    rng = np.random.default_rng(3)
    x = block(rng)
    system, solver, v = system_of(x, rng.normal(size=x.shape), np.zeros(3), tmp_path, wall=True)
    system.update_half_spaces(0.0)
    compression_rates(system, DT, 0.0)
    solver.divergence.solve(DT, 0.0, 30, 30, warm=False, ahead=0.0)
    assert (here(system, "velocity")[:, :3] ** 2).sum() < (v**2).sum()


def test_hyperviscosity_leaves_linear_flows_alone(taichi, tmp_path):
    """At surfaces and corners, too; what it does to noise is thousands of times as much."""
    rng = np.random.default_rng(4)
    x = block(rng)
    kept = {}
    for name, v in {"linear": x @ SHEAR.T + [1.0, 2.0, 3.0], "noise": 0.1 * rng.normal(size=x.shape)}.items():
        system, solver, v = system_of(x, v, np.array([0, -9.81, 0]), tmp_path, wall=False)
        solver.hyperviscosity.apply(0.01)
        change = here(system, "velocity")[:, :3] - v
        kept[name] = np.linalg.norm(change, axis=1).max()
        assert np.abs(change.sum(axis=0)).max() < 1e-5 * np.abs(v).sum()
        assert ((v + change) ** 2).sum() < (v**2).sum() * (1 + 1e-6)
    assert kept["linear"] < 1e-3 * kept["noise"]


def test_hyperviscosity_acts_by_the_fourth_power_of_the_wave_number(taichi, tmp_path):
    """A shear wave twice as long loses a sixteenth of the share, in a lattice away from its ends."""
    x = block(np.random.default_rng(5), 0.0)
    loss = []
    for length in (6 * SPACING, 12 * SPACING):
        phase = 2 * np.pi * (x[:, 0] - 0.5 * LAYERS * SPACING) / length
        v = np.column_stack((0 * phase, np.cos(phase), 0 * phase))
        system, solver, v = system_of(x, v, np.array([0, -9.81, 0]), tmp_path, wall=False)
        solver.hyperviscosity.apply(0.01)
        change = here(system, "velocity")[:, 1] - v[:, 1]
        middle = np.abs(here(system, "position")[:, :3] - 0.5 * LAYERS * SPACING).max(axis=1) < SPACING
        loss.append(-(change[middle] / v[middle, 1]).mean())
    assert loss[0] / loss[1] == pytest.approx(16, rel=0.35)


def test_particles_with_few_neighbours_keep_finite_velocities(taichi, tmp_path):
    """One alone, two that just see each other, three in a line and four in a plane."""
    groups = [[[0, 0, 0]], [[0, 0, 0], [0.99999, 0, 0]], [[0, 0, 0], [0.4, 0, 0], [0.8, 0, 0]]]
    groups.append([[0, 0, 0], [0.5, 0, 0], [0, 0.5, 0], [0.5, 0.5, 0]])
    x = np.concatenate([H * np.add(group, [0, 0, 5 * k]) for k, group in enumerate(groups)])
    v = np.random.default_rng(6).normal(size=x.shape)
    system, solver, before = system_of(x, v, np.array([0, -9.81, 0]), tmp_path, wall=False)
    solver.hyperviscosity.apply(0.01)
    solver.solve_pressures(1e-3)
    assert np.isfinite(here(system, "kept")).all()
    found = here(system, "velocity")[:, :3]
    assert (found**2).sum() <= (before**2).sum() * (1 + 1e-6)
