"""What the stage before has left and something has spoiled since is refused by name, and never shown."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from common.manifest import Manifest
from common.ply import FLUID_POINT, write_points
from render.__main__ import main as render
from render.errors import Unusable
from render.inputs import Inputs
from scene.settings import Refused
from workflow.film import main as film
from workflow.reconstruct import main as reconstruct
from workflow.stages.bodies import Bodies
from workflow.stages.film import tables

BODIES = "frame,time,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz\n0,0,ball,0,0,0,1,0,0,0,0,0,0,0,0,0\n"


def spoil(path: Path) -> None:
    """Other bytes in the last third, as many, unnoticed by the time of the file."""
    state, content = path.stat(), path.read_bytes()
    whole = 2 * len(content) // 3
    path.write_bytes(content[:whole] + bytes(len(content) - whole))
    os.utime(path, ns=(state.st_atime_ns, state.st_mtime_ns))


@pytest.fixture
def simulation(tmp_path) -> Path:
    """A frame of some particles, and bodies."""
    folder = tmp_path / "simulation"
    folder.mkdir()
    points = np.zeros(60, FLUID_POINT)
    points["x"], points["y"], points["z"] = 0.02 * np.indices((3, 4, 5)).reshape(3, -1)
    points["density"], points["id"] = 1000.0, np.arange(60)
    write_points(folder / "fluid_00000.ply", points)
    (folder / "bodies.csv").write_text(BODIES)
    return folder


@pytest.fixture
def pictures(tmp_path) -> Path:
    folder = tmp_path / "frames"
    folder.mkdir()
    noise = np.random.default_rng(1).integers(0, 255, (48, 64, 3), np.uint8)
    Image.fromarray(noise).save(folder / "00000.png")
    return folder


def test_particles_with_other_bytes(simulation, tmp_path, capsys):
    """In a file that can be read as before: only the sum in the manifest tells."""
    arguments = ["--spec", '{"particle_radius": 0.01}', "--simulation", str(simulation), "--frames", "0:0"]
    arguments += ["--out", str(tmp_path / "out")]
    Manifest.of(simulation, "plan").write(simulation)
    assert reconstruct(arguments) == 0
    spoil(simulation / "fluid_00000.ply")
    assert reconstruct(arguments) == 2
    said = capsys.readouterr().err
    assert f"{simulation / 'fluid_00000.ply'} no longer holds" in said
    assert f"delete the folder {simulation} and run the same command again" in said


@pytest.mark.parametrize("made_by", ["job", "hand"])
def test_a_broken_picture(pictures, tmp_path, monkeypatch, capsys, made_by):
    monkeypatch.chdir(tmp_path)
    if made_by == "job":
        Manifest.of(pictures, "plan").write(pictures)
    arguments = ["--spec", '{"name": "pond", "fps": 8, "last_frame": 0}', "--frames-from", str(pictures)]
    arguments += ["--out", str(tmp_path / "out")]
    assert film(arguments) == 0
    spoil(pictures / "00000.png")
    assert film([*arguments[:-1], str(tmp_path / "again")]) == 2
    said = capsys.readouterr().err
    assert str(pictures / "00000.png") in said
    assert "delete" in said
    assert not (tmp_path / "again" / "pond.mp4").exists()


@pytest.mark.parametrize("name", ["bodies.csv", "summary.json", "body_ball.ply", "cloth_flag_00000.ply"])
def test_pictures_of_what_is_spoiled_are_not_rendered(simulation, tmp_path, capsys, name):
    (simulation / name).write_bytes(b"1,2,3" * 20)
    Manifest.of(simulation, "plan").write(simulation)
    spoil(simulation / name)
    assert render(["--spec", "{}", "--simulation", str(simulation), "--frames", "0:0", "--out", str(tmp_path)]) == 2
    assert f"{simulation / name} no longer holds" in capsys.readouterr().err


@pytest.mark.parametrize(
    "content",
    [bytes(len(BODIES)), b"", BODIES.encode()[:60] + bytes(40), b"\xff" * 100],
    ids=["zeros", "empty", "half", "no text"],
)
def test_a_table_that_is_none(simulation, content):
    """Without a manifest, as `python -m sim run` leaves a folder: an empty table would be a film without bodies."""
    path = simulation / "bodies.csv"
    path.write_bytes(content)
    with pytest.raises(Refused, match=r"bodies\.csv"):
        Bodies([simulation])
    with pytest.raises(Unusable, match=r"bodies\.csv.*\n.*delete"):
        Inputs(simulation, None).poses([0])


def test_tables_of_zeros(simulation, tmp_path):
    (simulation / "steps.csv").write_bytes(bytes(200))
    with pytest.raises(Refused, match=r"steps\.csv is not a table"):
        tables.concatenate([simulation / "steps.csv"], tmp_path / "steps.csv")
