"""A scene without cloth imports none of its modules and launches none of its kernels."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from tests.unit.sim.run.test_rigid_not_loaded import CODE, MOTIONS, ROOT, modules_below

MODULES = modules_below("cloth")
MODULES |= {"sim.coupling.cloth_solids", "sim.neighbors.box_tree"}
SHEET = {"shape": {"type": "sheet", "size": [0.2, 0.2]}, "spacing": 0.1, "position": [0, 1, 0]}
SCENES = {
    "bodies": MOTIONS["dynamic"],
    "cloth alone": {"cloth": {"sheets": {"sheet": SHEET}}},
    "a shell": {"cloth": {"model": "fem", "sheets": {"sheet": SHEET}}},
    "cloth on a ball": {"cloth": {"sheets": {"sheet": SHEET}}} | MOTIONS["static"],
}


@pytest.mark.parametrize("name", SCENES)
def test_what_a_scene_loads_and_launches(tmp_path, name):
    options = ["--spec", json.dumps({"fps": 100} | SCENES[name]), "--folder", tmp_path, "--frames", "0:1"]
    command = [sys.executable, "-c", CODE, *options, "--out", tmp_path, "--arch", "cpu"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    loaded = MODULES & set(json.loads(done.stdout.splitlines()[-1]))
    kernels = json.loads((tmp_path / "summary.json").read_text())["kernels"]
    launched = {kernel for kernel in kernels if kernel.startswith("sim.cloth.")}
    if name == "bodies":
        assert not loaded
        assert not launched
    else:
        assert {"sim.cloth.model", "sim.cloth.integrators.implicit_euler"} <= loaded
        assert not {"sim.cloth.integrators.xpbd", "sim.cloth.integrators.symplectic_euler"} & loaded
        assert ("sim.coupling.cloth_solids" in loaded) == (name == "cloth on a ball")
        of_shells = {module for module in loaded if module.startswith("sim.cloth.shell")}
        assert ("sim.cloth.shell.newton" in of_shells) == (name == "a shell")
        assert bool(of_shells) == (name == "a shell")
        assert "sim.cloth.integrators.newton.step_energy.assess" in launched
