"""Water in a glass with walls from a tenth of a spacing to four: filled, poured, carried and tipped; and bodies on the
ground of a tank.

A glass of inner radius R that holds N particles of the volume d^3 over its bottom has the level N d^3 / (pi R^2), and
is pressed down by their weight. Tipped by the angle a until some runs out, one of the inner height H keeps
pi R^2 (H - R tan a), as long as that leaves its bottom covered.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.fluid.solvers import probe
from tests.support.fluid.vessels import FLOOR, RADIUS, SPACING, glass
from tests.support.particles import positions, read_frame, read_table

HEIGHT, RHO, G = 0.05, 1000.0, 9.81


def water(height: float) -> dict:
    return {"shape": {"type": "cylinder", "radius": RADIUS, "height": height}, "position": [0, FLOOR + height / 2, 0]}


def scene(fluid: dict, keyframes: tuple[dict, ...] = ()) -> dict:
    """As a user would write it: the solver, the size of particles, and the glass."""
    body: dict = {"shape": {"type": "mesh", "file": "glass.ply"}}
    if keyframes:
        body |= {"motion": "prescribed", "keyframes": list(keyframes)}
    fluid = {"solver": "dfsph", "particle_radius": SPACING / 2} | fluid
    return {"fps": 20, "fluid": fluid, "rigid": {"bodies": {"glass": body}}}


def assert_it_stands(x: np.ndarray, count: int) -> None:
    """All of the water is in the glass, and its middle at half its height, to 2 % for what sloshes yet, and to a tenth
    of a spacing."""
    assert len(x) == count
    assert np.hypot(x[:, 0], x[:, 2]).max() < RADIUS
    assert x[:, 1].min() > FLOOR
    height = count * SPACING**3 / (np.pi * RADIUS**2)
    assert 2 * (x[:, 1].mean() - FLOOR) == pytest.approx(height, rel=0.02, abs=0.1 * SPACING)


@pytest.mark.slow
@pytest.mark.parametrize("wall", [0.1, 0.25, 0.8, 2.0, 4.0])
def test_a_glass_holds_its_water_at_its_level_and_weighs_as_much(simulate, tmp_path, wall):
    """The level to a tenth of a spacing and the share of a layer that the kernel sees at the surface, the force to 2 %,
    three standard errors of its mean. Outermost centres are half a spacing off the wall, as off a plane, to 0.2 d."""
    glass(tmp_path, wall * SPACING)
    data = {
        "fps": 20,
        "fluid": {
            "solver": "dfsph",
            "particle_radius": SPACING / 2,
            "viscosity": 1e-4,
            "bodies": {"water": water(HEIGHT)},
        },
        "rigid": {"bodies": {"glass": {"shape": {"type": "mesh", "file": "glass.ply"}}}},
        "probes": {
            "level": {"type": "water_height", "x": 0.01, "rate": 50},
            "push": {"type": "force", "body": "glass", "rate": 50},
        },
    }
    out = simulate(data, 8, threads=1)
    x = positions(read_frame(out, 8))
    assert len(x) == pytest.approx(np.pi * RADIUS**2 * HEIGHT / SPACING**3, rel=0.005)
    outermost = np.hypot(x[:, 0], x[:, 2]).max()
    assert RADIUS - 0.7 * SPACING < outermost < RADIUS - 0.2 * SPACING
    time, level = probe(out, "level", "water_height")
    wanted = FLOOR + len(x) * SPACING**3 / (np.pi * RADIUS**2)
    assert level[time > 0.2].mean() == pytest.approx(wanted, abs=0.3 * SPACING)
    time, push = probe(out, "push", "force_y")
    assert push[time > 0.2].mean() == pytest.approx(-len(x) * RHO * SPACING**3 * G, rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("wall", [0.1, 1.0, 4.0])
def test_a_glass_is_poured_full(simulate, tmp_path, wall):
    """1.5 dl from a tap over a bottom that is dry at first. Its rim is so high that nothing splashes over it."""
    glass(tmp_path, wall * SPACING, top=0.22)
    tap = {
        "shape": {"type": "disc", "radius": 0.012},
        "position": [0.01, 0.14, 0],
        "rotation": [{"axis": [1, 0, 0], "angle": 180}],
        "rate": 1.5e-4,
        "stop": 1.0,
    }
    out = simulate(scene({"emitters": {"tap": tap}}), 36)
    assert_it_stands(positions(read_frame(out, 36)), round(1.5e-4 / SPACING**3))


@pytest.mark.slow
@pytest.mark.parametrize("wall", [0.1, 1.0, 4.0])
def test_a_glass_is_carried(simulate, tmp_path, wall):
    """Lifted off by 5 cm and set down 20 cm further on, smoothly, as by a hand that spills nothing."""
    glass(tmp_path, wall * SPACING)
    share = np.linspace(0, 1, 21)
    done = share**2 * (3 - 2 * share)
    way = tuple(
        {"at": float(0.1 + t), "position": [float(0.2 * s), float(0.2 * s * (1 - s)), 0]}
        for t, s in zip(share, done, strict=True)
    )
    out = simulate(scene({"bodies": {"water": water(HEIGHT)}}, way), 40)
    assert_it_stands(positions(read_frame(out, 40)) - [0.2, 0, 0], len(read_frame(out, 0)))


@pytest.mark.slow
@pytest.mark.parametrize("wall", [0.1, 1.0, 4.0])
def test_a_glass_is_tipped(simulate, tmp_path, wall):
    """By 45 degrees. What stands over the lip by less than a layer does not run off: one layer more may stay, and a
    tenth. Nothing is in its wall or below its bottom. Once the glass is still, nothing hops two spacings above its lip:
    drops that are pressed onto the rim are not shot off."""
    top = 0.09
    glass(tmp_path, wall * SPACING, top)
    turned = [{"axis": [0, 0, 1], "angle": -45}]
    way = ({"at": 0.1, "position": [0, 0, 0]}, {"at": 1.1, "position": [0, 0, 0], "rotation": turned})
    out = simulate(scene({"bodies": {"water": water(0.06)}}, way), 50)
    x = positions(read_frame(out, 50))
    along = (x[:, 0] + x[:, 1]) / np.sqrt(2)
    across = np.hypot((x[:, 0] - x[:, 1]) / np.sqrt(2), x[:, 2])
    inside = (across < RADIUS) & (along > FLOOR) & (along < top + SPACING)
    layers = (np.count_nonzero(inside) * SPACING**3 / (np.pi * RADIUS**2) - (top - FLOOR - RADIUS)) / SPACING
    assert 0 < layers < 1.1
    assert not np.any(~inside & (across < RADIUS + wall * SPACING) & (along < top))
    lip, spilt = (top - RADIUS) / np.sqrt(2), x[~inside]
    assert len(spilt) > 0
    assert spilt[:, 1].max() < lip + SPACING
    assert max(positions(read_frame(out, frame))[:, 1].max() for frame in range(30, 51)) < lip + 2 * SPACING


@pytest.mark.slow
def test_heavy_bodies_rest_on_the_ground_and_a_light_one_leaves_it(simulate):
    """A box and a ball of 1.2 rho0 stay where they lie under 16 layers, to a tenth of a spacing in the mean; a block of
    0.8 rho0 is up where Archimedes has it."""
    spacing = 0.015
    tank, depth = (0.6, 0.6, 0.45), 0.24
    water = {"shape": {"type": "box", "size": [tank[0], depth, tank[2]]}, "position": [0, depth / 2, 0]}
    heavy = {"motion": "dynamic", "density": 1200}
    bodies = {
        "box": {"shape": {"type": "box", "size": [0.1, 0.06, 0.1]}, "position": [-0.18, 0.03, 0]} | heavy,
        "ball": {"shape": {"type": "sphere", "radius": 0.05}, "position": [0, 0.05, 0]} | heavy,
        "light": {"shape": {"type": "box", "size": [0.12, 0.09, 0.12]}, "position": [0.18, 0.045, 0]}
        | {"motion": "dynamic", "density": 800},
    }
    data = {
        "fps": 20,
        "containers": {"tank": {"type": "box", "size": list(tank)}},
        "fluid": {"solver": "dfsph", "particle_radius": spacing / 2, "bodies": {"water": water}},
        "rigid": {"bodies": bodies},
    }
    out = simulate(data, 50, threads=1)
    table = read_table(out / "bodies.csv")

    def height(name):
        return table["y"][table["body"] == name]

    x, z = (table[axis][table["body"] == "box"] for axis in ("x", "z"))
    assert np.hypot(x - x[0], z - z[0]).max() < 0.1 * spacing

    assert height("box")[10:].mean() == pytest.approx(0.03, abs=0.1 * spacing)
    assert height("ball")[10:].mean() == pytest.approx(0.05, abs=0.1 * spacing)
    level = (len(read_frame(out, 50)) * spacing**3 + 0.1 * 0.06 * 0.1 + 4 / 3 * np.pi * 0.05**3) / (tank[0] * tank[2])
    level += 0.8 * 0.12 * 0.09 * 0.12 / (tank[0] * tank[2])
    assert height("light")[-6:].mean() == pytest.approx(level - (0.8 - 0.5) * 0.09, abs=spacing)


@pytest.mark.slow
@pytest.mark.parametrize("radius", [0.03, 0.05])
def test_a_ball_on_the_ground_is_not_driven(simulate, radius):
    """Nothing holds it, so that it tells the mean force on it: with less than 0.5 % of the weight of its water it rolls
    less than F t^2 / 2 (7/5 m + m_w/2), m_w that water's mass, in 1.6 s."""
    ball = {"shape": {"type": "sphere", "radius": radius}, "position": [0.02, radius, 0.013]}
    water = {"shape": {"type": "box", "size": [0.42, 0.18, 0.42]}, "position": [0, 0.09, 0]}
    data = {
        "fps": 20,
        "containers": {"tank": {"type": "box", "size": [0.42, 0.4, 0.42]}},
        "fluid": {"solver": "dfsph", "particle_radius": 0.0075, "bodies": {"water": water}},
        "rigid": {"bodies": {"ball": ball | {"motion": "dynamic", "density": 1200}}},
    }
    table = read_table(simulate(data, 32, threads=1) / "bodies.csv")
    way = np.hypot(table["x"] - table["x"][0], table["z"] - table["z"][0]).max()
    assert way < 0.005 * G * 1.6**2 / 2 / (7 / 5 * 1.2 + 1 / 2)


