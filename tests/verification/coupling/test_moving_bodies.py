"""Fluid and bodies that move as prescribed: momentum balance, and what no choice of the frame may change."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from tests.support.fluid.solvers import LONG, SOLVERS, probe, steps
from tests.support.particles import positions, read_frame, velocities

RHO, G, D = 1000.0, 9.81, 0.02
SIDE = 0.12


def fluid(solver, **body):
    """A cube of SIDE, 216 particles."""
    water = {"shape": {"type": "box", "size": [SIDE] * 3}, **body}
    settings = {"solver": solver, "particle_radius": D / 2, "wcsph": {"speed_of_sound": 30.0}}
    return settings | {"bodies": {"water": water}}


def shell(folder, inner, wall=0.06):
    """The mesh of a closed box with thick walls, by its inner edge lengths [m]."""
    inside = trimesh.creation.box(extents=inner)
    outside = trimesh.creation.box(extents=np.array(inner) + 2 * wall)
    inside.invert()
    trimesh.util.concatenate([outside, inside]).export(folder / "shell.ply")
    return {"shape": {"type": "mesh", "file": "shell.ply"}}


@pytest.mark.parametrize("solver", LONG)
def test_a_box_that_moves_evenly_is_a_box_at_rest(simulate, tmp_path, solver):
    """Galilei: with all speeds more by V, positions are more by V t, to a unit in the last place a step.

    Solvers iterate a given number of times: where rounding decides when to stop, runs part by the error allowed.
    """
    velocity, frames = np.array([1.0, 0.5, -0.25]), 4
    box = shell(tmp_path, [0.2, 0.2, 0.2])
    spec = {"fps": 100, "step": {"fixed": 2e-4 if solver == "wcsph" else 1e-3}}
    given = {"min_iterations": 20, "max_iterations": 20}
    iterated = {"pcisph": given, "iisph": given, "dfsph": given | {"divergence_error": 0.1}}
    carried = box | {"motion": "prescribed", "velocity": velocity.tolist()}
    outs = []
    for name, wall, speed in (("still", box, [1.25, 0, 0]), ("moving", carried, [2.25, 0.5, -0.25])):
        water = fluid(solver, position=[0, -0.02, 0], velocity=speed) | iterated
        scene = spec | {"fluid": water, "rigid": {"bodies": {"box": wall}}}
        outs.append(simulate(scene, frames, name, threads=1))
    still, moving = outs
    a, b = read_frame(still, frames), read_frame(moving, frames)
    assert np.abs(velocities(a)[:, 0] - 1.25).max() > 0.5, "nothing was hit"
    rounding = len(steps(moving)) * np.spacing(np.float32(0.25))
    np.testing.assert_allclose(positions(b) - velocity * frames / 100, positions(a), atol=rounding)


@pytest.mark.parametrize("solver", LONG)
def test_the_impulse_on_a_plate_is_the_momentum_that_the_fluid_gains(simulate, solver):
    """A plate runs into fluid at rest without gravity: sum m (v1 - v0) = - sum of the force on the plate times dt.

    Velocity Verlet acts by the mean of the forces before and after, and takes damping at half the step: first order.
    Symplectic Euler acts by one force a step, which only PCISPH finds at another place than it has at last; but what
    the plate holds along its sides is told for where particles are after the step: first order, of a force that is
    itself a sixth of what presses on them.
    """
    plate = {
        "shape": {"type": "box", "size": [0.3, 0.06, 0.3]},
        "position": [0, -SIDE / 2 - 0.05, 0],
        "motion": "prescribed",
        "velocity": [0, 2, 0],
    }
    spec = {
        "fps": 20,
        "gravity": [0, 0, 0],
        "fluid": fluid(solver),
        "rigid": {"bodies": {"plate": plate}},
        "probes": {"push": {"type": "force", "body": "plate", "rate": 1e6}},
    }
    out = simulate(spec, 2, threads=1)
    dt = steps(out)["dt"]
    gained = RHO * D**3 * velocities(read_frame(out, 2)).sum(axis=0)
    # What wall damping keeps on the plate moves with it, m v; what is thrown off moves faster.
    assert gained[1] > 0.9 * RHO * SIDE**3 * 2, "the fluid was not hit"
    for axis, name in enumerate("xyz"):
        _, push = probe(out, "push", f"force_{name}")
        acting = (push[1:] + push[:-1]) / 2 if solver == "wcsph" else push[1:]
        share = 0.03 if solver == "wcsph" else 0.01
        assert -float((dt * acting).sum()) == pytest.approx(gained[axis], abs=share * gained[1])


@pytest.mark.parametrize("solver", LONG)
def test_a_lift_carries_its_load(simulate, solver):
    """A piston rises evenly in a shaft that does not hold the water by friction: water that rises with it presses with
    its weight, and all of it keeps the piston's speed and its volume."""
    speed, frames, fps = 1.0, 15, 50
    piston = {
        "shape": {"type": "box", "size": [0.3, 0.1, 0.3]},
        "position": [0, -0.05, 0],
        "motion": "prescribed",
        "velocity": [0, speed, 0],
    }
    shaft = {"type": "box", "size": [SIDE, 2, SIDE], "position": [0, -1, 0], "open": ["top", "bottom"]}
    water = fluid(solver, position=[0, SIDE / 2, 0], velocity=[0, speed, 0]) | {"wall_slip": "free_slip"}
    spec = {
        "fps": fps,
        "containers": {"shaft": shaft},
        "fluid": water,
        "rigid": {"bodies": {"piston": piston}},
        "probes": {
            "push": {"type": "force", "body": "piston", "rate": 1e6},
            "volume": {"type": "volume"},
        },
    }
    out = simulate(spec, frames, threads=1)
    dt = steps(out)["dt"]
    weight = RHO * D**3 * len(read_frame(out, 0)) * G
    time, push = probe(out, "push", "force_y")
    acting = (push[1:] + push[:-1]) / 2 if solver == "wcsph" else push[1:]
    gained = weight / G * (velocities(read_frame(out, frames))[:, 1].mean() - speed)
    assert -float((dt * acting).sum()) == pytest.approx(weight * time[-1] + gained, rel=0.02)
    moved = positions(read_frame(out, frames)) - positions(read_frame(out, 0))
    # The edges of the shaft are 2 % too dense at first: the column settles by about a layer's share of its height.
    np.testing.assert_allclose(moved.mean(axis=0), [0, speed * frames / fps, 0], atol=0.02 * SIDE)
    _, volume = probe(out, "volume")
    np.testing.assert_allclose(volume, SIDE**3, rtol=0.01)


