"""Coulomb's law: what sticks, what slides and how fast, and what rolls."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.bodies import G, ball, box, ground, part, step, turn

DEGREE = np.pi / 180


def on_slope(angle: float, body: dict, friction: float, above: float, seconds: float = 0.5):
    """A body with its centre `above` a slope [m]; returns its speed down the slope over the time, and the way [m]."""
    down, up = np.array([np.cos(angle), -np.sin(angle), 0]), np.array([np.sin(angle), np.cos(angle), 0])
    surface = {"friction": friction}
    bodies = part({"body": {**body, **surface, "position": list(above * up)}, "slope": ground(angle, **surface)})
    before = bodies.position[0].copy()
    step(bodies, seconds)
    return float(bodies.velocity[0] @ down) / seconds, float((bodies.position[0] - before) @ down)


@pytest.mark.parametrize("friction", [0.1, 0.5, 1.0])
@pytest.mark.parametrize("beside", [-1, 1, 10])
def test_a_box_on_a_slope_sticks_or_slides(friction, beside):
    """It sticks if mu > tan(theta), else a = g (sin(theta) - mu cos(theta))."""
    angle = np.arctan(friction) + beside * DEGREE
    acceleration, way = on_slope(angle, box((0.2, 0.1, 0.2), rotation=turn((0, 0, 1), -angle)), friction, 0.05)
    if beside < 0:
        assert abs(way) < 1e-6
        assert abs(acceleration) < 1e-6
    else:
        assert acceleration == pytest.approx(G * (np.sin(angle) - friction * np.cos(angle)), rel=0.02)


@pytest.mark.parametrize("angle", [10 * DEGREE, 30 * DEGREE])
def test_a_ball_and_a_cylinder_roll(angle):
    """a = 5/7 g sin(theta) of a ball if mu >= 2/7 tan(theta), 2/3 of a cylinder."""
    rolling = G * np.sin(angle)
    acceleration, _ = on_slope(angle, ball(0.1), 0.8, 0.1)
    assert acceleration == pytest.approx(5 / 7 * rolling, rel=0.01)
    cylinder = {"motion": "dynamic", "shape": {"type": "cylinder", "radius": 0.1, "height": 0.2}}
    acceleration, _ = on_slope(angle, {**cylinder, "rotation": turn((1, 0, 0), np.pi / 2)}, 0.8, 0.1)
    assert acceleration == pytest.approx(2 / 3 * rolling, rel=0.01)


def test_a_ball_slides_where_friction_is_too_small_to_roll():
    angle = 40 * DEGREE
    friction = 0.5 * 2 / 7 * np.tan(angle)
    acceleration, _ = on_slope(angle, ball(0.1), friction, 0.1)
    assert acceleration == pytest.approx(G * (np.sin(angle) - friction * np.cos(angle)), rel=0.01)


@pytest.mark.parametrize(("spin", "gap"), [(0.0, 0.0), (0.0, 1e-12), (20.0, 0.0)])
def test_a_ball_that_slides_begins_to_roll(spin, gap):
    """After 2 (v + w r) / (7 mu g), 2/7 (v + w r) slower, with backspin w as without; a gap [m] as rounding leaves is
    no blow to bounce off from, and neither is a surface that turns. When, is known to a step."""
    friction, speed, radius = 0.3, 3.0, 0.1
    surface = {"friction": friction}
    body = ball(radius, position=[0, radius + gap, 0], velocity=[speed, 0, 0], angular_velocity=[0, 0, spin], **surface)
    bodies = part({"ball": body, "floor": ground(**surface)})
    sliding = speed + spin * radius
    rolls, heights = [], []

    def look(time: float) -> None:
        heights.append(bodies.position[0, 1] - radius)
        if abs(bodies.velocity[0, 0] + radius * bodies.spin[0, 2]) < 1e-6:
            rolls.append(time - bodies.velocity_lag[0])

    step(bodies, 1.0, look)
    assert rolls[0] == pytest.approx(2 * sliding / (7 * friction * G), abs=bodies.settings.max_step)
    assert bodies.velocity[0, 0] == pytest.approx(speed - 2 / 7 * sliding, rel=0.01)
    assert np.abs(heights).max() < 1e-9


@pytest.mark.parametrize("direction", [0, 20 * DEGREE])
def test_the_way_to_a_stop_is_the_same_in_every_direction(direction):
    """v^2 / (2 mu g), straight on: the cone is round."""
    friction, speed = 0.3, 3.0
    along = np.array([np.cos(direction), 0, np.sin(direction)])
    surface = {"friction": friction}
    body = box((0.2, 0.1, 0.2), position=[0, 0.05, 0], velocity=list(speed * along), **surface)
    bodies = part({"box": body, "floor": ground(**surface)})
    step(bodies, 1.5)
    way = bodies.position[0] - [0, 0.05, 0]
    assert way @ along == pytest.approx(speed**2 / (2 * friction * G), rel=0.01)
    assert np.linalg.norm(way - (way @ along) * along) < 1e-3
    assert np.abs(bodies.velocity[0]).max() < 1e-6


def test_friction_at_rest_holds_what_friction_while_sliding_does_not():
    angle = np.arctan(0.4)
    down = np.array([np.cos(angle), -np.sin(angle), 0])
    surface = {"friction": 0.3, "static_friction": 0.5}
    for speed, moves in [(0.0, False), (0.2, True)]:
        body = box((0.2, 0.1, 0.2), rotation=turn((0, 0, 1), -angle), velocity=list(speed * down), **surface)
        body["position"] = [0.05 * np.sin(angle), 0.05 * np.cos(angle), 0]
        bodies = part({"box": body, "slope": ground(angle, **surface)})
        step(bodies, 0.5)
        expected = speed + 0.5 * G * (np.sin(angle) - 0.3 * np.cos(angle)) if moves else 0.0
        assert bodies.velocity[0] @ down == pytest.approx(expected, rel=0.02, abs=1e-6)


def test_a_pair_may_differ_from_its_bodies():
    body = box((0.2, 0.1, 0.2), position=[0, 0.05, 0], velocity=[1, 0, 0], friction=1.0)
    exception = {"between": ["box", "floor"], "friction": 0.0}
    bodies = part({"box": body, "floor": ground(friction=1.0)}, pairs=[exception])
    step(bodies, 0.5)
    assert bodies.velocity[0] == pytest.approx([1, 0, 0], abs=1e-9)


@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_a_box_that_is_held_under_load_does_not_creep():
    """For 60 s at 0.9 of what friction can hold, by less than 1 um/s."""
    friction = 0.5
    angle = np.arctan(0.9 * friction)
    _, way = on_slope(angle, box((0.2, 0.1, 0.2), rotation=turn((0, 0, 1), -angle)), friction, 0.05, seconds=60)
    assert abs(way) < 60 * 1e-6
