"""A scene without bodies that obey forces imports none of their modules and launches none of their kernels."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.in_time import in_time

ROOT = Path(__file__).resolve().parents[4]
ALWAYS = {"__init__", "spec"}
"""What settings are read with."""


def modules_below(chapter: str) -> set[str]:
    """Names of the modules of a chapter of `sim`, but for what settings are read with."""
    files = [path for path in (ROOT / "sim" / chapter).rglob("*.py") if path.stem not in ALWAYS]
    return {".".join(path.relative_to(ROOT).with_suffix("").parts) for path in files}


DYNAMICS = modules_below("rigid") | modules_below("coupling/fluid_rigid")
SCENE = {
    "fps": 100,
    "containers": {"tank": {"type": "box", "size": [0.5, 0.5, 0.5]}},
    "fluid": {
        "solver": "dfsph",
        "particle_radius": 0.02,
        "bodies": {"b": {"shape": {"type": "sphere", "radius": 0.1}}},
    },
}
BALL = {"shape": {"type": "sphere", "radius": 0.05}, "position": [0.17, 0.1, 0]}
MOTIONS = {
    "none": {},
    "static": {"rigid": {"bodies": {"ball": BALL}}},
    "prescribed": {"rigid": {"bodies": {"ball": BALL | {"motion": "prescribed", "velocity": [0, 0.1, 0]}}}},
    "dynamic": {"rigid": {"bodies": {"ball": BALL | {"motion": "dynamic"}}}},
}
CODE = (
    "import json, sys; from sim.segment import main; main(sys.argv[1:]);"
    "print(json.dumps(sorted(name for name in sys.modules if name.startswith('sim.'))))"
)


@pytest.mark.parametrize("motion", ["prescribed", "dynamic", *in_time("none", "static")])
def test_what_a_scene_loads_and_launches(tmp_path, motion):
    spec = json.dumps(SCENE | MOTIONS[motion])
    options = ["--spec", spec, "--folder", tmp_path, "--frames", "0:1", "--out", tmp_path, "--arch", "cpu"]
    done = subprocess.run([sys.executable, "-c", CODE, *options], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    loaded = DYNAMICS & set(json.loads(done.stdout.splitlines()[-1]))
    kernels = json.loads((tmp_path / "summary.json").read_text())["kernels"]
    launched = {name for name in kernels if name.rpartition(".")[0] in DYNAMICS}
    assert "sim.fluid.pressure.projection" in {name.rpartition(".")[0] for name in kernels}
    if motion == "dynamic":
        assert loaded >= {"sim.rigid.model", "sim.coupling.fluid_rigid.floating"}
        assert any(name.startswith("sim.rigid.") for name in launched)
    else:
        assert not loaded
        assert not launched
