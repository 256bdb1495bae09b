"""Where points of cloth are in the cloth, which pictures take its pattern from."""

import json
import subprocess
import sys

import numpy as np
import pytest

from common.ply import columns, read_mesh

TURNS = [{"axis": [1, 2, 3], "angle": 50}]
SHEET = {"shape": {"type": "sheet", "size": [0.2, 0.1]}, "spacing": 0.05, "thickness": 0.004}


@pytest.mark.parametrize("rest_scale", [1.0, 1.5])
def test_a_frame_says_where_points_are_in_the_cloth(tmp_path, rest_scale):
    """A sheet of 0.2 m by 0.1 m, drawn twice as large, wherever it hangs; its threads have their lengths at rest."""
    placed = SHEET | {"position": [1, 2, 3], "rotation": TURNS, "scale": 2, "rest_scale": rest_scale}
    scene = tmp_path / "scene.yaml"
    scene.write_text(json.dumps({"duration": 0.125, "cloth": {"sheets": {"flag": placed}}}))
    command = [sys.executable, "-m", "sim", "run", str(scene), "--out", str(tmp_path), "--frames", "0:0"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    points, faces = read_mesh(tmp_path / "cloth_flag_00000.ply")
    place, rest = (columns(points, names) for names in (("x", "y", "z"), ("rest_x", "rest_y", "rest_z")))
    size = np.array([0.4, 0.0, 0.2]) * rest_scale
    assert rest.max(axis=0) == pytest.approx(size / 2, abs=1e-6)
    assert rest.min(axis=0) == pytest.approx(-size / 2, abs=1e-6)
    one, other = faces[:, 0], faces[:, 1]
    lengths = [np.linalg.norm(where[one] - where[other], axis=1) for where in (place, rest)]
    assert lengths[1] == pytest.approx(rest_scale * lengths[0], rel=1e-5)
    assert points["thickness"] == pytest.approx(0.004)