@pytest.mark.parametrize("solver", LONG)
def test_a_tank_that_speeds_up_is_one_in_a_tilted_field(simulate, tmp_path, solver):
    """In the frame of a tank that moves as a t^2 / 2 gravity is g - a (d'Alembert), so that water leans back by a/g.

    Keyframes tau apart make the speed a staircase that is a tau / 2 behind in the mean, and no more than a tau: what
    the tank tells the water comes that much later, so the water is behind by up to a tau t.
    """
    a, tau, frames, fps = 0.3 * G, 0.01, 12, 100
    size, inner = [0.2, 0.1, 0.08], [0.2, 0.2, 0.08]
    keys = [{"at": n * tau, "position": [a * (n * tau) ** 2 / 2, 0, 0]} for n in range(frames + 1)]
    tank = shell(tmp_path, inner)
    water = fluid(solver, position=[0, (size[1] - inner[1]) / 2, 0]) | {"wall_slip": "free_slip"}
    water["bodies"]["water"]["shape"]["size"] = size
    scene = {"fps": fps, "fluid": water}
    tilted = simulate(
        scene | {"gravity": [-a, -G, 0], "rigid": {"bodies": {"tank": tank}}}, frames, "tilted", threads=1
    )
    moves = tank | {"motion": "prescribed", "keyframes": keys}
    moving = simulate(scene | {"rigid": {"bodies": {"tank": moves}}}, frames, "moving", threads=1)
    leant = []
    for frame in range(frames + 1):
        time = frame / fps
        expected = positions(read_frame(tilted, frame))
        found = positions(read_frame(moving, frame)) - [a * time**2 / 2, 0, 0]
        assert np.sqrt(((found - expected) ** 2).sum(axis=1).mean()) <= a * tau * time + 1e-6
        leant.append(found[:, 0].mean())
    # Without a floor and walls water would be left behind by a t^2 / 2 as a whole.
    assert leant[-1] < -a * tau * frames / fps


