"""Bounces: heights, momentum, energy, and what passes from body to body."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from tests.support.bodies import ball, bounces, box, ground, part, step, turn
from tests.support.in_time import in_time

BODIES = {
    "ball": ball(0.1),
    "box": box((0.2, 0.2, 0.2)),
    "capsule": {"motion": "dynamic", "shape": {"type": "capsule", "radius": 0.1, "height": 0.2}},
    "can": {"motion": "dynamic", "shape": {"type": "cylinder", "radius": 0.1, "height": 0.2}},
    "wheel": {"motion": "dynamic", "shape": {"type": "cylinder", "radius": 0.1, "height": 0.2}}
    | {"rotation": turn((1, 0, 0), np.pi / 2)},
    "coin": {"motion": "dynamic", "shape": {"type": "cylinder", "radius": 0.15, "height": 0.03}},
    "ring": {"motion": "dynamic", "shape": {"type": "torus", "radius": 0.1, "tube_radius": 0.04}},
}
BELOW = {"capsule": 0.2, "coin": 0.015, "ring": 0.04}
"""How far down from their centres bodies go that are not 0.1 m high there [m]."""
FLAT = ("can", "wheel", "coin", "ring")
ASKEW = set(product(("box", "tin", "coin", "plank"), (0.3, 0.7, 1.0), (1e-3, 4e-3)))
SOME_ASKEW = {("plank", 0.7, 1e-3), ("coin", 1.0, 1e-3), ("tin", 1.0, 4e-3), ("box", 0.7, 4e-3)}
"""Shape, restitution, and step [s]."""


@pytest.mark.parametrize(
    ("name", "restitution"),
    [
        *(("ball", 0.8), ("box", 0.5), ("capsule", 0.8), ("can", 0.7)),
        *in_time(("ball", 0.5), ("ball", 1.0), *((name, 0.7) for name in FLAT[1:])),
    ],
)
def test_bounces_are_as_high_as_they_should_be(name, restitution):
    """e^2n h, each the same from one bounce to the next, and upright: what lands flat bounces flat."""
    drop = 1.0
    surface = {"restitution": restitution}
    below = BELOW.get(name, 0.1)
    bodies = part({name: {**BODIES[name], "position": [0, drop + below, 0], **surface}, "floor": ground(**surface)})
    tops = bounces(bodies, 2.2, below)
    expected = [drop * restitution ** (2 * n) for n in range(1, 4 if restitution < 1 else 3)]
    assert tops[: len(expected)] == pytest.approx(expected, rel=0.01)
    assert np.abs(bodies.spin).max() < 1e-4


def test_a_box_that_lands_flat_bounces_flat():
    bodies = part({"box": box((0.3, 0.1, 0.2), position=[0, 0.5, 0], restitution=0.7), "floor": ground()})
    step(bodies, 0.5)
    assert np.abs(bodies.spin).max() < 1e-6


@pytest.mark.parametrize(("moving", "gap"), [(1, 0.0), (1, 1e-3), (2, 0.0), (3, 1e-3)])
def test_as_many_balls_leave_newtons_cradle_as_arrive(moving, gap):
    balls = {
        f"ball{k}": ball(
            0.1,
            position=[k * (0.2 + gap) - (0.3 if k < moving else 0), 0, 0],
            velocity=[1.0 if k < moving else 0.0, 0, 0],
            friction=0,
            restitution=1,
        )
        for k in range(5)
    }
    bodies = part(balls, gravity=(0, 0, 0))
    momentum = bodies.measure().momentum.copy()
    step(bodies, 0.5)
    assert bodies.measure().momentum == pytest.approx(momentum, rel=1e-4, abs=1e-9)
    assert bodies.velocity[:, 0] == pytest.approx([0.0] * (5 - moving) + [1.0] * moving, abs=1e-4)


def test_two_bodies_that_collide_keep_momentum_of_both_kinds():
    """Linear and angular about the origin, off-centre and with friction; energy is lost, not gained."""
    rod = box((1.0, 0.1, 0.1), velocity=[0.5, 0, 0])
    bodies = part({"rod": rod, "ball": ball(0.1, position=[0.4, 0.5, 0], velocity=[0, -2, 0.3])}, gravity=(0, 0, 0))

    def momenta() -> np.ndarray:
        mass = bodies.mass[:, None]
        angular = bodies.momentum + np.cross(bodies.position, mass * bodies.velocity)
        return np.concatenate(((mass * bodies.velocity).sum(axis=0), angular.sum(axis=0)))

    before, energy = momenta(), bodies.measure().kinetic_energy
    step(bodies, 0.5)
    assert abs(bodies.spin[0, 2]) > 0.1
    assert momenta() == pytest.approx(before, rel=1e-5, abs=1e-5 * np.abs(before).max())
    assert bodies.measure().kinetic_energy < energy


@pytest.mark.parametrize(("name", "restitution", "dt"), [*sorted(SOME_ASKEW), *in_time(*sorted(ASKEW - SOME_ASKEW))])
def test_what_lands_askew_gains_no_energy(name, restitution, dt):
    """It strikes with one edge after the other, and slides. Velocities are those of the middle of a step while it
    touches, so that its energy is known to m g v dt / 2."""
    tin = {"motion": "dynamic", "shape": {"type": "cylinder", "radius": 0.06, "height": 0.06}}
    shapes = BODIES | {"plank": box((0.2, 0.04, 0.1)), "tin": tin}
    low = {"box": 0.1, "plank": 0.02, "tin": 0.03, "coin": 0.015}[name]
    surface = {"restitution": restitution}
    for seed in range(8):
        random = np.random.default_rng(seed)
        askew = turn(tuple(random.normal(size=3) * (1, 0.2, 1)), np.radians(random.uniform(0.2, 4)))
        falling = {"position": [0, low + 0.02, 0], "velocity": [0, -1, 0], "rotation": askew}
        bodies = part({"body": shapes[name] | falling | surface, "floor": ground(**surface)})
        weight = 9.81 * bodies.mass[0]

        def energy(bodies=bodies, weight=weight) -> float:
            return bodies.measure().kinetic_energy + weight * (bodies.position[0, 1] - low)

        energies = [energy()]
        speed = np.sqrt(2 * energies[0] / bodies.mass[0])
        step(bodies, 0.15, lambda _, energy=energy, energies=energies: energies.append(energy()), dt=dt)
        assert max(energies) < energies[0] + weight * speed * dt / 2, seed


@pytest.mark.xfail(reason="blows act where bodies are after the step, forces where they were before", strict=True)
def test_a_fast_box_that_strikes_the_floor_askew_keeps_its_energy():
    """With restitution 1 and without friction; it goes half its size in a step, the most that it may."""
    tilted = box((0.1, 0.1, 0.1), position=[0, 0.12, 0], velocity=[12.5, -5, 0], rotation=turn((0, 0.3, 1), 0.2))
    bodies = part({"box": {**tilted, "friction": 0, "restitution": 1}, "floor": ground(friction=0)}, gravity=(0, 0, 0))
    before = bodies.measure().kinetic_energy
    step(bodies, 0.02)
    assert bodies.velocity[0, 1] > 0
    assert bodies.measure().kinetic_energy == pytest.approx(before, rel=0.01)


@pytest.mark.parametrize("name", ["ball", "box"])
def test_nothing_passes_through_a_thin_wall(name):
    """A small body at 50 m/s, a hundred times its own size in one step of 20 ms."""
    small = {"ball": ball(0.005), "box": box((0.01, 0.01, 0.01))}[name]
    small |= {"position": [-0.1, 0, 0], "velocity": [50, 3, 1], "angular_velocity": [20, 30, 40]}
    wall = {"shape": {"type": "box", "size": [0.001, 1, 1]}}
    bodies = part({"small": small, "wall": wall}, gravity=(0, 0, 0))
    step(bodies, 0.02)
    assert bodies.position[0, 0] < 0
    bodies = part({"small": small, "wall": wall}, gravity=(0, 0, 0))
    step(bodies, 0.02, dt=0.02)
    assert bodies.position[0, 0] < 0
