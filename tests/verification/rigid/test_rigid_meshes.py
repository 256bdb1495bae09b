"""Friction and restitution of bodies that are meshes, on planes, on exact shapes and on other meshes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from tests.support.bodies import G, ball, bounces, box, ground, part, step, turn
from tests.support.in_time import in_time
from tests.support.meshes import body, write

DEGREE = np.pi / 180
SIZE = (0.2, 0.1, 0.2)
SLAB = (4.0, 0.2, 1.0)
CYLINDER = {"motion": "dynamic", "shape": {"type": "cylinder", "radius": 0.1, "height": 0.1}}
PAIRS = [("mesh", "plane"), ("mesh", "mesh"), *in_time(("mesh", "box"), ("box", "mesh"), ("cylinder", "mesh"))]


def flat(kind: str, folder: Path, **settings: Any) -> dict[str, Any]:
    """A body of 0.1 m height that lies flat."""
    if kind == "mesh":
        return body(write(folder / "box.off", trimesh.creation.box(SIZE)), **settings)
    return {"box": box(SIZE), "cylinder": CYLINDER}[kind] | settings


def round_mesh(folder: Path, halvings: int, **settings: Any) -> dict[str, Any]:
    """A ball of 0.1 m radius, a corner of which is its lowest point."""
    return body(write(folder / "ball.off", trimesh.creation.icosphere(subdivisions=halvings, radius=0.1)), **settings)


def support(kind: str, folder: Path, slope: float = 0.0, **surface: Any) -> dict[str, Any]:
    """What falls towards +x by `slope` [rad], its top through the origin."""
    if kind == "plane":
        return ground(slope, **surface)
    below = [-0.1 * np.sin(slope), -0.1 * np.cos(slope), 0]
    shape = {"type": "box", "size": SLAB}
    if kind == "mesh":
        shape = {"type": "mesh", "file": str(write(folder / "slab.off", trimesh.creation.box(SLAB)))}
    return {"shape": shape, "rotation": turn((0, 0, 1), -slope), "position": below, **surface}


def down_the_slope(bodies, slope: float, seconds: float) -> tuple[float, float]:
    """Speed over time [m/s^2] and way [m] down the slope."""
    down = np.array([np.cos(slope), -np.sin(slope), 0])
    before = bodies.position[0].copy()
    step(bodies, seconds)
    return float(bodies.velocity[0] @ down) / seconds, float((bodies.position[0] - before) @ down)


@pytest.mark.parametrize("beside", [-1, 1, *in_time(10)])
@pytest.mark.parametrize("friction", [0.5, *in_time(0.1, 1.0)])
@pytest.mark.parametrize(("upper", "lower"), PAIRS)
def test_what_lies_on_a_slope_sticks_or_slides(tmp_path, upper, lower, friction, beside):
    """It sticks if mu > tan(theta), else a = g (sin(theta) - mu cos(theta)).

    The body lies 0.05 m above the slope only to the rounding of distances, a few 1e-9 m, and may go 1e-3 of its size
    until its contacts have closed.
    """
    slope = np.arctan(friction) + beside * DEGREE
    surface = {"friction": friction, "restitution": 0}
    above = [0.05 * np.sin(slope), 0.05 * np.cos(slope), 0]
    moving = flat(upper, tmp_path, rotation=turn((0, 0, 1), -slope), position=above, **surface)
    bodies = part({"body": moving, "slope": support(lower, tmp_path, slope, **surface)})
    acceleration, way = down_the_slope(bodies, slope, 0.5)
    if beside < 0:
        assert abs(way) < 1e-3 * SIZE[1]
        assert abs(acceleration) < 1e-6
    else:
        assert acceleration == pytest.approx(G * (np.sin(slope) - friction * np.cos(slope)), rel=0.02)


@pytest.mark.parametrize(("upper", "lower"), PAIRS[1:4])
def test_the_way_to_a_stop(tmp_path, upper, lower):
    """v^2 / (2 mu g), straight on; a step takes off v = mu g dt at once, so that the way is up to v dt / 2 shorter."""
    friction, speed = 0.5, 3.0
    surface = {"friction": friction, "restitution": 0}
    moving = flat(upper, tmp_path, position=[-0.9, 0.05, 0], velocity=[speed, 0, 0], **surface)
    bodies = part({"body": moving, "floor": support(lower, tmp_path, **surface)})
    step(bodies, 1.0)
    way = bodies.position[0] - [-0.9, 0.05, 0]
    assert way[0] == pytest.approx(speed**2 / (2 * friction * G), rel=0.01)
    assert abs(way[2]) < 1e-3
    assert np.abs(bodies.velocity[0]).max() < 1e-6


@pytest.mark.parametrize("restitution", [0.5, *in_time(0.8)])
@pytest.mark.parametrize("lower", ["mesh", *in_time("plane", "box")])
@pytest.mark.parametrize("upper", ["box", *in_time("ball")])
def test_bounces(tmp_path, upper, lower, restitution):
    """e^2n h and flat: bodies know of a flat face how far it is to the rounding of distances, 6e-8 of 0.4 m.

    The corner that the ball lands on is under its middle, so that it gets no spin. All corners of the box bounce alike:
    to 1e-3 of the speed of its fall.
    """
    drop = 1.0
    below = 0.05 if upper == "box" else 0.1
    settings = {"position": [0.013, drop + below, 0.017], "restitution": restitution}
    moving = flat("mesh", tmp_path, **settings) if upper == "box" else round_mesh(tmp_path, 3, **settings)
    bodies = part({"body": moving, "floor": support(lower, tmp_path, restitution=restitution)})
    tops = bounces(bodies, 1.3 if restitution == 0.5 else 1.9, below)
    expected = [drop * restitution ** (2 * n) for n in (1, 2)]
    assert tops[:2] == pytest.approx(expected, rel=0.01)
    assert np.abs(bodies.spin[0]).max() * 0.1 < 1e-3 * np.sqrt(2 * G * drop)


@pytest.mark.slow
@pytest.mark.parametrize("lower", ["plane", *in_time("box", "mesh")])
def test_a_round_mesh_slides_like_a_body_of_its_mass(tmp_path, lower):
    """a = g (sin(theta) - mu cos(theta)) where friction is half of what rolling takes."""
    slope = 40 * DEGREE
    friction = 0.5 * 2 / 7 * np.tan(slope)
    surface = {"friction": friction, "restitution": 0}
    above = [0.1 * np.sin(slope), 0.1 * np.cos(slope), 0]
    moving = round_mesh(tmp_path, 3, position=above, **surface)
    bodies = part({"ball": moving, "slope": support(lower, tmp_path, slope, **surface)})
    acceleration, _ = down_the_slope(bodies, slope, 0.5)
    assert acceleration == pytest.approx(G * (np.sin(slope) - friction * np.cos(slope)), rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("halvings", [2, 3, 4])
@pytest.mark.parametrize("lower", ["plane", "mesh"])
def test_a_round_mesh_rolls_as_a_polyhedron(tmp_path, lower, halvings):
    """Slower than a ball, 5/7 g sin(theta), and no slower than a wheel with corners as far apart as its longest edges.

    The wheel turns by 2 b from corner to corner. There its angular momentum about the new corner stays, so that its
    energy E becomes E (1 - R^2 (1 - cos 2b) / (7/5 R^2))^2 ~ E (1 - 20/7 b^2): it loses k = 10/7 b / R of it a metre.
    With E = 7/10 m v^2 and E' = m g sin(theta) - k E, v^2 = 10/7 g sin(theta) (1 - exp(-k x)) / k.
    """
    slope, radius = 20 * DEGREE, 0.1
    above = [radius * np.sin(slope), radius * np.cos(slope), 0]
    surface = {"friction": 0.8, "restitution": 0}
    moving = round_mesh(tmp_path, halvings, position=above, **surface)
    bodies = part({"ball": moving, "slope": support(lower, tmp_path, slope, **surface)})
    acceleration, way = down_the_slope(bodies, slope, 1.0)
    ball_of_size = 5 / 7 * G * np.sin(slope)
    half = np.arcsin(trimesh.creation.icosphere(subdivisions=halvings).edges_unique_length.max() / 2)
    loss = 10 / 7 * half / radius
    wheel = np.sqrt(10 / 7 * G * np.sin(slope) * -np.expm1(-loss * way) / loss)
    assert wheel < acceleration < ball_of_size


@pytest.mark.parametrize("lower", in_time("mesh", "box"))
def test_no_mesh_passes_through_a_thin_wall(tmp_path, lower):
    """At 50 m/s and turning, a box of 1 cm meets a wall of 1 mm; its steps are half of it long, five walls."""
    size = (0.01, 0.01, 0.01)
    small = body(write(tmp_path / "small.off", trimesh.creation.box(size)), position=[-0.1, 0, 0])
    small |= {"velocity": [50, 3, 1], "angular_velocity": [20, 30, 40]}
    wall = {"type": "box", "size": [0.001, 1, 1]}
    if lower == "mesh":
        wall = {"type": "mesh", "file": str(write(tmp_path / "wall.off", trimesh.creation.box(wall["size"])))}
    bodies = part({"small": small, "wall": {"shape": wall}}, gravity=(0, 0, 0))
    step(bodies, 0.02)
    assert bodies.position[0, 0] < 0
    assert bodies.velocity[0, 0] < 0


@pytest.mark.parametrize("inner", in_time("mesh", "ball"))
def test_what_is_in_a_mesh_container_rests_on_its_floor(simulate, tmp_path, inner):
    from tests.support.particles import read_table

    write(tmp_path / "room.off", trimesh.creation.box((1, 1, 1)))
    moving = {"mesh": flat("mesh", tmp_path), "ball": ball(0.05)}[inner] | {"position": [0.1, -0.4, 0.1]}
    room = {"type": "mesh", "shape": {"type": "mesh", "file": "room.off"}}
    data = {"fps": 24, "rigid": {"bodies": {"body": moving}}, "containers": {"room": room}}
    out = simulate(data, 24)
    assert read_table(out / "bodies.csv")["y"][-1] == pytest.approx(-0.45, abs=1e-4)
