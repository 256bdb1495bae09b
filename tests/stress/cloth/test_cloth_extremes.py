"""Cloth at the extremes: right (A), refused with exit 2 (B), or stopped with exit 3 (C); table in docs/cloth.md.

What is right is known in closed form: free fall, pendulums, stretch under weight, energy that nothing adds to.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sim.cloth.model import ClothModel
from sim.segment import main
from tests.stress.scenes import assert_nothing_broken, failure
from tests.support.cloths import HANGING, INTEGRATORS, G, part, passages, places, rope, scene, sheet, step
from tests.support.in_time import in_time
from tests.support.meshes import write
from tests.support.particles import read_table
from tests.support.stepping import advance

SIZE, SPACING = 0.5, 0.1
TILTED = [{"axis": [1, 2, 3], "angle": 40}]
STEPS = (1e-5, 1e-3, 1 / 30)
STIFFNESS = (1.0, 1e4, 1e8)
MORE_STIFFNESS = (1e2, 1e6)
MOST_SUBSTEPS = 60_000
"""Of symplectic Euler in one test."""
BOX = {"shape": {"type": "box", "size": [0.2, 0.2, 0.2]}}
ABOVE_A_BOX = {"position": [0, 0.108, 0], "rotation": [], "spacing": SPACING, "thickness": 0.01}
ROUNDING = 1e-9
"""Share by which sums of thousands of steps may differ."""
SWING = {"implicit_euler": ROUNDING, "symplectic_euler": 0.1, "xpbd": ROUNDING}
"""Share of its energy by which a taut cloth may seem to gain some: symplectic Euler keeps an energy next to the true
one, which differs in the course of a swing."""


def square(**settings):
    return sheet((SIZE, SIZE), **{"spacing": SPACING, "rotation": TILTED, **settings})


def decades(fast, slow):
    return [*fast, *in_time(*slow)]


def affordable(made, dt, steps):
    """So many steps that symplectic Euler does not take long."""
    if not hasattr(made.integrator, "stable"):
        return steps
    return max(1, min(steps, int(MOST_SUBSTEPS // np.ceil(dt / made.integrator.stable))))


def middle(made):
    return made.mesh.mass @ places(made) / made.mesh.mass.sum()


def energy(made):
    found = made.measure()
    assert found.finite
    return found.kinetic_energy + found.potential_energy + found.elastic_energy


def highest_energy(made, dt, steps, elastic=True):
    """Step; returns the highest energy after a step [J], with that of springs and hinges or without."""
    found = []
    step(made, steps * dt, dt, lambda _: found.append(energy(made) - (not elastic) * made.measure().elastic_energy))
    return max(found)


def falls_right(made, dt, steps, swing):
    """A taut sheet in free fall: its middle falls as a stone, and nothing adds to its energy."""
    before, start, taut = energy(made), middle(made), made.measure().elastic_energy
    steps = affordable(made, dt, steps)
    # What falls freely keeps its energy, but for the rounding of places, of whose differences speeds are made.
    assert highest_energy(made, dt, steps) <= before * (1 + ROUNDING) + swing * taut
    way = G * (dt * steps) ** 2 / 2
    # Positions are rounded to 1e-17 m in every step.
    assert np.abs(middle(made) - start + [0, way, 0]).max() < 1e-6 * way + 1e-14 * steps
    assert made.measure().stretch_max < 1.2


@pytest.mark.outcome("A")
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("dt", decades([1e-3, 1 / 30], [1e-5]))
@pytest.mark.parametrize("stiffness", decades(STIFFNESS, MORE_STIFFNESS))
def test_any_stiffness_and_step(integrator, dt, stiffness):
    made = part({"sheet": square(stretch_stiffness=stiffness, rest_scale=0.9)}, integrator=integrator)
    falls_right(made, dt, 30, SWING[integrator])


@pytest.mark.outcome("A")
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("dt", decades([1e-3], [1e-5, 1 / 30]))
@pytest.mark.parametrize("mass", [1e-6, 1e-4, 1e2, 1e6])
def test_any_mass(integrator, dt, mass):
    made = part({"sheet": square(mass_per_area=mass, rest_scale=0.9)}, integrator=integrator)
    falls_right(made, dt, 30, SWING[integrator])


@pytest.mark.outcome("A")
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("dt", decades([1e-5, 1 / 30], [1e-3]))
@pytest.mark.parametrize("stiffness", decades([1e6], [1e2]))
def test_the_most_damping(integrator, dt, stiffness):
    """Dampers as strong as may be take energy and give none, also where they are stiffer than the springs."""
    cloth = {"damping": 1, "bend_damping": 1, "bend_stiffness": 0.01, "rest_scale": 0.9}
    made = part({"sheet": square(stretch_stiffness=stiffness, **cloth)}, integrator=integrator)
    falls_right(made, dt, 30, ROUNDING)


@pytest.mark.outcome("A")
@pytest.mark.parametrize(
    ("integrator", "stiffness", "dt"),
    [
        ("implicit_euler", 1e4, 1 / 30),
        ("symplectic_euler", 1e4, 1 / 30),
        *in_time(*((name, 1e8, dt) for name in INTEGRATORS for dt in (1e-3, 1 / 30))),
    ],
)
def test_three_hundred_percent_of_stretch(integrator, stiffness, dt):
    """It springs back to its length at rest and stays where its middle was, as well as forces of the first step can be
    written; its energy is gone."""
    made = part(
        {"sheet": square(stretch_stiffness=stiffness, rest_scale=0.25)}, integrator=integrator, gravity=(0, 0, 0)
    )
    before, start = energy(made), middle(made)
    assert made.measure().stretch_max == pytest.approx(4)
    steps = affordable(made, dt, 40)
    assert highest_energy(made, dt, steps) <= before
    assert energy(made) < 1e-3 * before
    assert made.measure().stretch_max == pytest.approx(1, abs=0.02)
    rounding = np.finfo(float).eps * 3 * stiffness * SIZE / made.mesh.mass.sum() * dt
    assert np.abs(middle(made) - start).max() < 1e-9 + rounding * steps * dt


crumples = pytest.mark.parametrize(
    ("integrator", "stiffness", "dt"),
    [("implicit_euler", 1, 1 / 30), ("implicit_euler", 1e4, 1e-3), ("xpbd", 1e4, 1 / 30)],
)


def stretched(integrator: str, stiffness: float) -> ClothModel:
    """A sheet at four times its length at rest."""
    return part(
        {"sheet": square(stretch_stiffness=stiffness, rest_scale=0.25)}, integrator=integrator, gravity=(0, 0, 0)
    )


@pytest.mark.outcome("A")
@pytest.mark.slow
@crumples
def test_a_stretched_cloth_that_strikes_itself(integrator, stiffness, dt):
    """Slow enough to be followed, it shrinks through its length at rest and crumples."""
    made = stretched(integrator, stiffness)
    before = energy(made)
    assert highest_energy(made, dt, 60) <= before
    assert energy(made) < 1e-2 * before


@pytest.mark.outcome("A")
@pytest.mark.slow
@crumples
def test_a_stretched_cloth_that_strikes_itself_stays_where_it_is(integrator, stiffness, dt):
    """Its halves meet, and what would pass goes on as one: the momentum of the whole stays, to rounding."""
    made = stretched(integrator, stiffness)
    start, speed, held_back = middle(made), np.sqrt(2 * energy(made) / made.mesh.mass.sum()), 0
    for k in range(1, 61):
        held_back += made.advance(dt, k * dt)["cloth_held_back"]
    assert held_back > 0 or integrator == "xpbd"
    assert np.abs(middle(made) - start).max() < 1e-9 * speed * 60 * dt


@pytest.mark.outcome("A")
@pytest.mark.parametrize(
    ("integrator", "dt", "steps"),
    [
        ("implicit_euler", 1 / 30, 6),
        *(pytest.param(name, 1 / 30, 60, marks=pytest.mark.slow) for name in ("symplectic_euler", "xpbd")),
        *(pytest.param(name, 1e-5, 800, marks=pytest.mark.slow) for name in ("symplectic_euler", "xpbd")),
    ],
)
def test_springs_without_length(integrator, dt, steps):
    """All points are drawn to one, and stop where the cloth lies on itself; its middle stays where it is."""
    cloth = square(rest_scale=0, bend_stiffness=0, thickness=1e-4)
    made = part({"sheet": cloth}, integrator=integrator, gravity=(0, 0, 0))
    before, start = energy(made), middle(made)
    assert made.measure().stretch_max == 1
    assert highest_energy(made, dt, steps) <= before * (1 + SWING[integrator])
    width = np.ptp(places(made), axis=0).max()
    assert width < (0.1 if dt > 1e-4 else 0.7) * SIZE
    assert np.abs(middle(made) - start).max() < 1e-6 * SIZE


@pytest.mark.outcome("A")
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("dt", STEPS)
@pytest.mark.parametrize("slack", [1.0, 0.25])
def test_a_cloth_of_which_all_is_held(integrator, dt, slack):
    ticks = np.linspace(-SIZE / 2, SIZE / 2, 6)
    pins = [{"at": [[x, 0, z] for x in ticks for z in ticks]}]
    made = part({"sheet": sheet((SIZE, SIZE), spacing=SPACING, pins=pins, rest_scale=slack, stretch_stiffness=1e8)},
                integrator=integrator)  # fmt: skip
    start = places(made)
    assert made.mesh.held.all()
    step(made, 5 * dt, dt)
    assert (places(made) == start).all()
    assert made.measure().v_max == 0
    assert np.isfinite(made.pin_force("sheet")).all()


@pytest.mark.outcome("A")
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("dt", STEPS)
@pytest.mark.parametrize("stiffness", [1e4, 1e8])
def test_one_triangle(tmp_path, integrator, dt, stiffness):
    """Free, it falls as a stone; held at two corners, the third swings as a pendulum from the edge between them."""
    arm = 0.5
    corners = np.array([[0, 0, -0.3], [0, 0, 0.3], [arm, 0, 0]])
    path = write(tmp_path / "triangle.off", (corners, np.array([[0, 1, 2]])))
    cloth = {"shape": {"type": "mesh", "file": str(path)}, "stretch_stiffness": stiffness, "rotation": TILTED}
    made = part({"triangle": cloth}, integrator=integrator)
    falls_right(made, dt, 20, ROUNDING)
    pins = {"rotation": [], "pins": [{"at": corners[:2].tolist()}]}
    made = part({"triangle": cloth | pins}, integrator=integrator)
    before = energy(made)
    steps = affordable(made, dt, min(60, round(0.3 / dt)))
    # What sweeps of XPBD leave of the lengths is no energy to come.
    highest = highest_energy(made, dt, steps, elastic=integrator != "xpbd")
    swing = solve_ivp(lambda _, y: [y[1], G / arm * np.cos(y[0])], (0, steps * dt), [0, 0], rtol=1e-9, atol=1e-15)
    drop = arm * np.sin(swing.y[0, -1])
    # Euler's first step, of what is held, is one of a whole g dt.
    assert -places(made)[2, 1] == pytest.approx(drop, rel=0.02 + 1 / steps)
    assert highest <= before + 0.01 * made.mesh.mass[2] * G * drop
    assert np.linalg.norm(places(made)[2] - corners[:2].mean(axis=0)) == pytest.approx(arm, rel=1e-3)


@pytest.mark.outcome("A")
@pytest.mark.parametrize("stiffness", decades([1, 1e4, 1e8], [1e2, 1e6]))
def test_a_strip_hangs_by_its_weight(stiffness):
    """rho g L^2 / (2 K), from half of its length to a few atoms."""
    weight, length = 0.2, 0.5
    strip = rope(length, 5, rotation=HANGING, pins=["left"], stretch_stiffness=stiffness, mass_per_area=weight)
    made = part({"strip": strip})
    step(made, 40.0 if stiffness < 10 else 4.0, 0.1)
    stretch = np.ptp(places(made)[:, 1]) - length
    assert stretch == pytest.approx(weight * G * length**2 / (2 * stiffness), rel=1e-3, abs=1e-15)


ORDER = pytest.mark.xfail(reason="4 % above the bound, which holds for one order of sweeping over springs", strict=True)


@pytest.mark.parametrize(
    ("dt", "stiffness"), [*in_time((1e-3, 1e4), (1e-3, 1e8)), pytest.param(1 / 30, 1e4, marks=ORDER), (1 / 30, 1e8)]
)
def test_xpbd_is_softer_the_longer_its_steps(dt, stiffness):
    """What one sweep in a substep of h leaves, less than N^2 / 2 g h^2 for N springs, and a third of what is asked."""
    strip = rope(0.5, 5, rotation=HANGING, pins=["left"], stretch_stiffness=stiffness, damping=1)
    made = part({"strip": strip}, integrator="xpbd", air={"density": 100})
    step(made, 1.0, dt)
    stretch = np.ptp(places(made)[:, 1]) - 0.5
    asked = 0.2 * G * 0.5**2 / (2 * stiffness)
    assert 0 < stretch < 4 / 3 * asked + 5**2 / 2 * G * (dt / 10) ** 2


@pytest.mark.outcome("A")
@pytest.mark.parametrize("stiffness", [1.0, 1e8])
@pytest.mark.parametrize("mass", [1e-4, 1e2])
@pytest.mark.parametrize("dt", decades([1 / 30], [1e-3]))
def test_a_sheet_on_the_ground(stiffness, mass, dt):
    """It comes to lie at half its thickness, and nothing adds to its energy."""
    thickness = 0.01
    settings = {"thickness": thickness, "stretch_stiffness": stiffness, "mass_per_area": mass}
    cloth = sheet((SIZE, SIZE), spacing=SPACING, position=[0, 0.02, 0], **settings)
    world = scene({"sheet": cloth}, {"floor": {"shape": {"type": "plane"}}}, cloth={"max_step": 0.05})
    start = energy(world.cloth)
    for k in range(1, round(1.0 / dt) + 1 if dt > 0.01 else 201):
        advance(world, dt, k * dt)
        assert energy(world.cloth) <= start + 1e-6 * abs(start)
    heights = places(world.cloth)[:, 1]
    assert heights == pytest.approx(thickness / 2, rel=0.1)
    assert world.cloth.measure().v_max < 0.01


@pytest.mark.outcome("A")
@pytest.mark.slow
@pytest.mark.parametrize(
    ("stiffness", "mass", "dt"),
    [(1e2, 1e-4, 1e-3), (1e2, 1e2, 1e-3), (1e8, 0.2, 1e-3), (1e2, 1e-4, 1 / 30), (1e2, 1e2, 1 / 30)],
)
def test_a_sheet_on_a_box(stiffness, mass, dt):
    """Nothing passes its sharp edges, and nothing adds to the energy."""
    cloth = sheet((SIZE, SIZE), stretch_stiffness=stiffness, mass_per_area=mass, **ABOVE_A_BOX)
    world = scene({"sheet": cloth}, {"box": BOX}, cloth={"max_step": 0.05})
    start, touched = energy(world.cloth), 0
    for _ in range(40):
        assert passages(world, dt, dt) == 0
        assert energy(world.cloth) <= start + 1e-6 * abs(start)
        touched += world.cloth.collisions.count
    assert touched
    assert middle(world.cloth)[1] < ABOVE_A_BOX["position"][1]


def segment(folder: Path, frames: str = "0:2", **changes):
    """Exit status of the command that the workflow runs, and its folder; `changes` are settings of the scene, those of
    its sheet by name."""
    made = {"sheet": {}, "fps": 30} | changes
    cloth = {"sheets": {"sheet": square(**made.pop("sheet"))}, **made.pop("cloth", {})}
    out = folder / "out"
    status = main(["--spec", json.dumps(made | {"cloth": cloth}), "--folder", str(folder), "--frames", frames,
                   "--out", str(out), "--arch", "cpu", "--threads", "2"])  # fmt: skip
    return status, out


@pytest.mark.outcome("B")
@pytest.mark.parametrize(
    ("changes", "field", "remedy"),
    [
        ({"sheet": {"damping": 1.01}}, "cloth.sheets.sheet.damping", "less than or equal to 1"),
        ({"sheet": {"bend_damping": 2}}, "cloth.sheets.sheet.bend_damping", "less than or equal to 1"),
        ({"sheet": {"stretch_stiffness": 0}}, "cloth.sheets.sheet.stretch_stiffness", "greater than 0"),
        ({"sheet": {"stretch_stiffness": 1e13}}, "cloth.sheets.sheet.stretch_stiffness", "less than or equal to"),
        ({"sheet": {"mass_per_area": 0}}, "cloth.sheets.sheet.mass_per_area", "greater than or equal to 0.000001"),
        ({"sheet": {"rest_scale": -0.1}}, "cloth.sheets.sheet.rest_scale", "greater than or equal to 0"),
        ({"cloth": {"max_step": 0.2}}, "cloth.max_step", "less than or equal to 0.1"),
        ({"step": {"fixed": 0.01}}, "step.fixed", "raise cloth.max_step"),
        (
            {"sheet": {"stretch_stiffness": 1e12, "mass_per_area": 1e-4}, "cloth": {"integrator": "symplectic_euler"}},
            "cloth.integrator",
            "use implicit_euler",
        ),
        (
            {"sheet": {"rest_scale": 0}, "cloth": {"integrator": "symplectic_euler"}},
            "cloth.integrator",
            "bend_stiffness",
        ),
    ],
)
def test_refused(tmp_path, capsys, changes, field, remedy):
    status, out = segment(tmp_path, **changes)
    told = capsys.readouterr().err
    assert status == 2, told
    assert field in told and remedy in told
    assert not list(out.glob("*.ply"))


@pytest.mark.parametrize(
    ("integrator", "stiffness", "slack", "expected"),
    [
        *in_time(("implicit_euler", 1e8, 1.0, 0)),
        ("implicit_euler", 1e4, 0.25, 0),
        ("implicit_euler", 1e8, 0.25, 3),
        ("symplectic_euler", 1e6, 0.25, 0),
        ("xpbd", 1e8, 0.25, 0),
    ],
)
def test_runs_at_the_extremes_leave_sound_files(tmp_path, capsys, integrator, stiffness, slack, expected):
    """A sheet that one side holds, loose or stretched, in the longest steps; what ended at a cap is counted."""
    cloth = {"integrator": integrator, "max_step": 0.05}
    sheet = {"stretch_stiffness": stiffness, "rest_scale": slack, "pins": ["left"], "rotation": []}
    status, out = segment(tmp_path, step={"fixed": 1 / 30}, cloth=cloth, sheet=sheet)
    assert status == expected, capsys.readouterr().err
    assert_nothing_broken(out)
    counts = json.loads((out / "summary.json").read_text())["counts"]
    assert {"cloth_capped", "cloth_held_back"} <= set(counts)


@pytest.mark.outcome("C")
def test_stopped_with_the_last_good_state(tmp_path, capsys):
    """An event makes the cloth stiffer than explicit steps can follow."""
    event = {"at": 0.05, "set": {"cloth.sheets.sheet.stretch_stiffness": 1e12}}
    status, out = segment(tmp_path, "0:4", cloth={"integrator": "symplectic_euler"}, events=[event])
    assert status == 3, capsys.readouterr().err
    assert "implicit_euler" in failure(out)["change"]
    assert_nothing_broken(out)


@pytest.mark.outcome("A")
@pytest.mark.slow
def test_shorter_steps_find_what_long_ones_do_not(tmp_path, capsys):
    """Contacts and 1e8 N/m in steps of 1/30 s: what Newton's method leaves there would throw the cloth up."""
    sheet = {"stretch_stiffness": 1e8, **ABOVE_A_BOX}
    status, out = segment(tmp_path, "0:4", cloth={"max_step": 0.05}, sheet=sheet, rigid={"bodies": {"box": BOX}})
    assert status == 0, capsys.readouterr().err
    assert json.loads((out / "summary.json").read_text())["counts"]["retries"] > 0
    table = read_table(out / "steps.csv")
    energy = sum(table[f"cloth_{kind}_energy"] for kind in ("kinetic", "potential", "elastic"))
    assert (energy <= energy[0] + 1e-6 * abs(energy[0])).all()
    assert_nothing_broken(out)


@pytest.mark.outcome("C")
@pytest.mark.slow
def test_stopped_where_no_solution_is_found(tmp_path, capsys):
    """The same with the stiffest cloth that there may be."""
    sheet = {"stretch_stiffness": 1e12, **ABOVE_A_BOX}
    status, out = segment(tmp_path, "0:4", cloth={"max_step": 0.05}, sheet=sheet, rigid={"bodies": {"box": BOX}})
    assert status == 3, capsys.readouterr().err
    report = failure(out)
    assert "far from balanced" in report["detected"] and "cloth.max_step" in report["change"]
    assert_nothing_broken(out)
