"""Cloth and bodies that obey forces move each other."""

from __future__ import annotations

import numpy as np
import pytest

from sim.cloth.contact.applied_forces import pulls
from tests.support.bodies import ball, box
from tests.support.cloths import G, scene, sheet
from tests.support.in_time import in_time
from tests.support.meshes import write
from tests.support.stepping import advance
from tests.support.wet import read_sheet

TIGHT = {"implicit_euler": {"velocity_error": 1e-6, "linear_error": 1e-4, "max_newton": 60}}
FINE = TIGHT | {"xpbd": {"substeps": 40, "iterations": 10}}


def momentum(world) -> tuple[np.ndarray, np.ndarray]:
    """Of cloth and bodies, and angular about the origin [kg m/s] and [kg m^2/s]."""
    rigid, mass = world.rigid, world.cloth.mesh.mass[:, None]
    x, v = world.cloth.vertices("cloth")
    dynamic = rigid.dynamic
    linear = (mass * v).sum(axis=0) + (rigid.mass[dynamic, None] * rigid.velocity[dynamic]).sum(axis=0)
    angular = np.cross(x, mass * v).sum(axis=0) + rigid.momentum[dynamic].sum(axis=0)
    orbital = np.cross(rigid.position[dynamic], rigid.mass[dynamic, None] * rigid.velocity[dynamic])
    return linear, angular + orbital.sum(axis=0)


BODIES = {"ball": ball(0.05, density=300), "box": box((0.12, 0.08, 0.1), density=200)}


@pytest.mark.parametrize("integrator", ["implicit_euler", *in_time("symplectic_euler", "xpbd")])
@pytest.mark.parametrize("gravity", [0.0, pytest.param(G, marks=pytest.mark.slow)])
@pytest.mark.parametrize("body", [pytest.param(BODIES["ball"], marks=pytest.mark.slow), BODIES["box"]], ids=BODIES)
def test_momentum_goes_from_one_to_the_other(body, gravity, integrator):
    """P(t) = P0 + M g t; without gravity angular momentum stays to the first order of the step."""
    flying = body | {"position": [0.04, 0.09, 0.03], "velocity": [0.3, -2, 0], "angular_velocity": [0, 3, 5]}
    world = scene(
        {"cloth": sheet((0.5, 0.5), spacing=0.05, thickness=0.01, damping=0.1)},
        {"body": flying},
        cloth=TIGHT | {"integrator": integrator},
        gravity=[0, -gravity, 0],
    )
    linear, angular = momentum(world)
    whole = world.cloth.mesh.mass.sum() + world.rigid.mass[world.rigid.dynamic].sum()
    dt, steps = 0.002, 60
    for k in range(1, steps + 1):
        advance(world, dt, k * dt)
    after, turning = momentum(world)
    fallen = np.array([0, -gravity * dt * steps, 0])
    assert np.linalg.norm(world.cloth.vertices("cloth")[1].mean(axis=0) - fallen) > 0.2
    assert np.allclose(after, linear + whole * fallen, rtol=0, atol=1e-5 * np.linalg.norm(linear))
    if gravity == 0:
        assert np.allclose(turning, angular, rtol=0, atol=0.02 * np.linalg.norm(angular))


@pytest.mark.parametrize("integrator", ["symplectic_euler", "xpbd", *in_time("implicit_euler")])
def test_contacts_on_one_thread_and_many_are_the_same(integrator, monkeypatch):
    found = []
    for alone in (4000, 0):
        monkeypatch.setattr("sim.cloth.fabric.mesh.ALONE", alone)
        world = scene(
            {"cloth": sheet((0.4, 0.4), spacing=0.1, thickness=0.01)},
            {"box": box((0.2, 0.1, 0.2), position=[0, -0.06, 0]) | {"motion": "static"}},
            cloth=TIGHT | {"integrator": integrator},
        )
        contacts = [advance(world, 0.002, 0.002 * k)["cloth_contacts"] for k in range(1, 31)]
        found.append(world.cloth.vertices("cloth")[0])
        assert max(contacts) > 4
    assert np.allclose(*found, rtol=0, atol=1e-6)


@pytest.mark.slow
def test_a_ball_that_falls_into_a_cloth_is_caught():
    """It bounces lower and lower around the place where the cloth carries it, and never gains energy over the start."""
    world = scene(
        {"cloth": sheet((0.8, 0.8), spacing=0.08, thickness=0.012, pins=["corners"], stretch_stiffness=2000)},
        {"ball": ball(0.1, density=300, position=[0, 0.15, 0])},
        cloth={"air": {"density": 50}},
    )
    energies, heights = [], []
    for k in range(1, 276):
        advance(world, 0.004, k * 0.004)
        ball_now, cloth_now = world.rigid.measure(), world.cloth.measure()
        energies.append(ball_now.kinetic_energy + ball_now.potential_energy + cloth_now.kinetic_energy)
        energies[-1] += cloth_now.potential_energy + cloth_now.elastic_energy
        heights.append(world.rigid.position[0].copy())
    assert max(energies) < 1.01 * world.rigid.mass[0] * G * 0.15
    assert energies[-1] < 0.2 * energies[0]
    assert np.min(heights) > -0.2
    assert np.max(np.array(heights)[150:, 1]) < 0.05
    assert np.abs(np.array(heights)[:, [0, 2]]).max() < 0.01


