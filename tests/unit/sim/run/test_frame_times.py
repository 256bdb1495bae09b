"""Frames are where the ratio of whole numbers says, in the tables of the simulation, however many there are."""

from __future__ import annotations

import csv
import subprocess
import sys
from fractions import Fraction

import pytest

SCENE = """\
duration: {duration}
fps: {fps}
rigid:
  bodies:
    ball: {{shape: {{type: sphere, radius: 0.1}}, position: [0, 1, 0], motion: prescribed, velocity: [1, 0, 0]}}
"""


@pytest.mark.parametrize(("fps", "ratio"), [("24000/1001", Fraction(24000, 1001)), ("24", Fraction(24))])
def test_no_frame_drifts(tmp_path, fps, ratio):
    """The table has nine digits; a rate rounded to three decimals would be off in the sixth."""
    frames = 480
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE.format(duration=float(frames / ratio), fps=fps))
    out = tmp_path / "out"
    command = [sys.executable, "-m", "sim", "run", str(scene), "--out", str(out), "--frames", f"0:{frames}"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    with open(out / "bodies.csv", encoding="utf-8") as table:
        rows = list(csv.DictReader(table))
    assert [int(row["frame"]) for row in rows] == list(range(frames + 1))
    for row in rows:
        exact = float(int(row["frame"]) / ratio)
        assert float(row["time"]) == pytest.approx(exact, rel=5e-9, abs=0)
        assert float(row["x"]) == pytest.approx(exact, rel=1e-8, abs=1e-9), "a metre a second"
