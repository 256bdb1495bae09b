"""A tub that is filled by a tap: Archimedes says how deep it floats, and whether it goes down.

An empty tub of mass m and outer radius R draws m / (rho0 pi R^2). Filled to the brim, one denser than the fluid sinks,
and one less dense floats with its material alone to carry it.
"""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from tests.support.fluid.solvers import run
from tests.support.particles import positions, read_frame, read_table

D, RHO = 0.02, 1000.0
INNER, HIGH, LEVEL = 0.12, 0.14, 0.3
TANK = [0.7, 0.9, 0.6]
SET, START, STOP, END = 0.4, 1.6, 3.2, 5.2


def tub(folder, wall: float) -> tuple[float, float]:
    """Write a round tub with walls and a bottom of this thickness [m], its origin the centre of its mass; returns the
    height of its bottom above that, and its volume [m^3]."""
    outer = INNER + wall
    outline = np.array([[0, 0], [outer, 0], [outer, HIGH], [INNER, HIGH], [INNER, wall], [0, wall]])
    mesh = trimesh.creation.revolve(outline, sections=48)
    mesh.vertices = mesh.vertices[:, [1, 2, 0]]
    if mesh.volume < 0:
        mesh.invert()
    mesh.apply_translation(-mesh.center_mass)
    mesh.export(folder / "tub.ply")
    return float(mesh.bounds[0, 1]), float(mesh.volume)


def filled(folder, wall: float, density: float) -> tuple[dict, float, float]:
    """The scene, in which the tub is let go as deep as it floats; the height of its bottom [m], and its mass [kg].

    Let go on the surface, it would dive by as much again, and a deep one ship water. A plug keeps it dry until then.
    """
    bottom, volume = tub(folder, wall)
    mass = density * volume
    keel = LEVEL - mass / (RHO * np.pi * (INNER + wall) ** 2)
    water = {"shape": {"type": "box", "size": [TANK[0], LEVEL, TANK[2]]}, "position": [0, LEVEL / 2, 0]}
    tap = {
        "shape": {"type": "disc", "radius": 0.04},
        "position": [0, 0.75, 0],
        "rotation": [{"axis": [1, 0, 0], "angle": 180}],
        "rate": "5 l/s",
        "start": START,
        "stop": STOP,
    }
    inside = HIGH - wall
    bodies = {
        "hull": {
            "shape": {"type": "mesh", "file": "tub.ply"},
            "position": [0, float(keel - bottom), 0],
            "density": density,
        },
        "plug": {
            "shape": {"type": "cylinder", "radius": INNER - 1e-3, "height": inside - 1e-3},
            "position": [0, float(keel + wall + inside / 2), 0],
        },
    }
    let_go = {"at": SET, "set": {"rigid.bodies.hull.motion": "dynamic"}, "remove": ["plug"]}
    data = {
        "fps": 20,
        "containers": {"tank": {"type": "box", "size": TANK}},
        "fluid": {
            "solver": "dfsph",
            "particle_radius": D / 2,
            "bodies": {"water": water},
            "emitters": {"tap": tap},
        },
        "rigid": {"bodies": bodies},
        "events": [let_go],
    }
    return data, bottom, mass


def floated(out, bottom: float, mass: float, wall: float, times: tuple[float, float]) -> tuple[float, float, float]:
    """Mean height of the bottom [m] between two times [s], the one by Archimedes, and litres inside."""
    table = read_table(out / "bodies.csv")
    within = (table["time"] > times[0]) & (table["time"] <= times[1])
    height = table["y"][within].mean() + bottom
    x = positions(read_frame(out, round(20 * times[1])))
    inside = (np.hypot(*(x[:, [0, 2]] - [table["x"][within][-1], table["z"][within][-1]]).T) < INNER) & (
        x[:, 1] > table["y"][within][-1] + bottom + wall / 2
    )
    held = inside.sum() * RHO * D**3
    displaced = (mass + held) / RHO
    level = ((len(x) - inside.sum()) * D**3 + displaced) / (TANK[0] * TANK[2])
    return height, level - displaced / (np.pi * (INNER + wall) ** 2), held


@pytest.mark.slow
@pytest.mark.parametrize(("wall", "density"), [(D, 1200), (2 * D, 1200), (D, 600), (D, 2000)])
def test_a_tub_floats_empty_and_filled_as_archimedes_says(tmp_path, wall, density):
    """To half a spacing, to which floor and surface are known; one that is denser than water goes down."""
    data, bottom, mass = filled(tmp_path, wall, density)
    out = run(data, tmp_path, round(20 * END))
    height, wanted, held = floated(out, bottom, mass, wall, (START - 0.6, START))
    print("empty", height, wanted, held)
    late, deep, full = floated(out, bottom, mass, wall, (END - 0.6, END))
    print("filled", late, deep, full)
    assert held == 0
    assert height == pytest.approx(wanted, abs=D / 2)
    if density > RHO:
        assert late + HIGH < LEVEL
    else:
        assert full > 1
        assert late == pytest.approx(deep, abs=D / 2)