def band(path, radius, hanging, cells):
    """A strip over the upper half of a drum that lies along z, and straight down on both sides, as a mesh."""
    import trimesh

    length = np.pi * radius + 2 * hanging
    s = np.linspace(-length / 2, length / 2, cells + 1)
    turned = np.clip(s / radius, -np.pi / 2, np.pi / 2)
    down = np.maximum(np.abs(s) - np.pi / 2 * radius, 0.0)
    line = np.stack([radius * np.sin(turned), radius * np.cos(turned) - down], axis=1)
    points = np.concatenate([np.insert(line, 2, z, axis=1) for z in (-0.01, 0.01)])
    k = np.arange(cells)
    one, other = k, k + cells + 1
    faces = np.concatenate([np.stack([one, one + 1, other], 1), np.stack([one + 1, other + 1, other], 1)])
    return str(write(path, trimesh.Trimesh(points, faces, process=False))), points[[0, cells + 1]], points[[cells, -1]]


@pytest.mark.slow
@pytest.mark.parametrize("integrator", ["xpbd", *in_time("implicit_euler", "symplectic_euler")])
@pytest.mark.parametrize("friction", [0.2, *in_time(0.5)])
def test_a_band_is_pulled_over_a_drum(tmp_path, friction, integrator):
    """Tensions on both sides of a drum that a band slides around by half a turn: e^(mu pi) (Euler, Eytelwein).

    With the 10 substeps of one sweep that it takes by default, XPBD passes on a tenth of these tensions.
    """
    thickness, radius = 0.004, 0.1
    file, left, right = band(tmp_path / "band.off", radius + thickness / 2, 0.1, 60)

    def led(points, way):
        return {"at": points.tolist(), "keyframes": [{"at": 0}, {"at": 1, "offset": [0, way, 0]}]}

    cloth = {"shape": {"type": "mesh", "file": file}, "mass_per_area": 0.1, "stretch_stiffness": 2000, "damping": 0.5,
             "bend_stiffness": 1e-7, "rest_scale": 0.98, "thickness": thickness, "friction": friction,
             "pins": [led(left, 0.05), led(right, -0.05)]}  # fmt: skip
    drum = {"shape": {"type": "cylinder", "radius": radius, "height": 0.1}, "friction": friction,
            "rotation": [{"axis": [1, 0, 0], "angle": 90}]}  # fmt: skip
    world = scene({"cloth": cloth}, {"drum": drum}, gravity=[0, 0, 0], cloth=FINE | {"integrator": integrator})
    ratios = []
    for k in range(1, 401):
        advance(world, 0.002, 0.002 * k)
        if k > 300:
            pull = pulls(world.cloth.mesh)
            x = world.cloth.vertices("cloth")[0][:, 0]
            held = world.cloth.mesh.held
            ratios.append(pull[held & (x > 0), 1].sum() / pull[held & (x < 0), 1].sum())
    assert np.mean(ratios) == pytest.approx(np.exp(np.pi * friction), rel=0.05)


ROLLER = {"type": "cylinder", "radius": 0.2, "height": 1.2}
LYING = [{"axis": [1, 0, 0], "angle": 90}]


@pytest.mark.parametrize("friction", [0.0, *in_time(0.3)])
@pytest.mark.parametrize(
    ("shape", "axis"),
    [({"type": "sphere", "radius": 0.2}, 1), pytest.param(ROLLER, 2, marks=pytest.mark.slow)],
    ids=["ball", "roller"],
)
def test_cloth_without_friction_is_not_turned(simulate, shape, axis, friction):
    """Cloth falls on what turns, and gets no angular momentum about its axis that friction does not give it. What is
    round is made of triangles whose normals are off by up to their angle: on them it was turned at a sixth of the speed
    of the ball, though their contacts have no friction. Left is a hundredth: a turn of the normal in a step."""
    spin = 3.0 * np.eye(3)[axis]
    body = {"shape": shape, "motion": "prescribed", "angular_velocity": spin.tolist(), "friction": friction}
    sheet = {"shape": {"type": "sheet", "size": [0.8, 0.8]}, "spacing": 0.05, "position": [0, 0.21, 0]}
    sheet |= {"thickness": 0.008, "stretch_stiffness": 500, "friction": friction}
    if axis == 2:
        body["rotation"] = LYING
    out = simulate({"fps": 10, "rigid": {"bodies": {"round": body}}, "cloth": {"sheets": {"sheet": sheet}}}, 6)
    place, speed, _ = read_sheet(out, 6)
    turned = np.cross(place, speed)[:, axis].sum()
    across = np.delete(place, axis, axis=1)
    rate = turned / (across**2).sum()
    assert rate < 0.03 if friction == 0 else rate > 0.3