@pytest.mark.slow
@pytest.mark.parametrize("solver", LONG)
def test_a_can_that_spins_without_friction_leaves_the_water_at_rest(simulate, tmp_path, solver):
    """No stress along the wall, no torque: the angular momentum stays 0, against I omega if the water turned along."""
    radius, omega, frames = 0.1, 6.0, 10
    axis = trimesh.transformations.rotation_matrix(np.pi / 2, [1, 0, 0])
    inside, outside = (
        trimesh.creation.cylinder(radius=radius + wall, height=0.16 + 2 * wall, sections=64, transform=axis)
        for wall in (0.0, 0.06)
    )
    inside.invert()
    trimesh.util.concatenate([outside, inside]).export(tmp_path / "can.ply")
    can = {
        "shape": {"type": "mesh", "file": "can.ply"},
        "motion": "prescribed",
        "angular_velocity": [0, omega, 0],
    }
    turned = {}
    for slip in ("free_slip", "no_slip"):
        water = fluid(solver) | {"wall_slip": slip, "viscosity": 1e-2}
        water["wcsph"]["wall_damping"] = 0
        water["bodies"]["water"] = {
            "shape": {"type": "cylinder", "radius": radius, "height": 0.08},
            "position": [0, -0.04, 0],
        }
        out = simulate({"fps": 50, "fluid": water, "rigid": {"bodies": {"can": can}}}, frames, slip, threads=1)
        points = read_frame(out, frames)
        x, v = positions(points), velocities(points)
        whole = omega * (x[:, 0] ** 2 + x[:, 2] ** 2).sum()
        turned[slip] = (x[:, 2] * v[:, 0] - x[:, 0] * v[:, 2]).sum() / whole
    # The wall may be rough by half a spacing; what that drags along is of second order in it.
    assert abs(turned["free_slip"]) < (D / 2 / radius) ** 2
    # Momentum spreads over r in r^2 / nu = 1 s, and through the bottom in less.
    assert 0.8 < turned["no_slip"] < 1.0


@pytest.mark.slow
@pytest.mark.parametrize("solver", SOLVERS)
def test_the_force_on_a_full_tank_that_speeds_up(simulate, tmp_path, solver):
    """Water that fills a closed tank moves with it: the tank bears m (g - a), in the mean over whole keyframes.

    The keyframes go on for one more: a tank is at rest from its last one on, and the divergence solve stops the water
    with it in the step that ends there.
    """
    a, tau, frames = np.array([4.0, 0.0, 0.0]), 0.01, 50
    keys = [{"at": n * tau, "position": (a * (n * tau) ** 2 / 2).tolist()} for n in range(frames + 2)]
    tank = shell(tmp_path, [SIDE] * 3) | {"motion": "prescribed", "keyframes": keys}
    scene = {
        "fps": 100,
        "fluid": fluid(solver),
        "rigid": {"bodies": {"tank": tank}},
        "probes": {"push": {"type": "force", "body": "tank", "rate": 1e6}},
    }
    out = simulate(scene, frames, threads=1)
    assert len(read_frame(out, 0)) == 216
    dt, time = steps(out)["dt"], steps(out)["time"]
    late = time > 0.1 + 1e-9
    expected = RHO * SIDE**3 * (np.array([0, -G, 0]) - a)
    for axis, name in enumerate("xyz"):
        _, push = probe(out, "push", f"force_{name}")
        found = (dt * push[1:])[late].sum() / dt[late].sum()
        # The water may shift by a part of a spacing, of six in the tank.
        assert found == pytest.approx(expected[axis], abs=0.05 * np.linalg.norm(expected))
