"""Quantities of tables, and their errors, against what they were made from."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from PIL import Image

from common.ply import write_surface
from scene.settings import Refused
from workflow.study import measure
from workflow.study.spec import ByFormula, ByTable, Quantity

TIMES = np.linspace(0, 3, 301)


@pytest.fixture
def folder(tmp_path):
    """Tables in which a probe falls freely, a body swings, and energy grows."""
    rows = [f"{t!r},ball,height,{5 - 9.81 * t * t / 2!r},m" for t in TIMES.tolist()]
    rows += [f"{t!r},other,height,7,m" for t in TIMES.tolist()]
    tmp_path.joinpath("probes.csv").write_text("\n".join(["time,probe,quantity,value,unit", *rows]) + "\n")
    swing = 0.3 + 0.1 * np.exp(-0.4 * TIMES) * np.cos(5 * TIMES + 1)
    rows = [f"{k},{t!r},box,{x!r}" for k, (t, x) in enumerate(zip(TIMES.tolist(), swing.tolist(), strict=True))]
    tmp_path.joinpath("bodies.csv").write_text("\n".join(["frame,time,body,x", *rows]) + "\n")
    rows = [f"{k},{t!r},{2 + t!r}" for k, t in enumerate(TIMES.tolist())]
    tmp_path.joinpath("steps.csv").write_text("\n".join(["step,time,energy", *rows]) + "\n")
    return tmp_path


def quantity(**settings) -> Quantity:
    return Quantity.model_validate({"name": "it", **settings})


HEIGHT = {"of": "ball", "column": "height"}


def error(folder, settings: dict, value: str, scale=None, **where) -> float:
    asked = quantity(**settings)
    reference = ByFormula(type="formula", value=value, where=where, source="")
    return measure.error(asked, measure.truth(reference, asked, scale, folder), folder)[1]


def test_single_values(folder):
    steps = {"table": "steps", "column": "energy"}
    for take, expected in [("last", 5), ("maximum", 5), ("minimum", 2), ("mean", 3.5), ("change", 3)]:
        assert error(folder, {**steps, "take": take}, str(expected)) < 1e-12
        assert error(folder, {**steps, "take": take}, f"2 * {expected}") == pytest.approx(0.5)
    assert error(folder, {**steps, "take": "mean", "after": 1, "until": 2}, "3.5") < 1e-12
    assert error(folder, {**steps, "take": "change"}, "0", scale="2 * 6") == pytest.approx(0.25)


def test_a_curve_by_its_formula(folder):
    fall = {**HEIGHT, "take": "curve", "until": 3}
    assert error(folder, fall, "5 - g * t**2 / 2", g=9.81) < 1e-5
    # With g twice as large the difference is g t^2 / 2, whose RMS over 0 to T is g T^2 / 2 / sqrt(5).
    scale = 9.81 * 9 / 2
    assert error(folder, fall, "5 - g * t**2", scale=scale, g=9.81) == pytest.approx(5**-0.5, rel=0.01)


def test_the_period_is_that_without_damping(folder):
    swing = {"table": "bodies", "of": "box", "column": "x", "take": "period"}
    assert error(folder, swing, "2 * pi / sqrt(25 + 0.16)") < 1e-6
    with pytest.raises(Refused, match="less than one oscillation"):
        error(folder, {**swing, "until": 0.5}, "1")
    with pytest.raises(Refused):
        error(folder, {"of": "other", "column": "height", "take": "period"}, "1")


def test_a_curve_by_its_table(folder):
    folder.joinpath("measured.csv").write_text("# somebody 1900\nT,Z\n1,0.5\n0,1\n2,-1\n")
    asked = quantity(**HEIGHT, take="curve", until=2)
    reference = ByTable(type="table", file="measured.csv", time_unit="u / 2", value_unit="5", where={"u": 2}, source="")
    true = measure.truth(reference, asked, None, folder)
    assert true.times == pytest.approx([0, 1, 2])
    assert true.values == pytest.approx([5, 2.5, -5])
    found = 5 - 9.81 * true.times**2 / 2
    expected = np.sqrt(np.mean((found - true.values) ** 2)) / 5
    assert measure.error(asked, true, folder)[1] == pytest.approx(expected)


def test_a_curve_by_a_trial(folder):
    asked = quantity(**HEIGHT, take="curve")
    assert measure.error(asked, measure.truth_of_trial(asked, None, folder), folder)[1] == 0


@pytest.mark.parametrize("missing", [{**HEIGHT, "of": "cube"}, {**HEIGHT, "column": "depth"}, {**HEIGHT, "after": 9}])
def test_what_is_not_there_is_refused(folder, missing):
    with pytest.raises(Refused, match="has no value"):
        measure.series(quantity(**missing), folder)


def test_an_error_relative_to_nothing_is_refused(folder):
    with pytest.raises(Refused, match="relative to 0"):
        error(folder, {**HEIGHT, "take": "last"}, "0")


BALL = {"table": "surface", "column": "distance", "distance": "hypot(x, y, z) - 0.1"}


def ball(folder, radius: float):
    mesh = trimesh.creation.icosphere(subdivisions=5, radius=radius)
    folder.mkdir()
    zeros = np.zeros_like(mesh.vertices)
    write_surface(folder / "surface_00003.ply", mesh.vertices, zeros, zeros, mesh.faces)
    return folder


def test_surfaces(tmp_path):
    """A ball of radius r is r - R from one of radius R, everywhere."""
    folder = ball(tmp_path / "ball", 0.12)
    asked = quantity(**BALL)
    assert measure.number(asked, folder) == pytest.approx(0.02, rel=1e-3)
    true = measure.truth(ByFormula(type="formula", value=0, source=""), asked, "0.01", folder)
    assert measure.error(asked, true, folder)[1] == pytest.approx(2, rel=1e-3)
    for column, value in [("volume", "4 / 3 * pi * 0.12**3"), ("area", "4 * pi * 0.12**2")]:
        asked = quantity(table="surface", column=column)
        true = measure.truth(ByFormula(type="formula", value=value, source=""), asked, None, folder)
        assert measure.error(asked, true, folder)[1] < 0.002
    wrong = quantity(**{**BALL, "distance": "w - 0.1"})
    with pytest.raises(Refused, match="cannot be computed"):
        measure.number(wrong, folder)


def picture(folder, colors: np.ndarray):
    folder.mkdir()
    Image.fromarray(colors.astype(np.uint8)).save(folder / "00003.png")
    return folder


def test_pictures(tmp_path):
    """A tenth too bright everywhere is a tenth of error, at any resolution."""
    asked = quantity(table="picture")
    gray = np.full((40, 60, 3), 102)
    true = measure.truth_of_trial(asked, None, picture(tmp_path / "true", gray))
    for name, colors, expected in [
        ("same", gray, 0),
        ("bright", gray + 25.5 - 0.5, 25 / 255),
        ("small", np.full((20, 30, 3), 102), 0),
        ("half", np.where(np.arange(60)[None, :, None] < 30, gray, gray + 51), 0.2 / 2**0.5),
    ]:
        value, error = measure.error(asked, true, picture(tmp_path / name, colors))
        assert value is None
        assert error == pytest.approx(expected, abs=1e-9)
