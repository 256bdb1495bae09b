"""Runs with rigid bodies: the same bytes again, resumed and after events; what cannot be simulated is refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scene.settings import Refused
from tests.support.bodies import ball, box, ground, turn
from tests.support.particles import read_table


def scene(**changes: Any) -> dict[str, Any]:
    bodies = {
        "low": box((0.3, 0.2, 0.2), position=[0, 0.3, 0], rotation=turn((1, 0.3, 0), 0.4)),
        "high": ball(0.1, position=[0.05, 0.7, 0], restitution=0.6),
        "ring": {
            "motion": "dynamic",
            "shape": {"type": "torus", "radius": 0.2, "tube_radius": 0.05},
            "position": [0, 1, 0],
            "angular_velocity": [1, 2, 3],
        },
        "floor": ground(),
        "paddle": {
            "shape": {"type": "box", "size": [0.6, 0.05, 0.05]},
            "position": [0, 0.1, 0],
            "motion": "prescribed",
            "angular_velocity": [0, 3, 0],
        },
    }
    return {"fps": 24, "rigid": {"bodies": bodies}, **changes}


def results(out: Path, last: int) -> list[bytes]:
    with np.load(out / f"state_{last:05d}.npz") as state:
        arrays = [state[name].tobytes() for name in sorted(state.files) if name != "meta"]
    return [(out / "bodies.csv").read_bytes(), *arrays]


def rows(out: Path, body: str) -> np.ndarray:
    table = read_table(out / "bodies.csv")
    return table[table["body"] == body]


def test_the_same_bytes_again_and_resumed(simulate):
    whole = simulate(scene(), 12, "whole")
    assert results(simulate(scene(), 12, "again"), 12) == results(whole, 12)
    simulate(scene(), 6, "parts")
    simulate(scene(), 12, "parts", first=7, state=whole.parent / "parts" / "state_00006.npz")
    assert results(whole.parent / "parts", 12) == results(whole, 12)


@pytest.mark.slow
def test_the_same_bytes_with_one_thread(simulate):
    assert results(simulate(scene(), 6, "one", threads=1), 6) == results(simulate(scene(), 6, "two", threads=2), 6)


def test_bodies_fall_and_stay_above_the_floor(simulate):
    out = simulate(scene(), 30)
    steps = read_table(out / "steps.csv")
    assert steps["contacts"].max() > 3
    assert steps["overlap"].max() < 1e-3
    for body, least in (("low", 0.1), ("high", 0.1), ("ring", 0.05)):
        assert rows(out, body)["y"].min() > least - 1e-3
        assert rows(out, body)["y"][-1] < rows(out, body)["y"][0]
    assert json.loads((out / "summary.json").read_text())["bytes"]["rigid"] > 0


def test_an_event_adds_a_body_and_another_removes_one(simulate):
    events = [
        {"at": 0.25, "add": {"rigid": {"late": ball(0.1, position=[1, 1, 0])}}},
        {"at": 0.5, "remove": ["high"]},
    ]
    out = simulate(scene(events=events), 24)
    late, high = rows(out, "late"), rows(out, "high")
    assert late["time"][0] == pytest.approx(0.25 + 1 / 24)
    assert late["y"][late["time"] < 0.6][-1] == pytest.approx(
        1 - 9.81 / 2 * (late["time"][late["time"] < 0.6][-1] - 0.25) ** 2
    )
    assert high["time"].max() <= 0.5 + 1e-9
    undisturbed = simulate(scene(), 5, "undisturbed")
    assert rows(undisturbed, "low")["y"][5] == rows(out, "low")["y"][5]


def test_an_event_sets_a_force(simulate):
    """a = F / m, from its time on."""
    data = {"fps": 24, "gravity": [0, 0, 0], "rigid": {"bodies": {"ball": ball(0.1, mass=2)}}}
    data["events"] = [{"at": 0.5, "set": {"rigid.bodies.ball.force": [4, 0, 0]}}]
    assert rows(simulate(data, 24), "ball")["vx"][-1] == pytest.approx(2 * 0.5, rel=1e-9)


def test_a_cap_on_iterations_is_counted(simulate):
    data = scene()
    data["rigid"] |= {"max_iterations": 1, "contact_error": 1e-12}
    out = simulate(data, 12)
    counts = json.loads((out / "summary.json").read_text())["counts"]
    assert counts["contacts_capped"] == np.count_nonzero(read_table(out / "steps.csv")["contacts_capped"]) > 0


@pytest.mark.outcome("A")
@pytest.mark.parametrize("height", [0.5, 0.1, -0.05])
def test_a_body_that_starts_in_the_floor_comes_up_gently(simulate, height):
    data = {"fps": 24, "rigid": {"bodies": {"box": box((0.2, 0.2, 0.2), position=[0, height, 0]), "floor": ground()}}}
    out = simulate(data, 36)
    found = rows(out, "box")
    assert found["y"][-1] == pytest.approx(0.1, abs=1e-3)
    assert np.abs(np.diff(found["y"])).max() < 0.2
    if height < 0.1:
        assert np.abs(found["vy"]).max() < 0.05


@pytest.mark.outcome("B")
@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"restitution": 1.1}, "restitution"),
        ({"restitution": -0.1}, "restitution"),
        ({"mass": 0}, "mass"),
        ({"density": 0}, "density"),
        ({"friction": -1}, "friction"),
        ({"static_friction": 0.1}, "static_friction"),
        ({"motion": "static", "force": [1, 0, 0]}, "force"),
        ({"shape": {"type": "plane"}}, "plane"),
    ],
)
def test_settings_of_no_body_are_refused(change, field):
    from pydantic import ValidationError

    from sim.spec import SimulationSpec

    with pytest.raises(ValidationError, match=field):
        SimulationSpec.model_validate({"fps": 24, "rigid": {"bodies": {"body": {**ball(0.1), **change}}}})


@pytest.mark.outcome("B")
def test_an_open_mesh_has_no_mass(simulate, tmp_path):
    (tmp_path / "open.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n")
    body = {"motion": "dynamic", "shape": {"type": "mesh", "file": "open.obj", "repair": False}}
    with pytest.raises(Refused, match="body"):
        simulate({"fps": 24, "rigid": {"bodies": {"body": body}}}, 1)


@pytest.mark.outcome("A")
@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_thousand_bodies(simulate):
    shapes = [
        {"type": "box", "size": [0.1, 0.1, 0.1]},
        {"type": "sphere", "radius": 0.06},
        {"type": "capsule", "radius": 0.04, "height": 0.08},
    ]
    bodies = {
        f"body{k}": {
            "motion": "dynamic",
            "shape": shapes[k % 3],
            "position": [(k % 10) * 0.18 - 0.81, 0.1 + k // 100 * 0.18, (k // 10 % 10) * 0.18 - 0.81],
            "rotation": turn((1 + k % 2, k % 5, k % 7), k),
        }
        for k in range(1000)
    }
    room = {"room": {"type": "box", "size": [2, 4, 2]}}
    out = simulate({"fps": 24, "rigid": {"bodies": bodies}, "containers": room}, 24)
    table = read_table(out / "bodies.csv")
    last = table[table["frame"] == 24]
    assert last["y"].min() > 0.035
    assert np.abs(last["x"]).max() < 1 and np.abs(last["z"]).max() < 1
    assert read_table(out / "steps.csv")["overlap"].max() < 0.05


def test_a_run_warns_of_bodies_that_begin_inside_each_other(simulate, capsys):
    boxes = {
        name: {"motion": "dynamic", "shape": {"type": "box", "size": [0.2, 0.2, 0.2]}, "position": [0, height, 0]}
        for name, height in (("upper", 0.27), ("lower", 0.1))
    }
    simulate({"fps": 24, "rigid": {"bodies": {**boxes, "floor": {"shape": {"type": "plane"}}}}}, 1, quiet=False)
    assert "'upper' and 'lower' begin 30 mm inside each other" in capsys.readouterr().err
