"""Wedges: their combinations and names, and the sheet and table of their films."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
from PIL import Image

from common.manifest import Manifest
from scene.document import SceneError
from scene.load import combination_of, load
from scene.settings import Refused
from scene.wedge import combinations, split
from tests.support import falling_ball
from workflow.wedge.__main__ import main

SCENE = falling_ball.scene(
    0.5,
    """\
film: {copy_to: gallery/ball.mp4}
wedge:
  rigid.bodies.ball.restitution: [0, 0.5]
  gravity: [[0, -9.81, 0], [0, -1.62, 0]]
""",
)


@pytest.fixture
def scene(tmp_path, monkeypatch):
    """Writes a scene file with parts of its text replaced."""
    monkeypatch.chdir(tmp_path)

    return lambda *replaced: falling_ball.written(tmp_path / "scenes" / "ball.yaml", SCENE, *replaced)


def test_every_combination_is_a_scene(scene):
    path = scene()
    whole = load(path)
    names = [found.name for found in whole.wedge]
    assert names[:2] == ["restitution=0,gravity=0_-9.81_0", "restitution=0,gravity=0_-1.62_0"]
    assert len(names) == 4
    moon = combination_of(whole, names[3])
    assert moon.name == f"ball@{names[3]}"
    assert split(moon.name) == ("ball", names[3])
    assert moon.simulation.gravity == (0, -1.62, 0)
    assert moon.simulation.rigid.bodies["ball"].restitution == 0.5
    slow = load(path, overrides=["duration=2"])
    assert combination_of(slow, names[3], ["duration=2"]).duration == 2
    assert (whole.film.copy_to, moon.film.copy_to) == ("gallery/ball.mp4", None)


def test_names_tell_paths_and_values_apart():
    found = combinations({"a.size": ["1 mm", 1], "b.size": [1e-6], "c": [True, None, {"x": [1, 2]}]})
    names = [one.name for one in found]
    assert len(set(names)) == len(names) == 6
    assert names[0] == "a.size=1mm,b.size=1e-06,c=true"
    # Values that are written alike still have names of their own.
    alike = [one.name for one in combinations({"a": ["x y", "xy", "x/y"]})]
    assert len(set(alike)) == 3
    assert all(len(one.name) < 100 and "/" not in one.name for one in combinations({"a": ["x" * 300, "y/" * 200]}))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[0, 0.5]", "[]", "wedge.rigid.bodies.ball.restitution"),
        ("gravity:", "quality:", "this cannot be varied"),
        ("[[0, -9.81, 0], [0, -1.62, 0]]", f"{list(range(600))}", "1,200 combinations"),
    ],
)
def test_what_is_no_wedge_is_refused(scene, old, new, words):
    path = scene((old, new))
    with pytest.raises(SceneError, match=words):
        load(path)


def test_a_value_that_does_not_fit_is_named_with_its_line(scene):
    path = scene(("[0, 0.5]", "[0, 5]"))
    with pytest.raises(SceneError, match=r"ball.yaml:7: wedge: rigid.bodies.ball.restitution=5: .* at most 1"):
        combination_of(load(path), load(path).wedge[2].name)


def test_a_combination_that_is_not_there_is_named(scene):
    path = scene()
    with pytest.raises(SceneError, match=r"did you mean 'restitution=0,gravity=0_-1\.62_0'"):
        combination_of(load(path), "restitution=0,gravity=0_-1.6_0")
    path = scene((SCENE[SCENE.index("wedge:") :], ""))
    with pytest.raises(SceneError, match="give the scene a `wedge:`"):
        combination_of(load(path), "gravity=1")


def test_too_many_are_refused():
    with pytest.raises(Refused, match="1,001"):
        combinations({"a": list(range(1001))})


def films(folder: Path, count: int) -> list[dict]:
    made = []
    for k in range(count):
        place = folder / f"film{k}"
        (place / "frames").mkdir(parents=True)
        for frame in range(6):
            Image.new("RGB", (32, 18), (40 * frame, 5 * k, 200)).save(place / "frames" / f"{frame:05d}.png")
        summary = {"status": "done", "frames": 6, "fps": 2.0, "simulated_s": 2.5, "warnings": []}
        summary |= {"counts": {"steps": 7}, "wall_s": {"simulate": {"total": 1.5 + k}}}
        (place / "summary.json").write_text(json.dumps(summary))
        made.append({"name": f"pond@size={k}", "folder": str(place), "chosen": {"body.size": k}})
    return made


@pytest.mark.parametrize(("count", "columns", "rows"), [(3, 4, 3), (20, 5, 4)])
def test_the_sheet_and_the_table(tmp_path, count, columns, rows):
    spec = json.dumps({"name": "pond", "films": films(tmp_path, count)})
    assert main(["--spec", spec, "--out", str(tmp_path / "out")]) == 0
    with (tmp_path / "out" / "table.csv").open() as file:
        table = list(csv.DictReader(file))
    assert [row["body.size"] for row in table] == [str(k) for k in range(count)]
    assert (table[2]["steps"], table[2]["simulate_s"], table[2]["status"]) == ("7", "3.5", "done")
    with Image.open(tmp_path / "out" / "contact.png") as sheet:
        # The last picture of the last film stands at the lower right of the grid.
        across, down = sheet.width / columns, sheet.height / rows
        red, green, _ = sheet.getpixel((int((columns - 0.5) * across), int((rows - 0.5) * down)))
    assert (red, green) == (200, 5 * (count - 1))


def test_a_spoiled_picture_is_not_compared(tmp_path, capsys):
    spec = {"name": "pond", "films": films(tmp_path, 2)}
    folder = Path(spec["films"][1]["folder"])
    Manifest.of(folder, "plan").write(folder)
    picture = folder / "frames" / "00005.png"
    picture.write_bytes(bytes(picture.stat().st_size))
    assert main(["--spec", json.dumps(spec), "--out", str(tmp_path / "out")]) == 2
    assert f"{picture} no longer holds" in capsys.readouterr().err
