"""A scene compiles the kernels of what it has, and no others."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
FLUID = {"solver": "dfsph", "particle_radius": 0.02, "bodies": {"b": {"shape": {"type": "sphere", "radius": 0.06}}}}
FEATURES = {
    "tension": {"surface_tension": 0.07, "surface_tension_model": "akinci2013"},
    "adhesion": {"adhesion": 0.05},
    "viscosity": {"viscosity": 10.0},
    "xsph": {"xsph": 0.1},
}
"""Settings by the module of sim.fluid that they need."""
ABSENT = ("tension", "adhesion", "viscosity", "xsph", "wcsph", "pcisph", "emitters", "streams", "drains")


def summary(out: Path, **fluid) -> dict:
    """Of two frames, simulated in a process of their own."""
    spec = {"fps": 100, "fluid": FLUID | fluid, "containers": {"tank": {"type": "box", "size": [0.5, 0.5, 0.5]}}}
    command = [sys.executable, "-m", "sim.segment", "--folder", out, "--frames", "0:1", "--out", out, "--arch", "cpu"]
    done = subprocess.run([*command, "--spec", json.dumps(spec)], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads((out / "summary.json").read_text())


def modules(told: dict) -> set[str]:
    return {name.split(".")[2] for name in told["kernels"] if name.startswith("sim.fluid.")}


def test_a_scene_without_features_compiles_none_of_their_kernels(tmp_path):
    told = summary(tmp_path)
    assert {"momentum", "projection", "system"} <= modules(told)
    assert not modules(told) & set(ABSENT)
    assert told["chosen"] == {"fluid.viscosity_solver": "explicit"}


@pytest.mark.parametrize("feature", FEATURES)
def test_a_scene_with_a_feature_compiles_its_kernels(tmp_path, feature):
    told = summary(tmp_path, **FEATURES[feature])
    assert modules(told) & set(FEATURES) == {feature}
    assert told["chosen"]["fluid.viscosity_solver"] == ("implicit" if feature == "viscosity" else "explicit")
