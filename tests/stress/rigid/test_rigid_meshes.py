"""Dynamic bodies with meshes that are broken: mended, and then the body that was meant, or refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

from scene.settings import Refused
from tests.support.bodies import G, ground, part, step, tilt
from tests.support.in_time import in_time
from tests.support.meshes import body, broken_boxes, without_mass, write
from tests.support.particles import read_table

SIZE = (0.2, 0.1, 0.3)
DENSITY = 500.0
BROKEN = broken_boxes(SIZE)
REFUSED = without_mass()


def made(path: Path, name: str, **settings):
    return part({"box": body(write(path / "box.off", BROKEN[name][0]), density=DENSITY, **settings), "floor": ground()})


@pytest.mark.outcome("A")
@pytest.mark.parametrize("name", BROKEN)
def test_a_mended_box_has_the_mass_of_the_box(tmp_path, name):
    """m = rho a b c and I_x = m (b^2 + c^2) / 12, to rounding: the polyhedron is the box."""
    from sim.bodies.obstacles import find_obstacles
    from sim.spec import SimulationSpec

    bodies = {"box": body(write(tmp_path / "box.off", BROKEN[name][0]))}
    [item] = find_obstacles(SimulationSpec.model_validate({"fps": 24, "rigid": {"bodies": bodies}}), tmp_path).placed
    a, b, c = SIZE
    mass = DENSITY * a * b * c
    found = item.solid.mass_properties(DENSITY)
    assert found.mass == pytest.approx(mass, rel=1e-9)
    assert found.centre == pytest.approx(np.zeros(3), abs=1e-9)
    inertia = mass / 12 * np.diag([b * b + c * c, a * a + c * c, a * a + b * b])
    assert found.inertia == pytest.approx(inertia, rel=1e-9, abs=1e-9 * inertia.max())
    assert BROKEN[name][1] in "; ".join(item.solid.report.lines())


@pytest.mark.outcome("A")
@pytest.mark.parametrize(
    "name", ["a triangle missing", *in_time(*(name for name in BROKEN if name != "a triangle missing"))]
)
def test_a_mended_box_falls_and_comes_to_rest_at_half_its_height(tmp_path, name):
    """y = y0 - g t^2 / 2 until it lands; then b / 2 and level, to the overlap of 1.1e-4 of its size that is let be."""
    bodies = made(tmp_path, name, position=[0, 0.3, 0])
    step(bodies, 0.15)
    assert bodies.position[0] == pytest.approx([0, 0.3 - G * 0.15**2 / 2, 0], abs=1e-9)
    step(bodies, 0.65)
    let_be = 1.1e-4 * SIZE[1]
    landed = bodies.position[0].copy()
    assert landed[1] == pytest.approx(SIZE[1] / 2, abs=let_be)
    step(bodies, 0.2)
    assert np.linalg.norm(bodies.position[0] - landed) < let_be
    assert tilt(bodies) < 2 * let_be / SIZE[0]


@pytest.mark.outcome("A")
@pytest.mark.parametrize("offset", [[0.1, 0.04, 0.06], [0.1, 0, 0]])
def test_boxes_that_overlap_have_the_mass_of_both_less_what_they_share(tmp_path, offset):
    from sim.geometry.shapes import place
    from sim.geometry.spec import MeshFile, Placement

    a, b, c = SIZE
    box = trimesh.creation.box(SIZE)
    faces, vertices = np.asarray(box.faces), np.asarray(box.vertices)
    write(tmp_path / "two.off", (np.vstack((vertices, vertices + offset)), np.vstack((faces, faces + 8))))
    solid = place(MeshFile(type="mesh", file="two.off"), Placement(), tmp_path)
    shared = (a - offset[0]) * (b - offset[1]) * (c - offset[2])
    found = solid.mass_properties(DENSITY)
    assert found.mass == pytest.approx(DENSITY * (2 * a * b * c - shared), rel=1e-12)
    assert found.centre == pytest.approx(np.array(offset) / 2, abs=1e-12 * a)
    assert solid.volume == pytest.approx(2 * a * b * c - shared, rel=1e-12)
    assert "united 2 pieces, which overlap" in solid.report.lines()


def test_a_run_says_what_it_mended(simulate, tmp_path, capsys):
    write(tmp_path / "box.off", BROKEN["inside out"][0])
    bodies = {"crate": body(Path("box.off"), position=[0, 0.3, 0]), "floor": ground()}
    out = simulate({"fps": 24, "rigid": {"bodies": bodies}}, 12)
    said = capsys.readouterr().err
    assert said.count("crate: the mesh was mended: turned 1 piece inside out") == 1
    assert "turned 1 piece inside out" in json.loads((out / "summary.json").read_text())["repaired"]["crate"]
    table = read_table(out / "bodies.csv")
    assert all(np.isfinite(table[name]).all() for name in table.dtype.names if table.dtype[name].kind == "f")
    simulate({"fps": 24, "rigid": {"bodies": bodies}}, 14, first=13, state=out / "state_00012.npz")
    assert "crate: the mesh was mended" in capsys.readouterr().err


@pytest.mark.outcome("B")
@pytest.mark.parametrize("name", REFUSED)
def test_what_has_no_mass_is_refused(simulate, tmp_path, name):
    build, says = REFUSED[name]
    write(tmp_path / "bad.off", build())
    with pytest.raises(Refused, match=says) as refused:
        simulate({"fps": 24, "rigid": {"bodies": {"thing": body(Path("bad.off"))}}}, 1)
    assert refused.value.location[:4] == ("rigid", "bodies", "thing", "shape")
    assert refused.value.remedy
    assert not list(tmp_path.glob("run/*.npz"))