@pytest.mark.slow
def test_a_ball_beside_a_box_and_a_plate_is_not_driven(simulate):
    """Nor by what others stir: water that circulated around them would roll it away. They stay to a tenth of a
    spacing."""
    spacing, tank, depth, radius, seconds = 0.015, (0.6, 0.6, 0.45), 0.24, 0.05, 2.0
    water = {"shape": {"type": "box", "size": [tank[0], depth, tank[2]]}, "position": [0, depth / 2, 0]}
    bodies = {
        "box": {"shape": {"type": "box", "size": [0.1, 0.06, 0.1]}, "density": 1200, "position": [-0.18, 0.03, 0]},
        "ball": {"shape": {"type": "sphere", "radius": radius}, "density": 1200, "position": [0, radius, 0]},
        "plate": {"shape": {"type": "box", "size": [0.12, 0.01, 0.12]}, "density": 1500, "position": [0.18, 0.005, 0]},
    }
    data = {
        "fps": 25,
        "containers": {"tank": {"type": "box", "size": list(tank)}},
        "fluid": {"solver": "dfsph", "particle_radius": spacing / 2, "bodies": {"water": water}},
        "rigid": {"bodies": {name: body | {"motion": "dynamic"} for name, body in bodies.items()}},
    }
    table = read_table(simulate(data, round(25 * seconds), threads=1) / "bodies.csv")

    def way(name):
        x, z = (table[axis][table["body"] == name] for axis in ("x", "z"))
        return np.hypot(x - x[0], z - z[0]).max()

    assert way("box") < 0.1 * spacing
    assert way("plate") < 0.1 * spacing
    assert way("ball") < 0.005 * G * seconds**2 / 2 / (7 / 5 * 1.2 + 1 / 2)
