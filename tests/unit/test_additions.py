"""Solvers, forces, shapes and looks that an installed package adds: nothing of the tree is touched for them."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.particles import read_frame, velocities

ROOT = Path(__file__).resolve().parents[2]
ENTRY_POINTS = """\
[tidemill.forces]
wind = outside.settings:Wind
[tidemill.solvers]
mine = outside.settings:Mine
[tidemill.shapes]
cone = outside.settings:Cone
[tidemill.looks]
neon = outside.settings:Neon
"""
SETTINGS = '''\
from typing import ClassVar, Literal
from scene.settings import Settings
from scene.units import PositiveLength

class Wind(Settings):
    IMPLEMENTATION: ClassVar[str] = "outside.force:Wind"
    acceleration: tuple[float, float, float]

class Mine(Settings):
    IMPLEMENTATION: ClassVar[str] = "outside.solver:Mine"
    density_error: float = 1e-3
    min_iterations: int = 2
    max_iterations: int = 100

class Cone(Settings):
    """A cone on its base, its axis along y."""
    IMPLEMENTATION: ClassVar[str] = "outside.shape:triangles"
    type: Literal["cone"]
    radius: PositiveLength
    height: PositiveLength

class Neon(Settings):
    IMPLEMENTATION: ClassVar[str] = "outside.look:build"
    type: Literal["neon"]
    strength: float = 1.0
'''
FORCE = """\
import taichi as ti
from sim.device.arrays import Vec4Array, vec3
from sim.fluid.forces.force import Force

class Wind(Force):
    def accelerate(self):
        system = self.system
        blow(system.count, vec3(*system.spec.extra["wind"].acceleration), system.particles.acceleration)

@ti.kernel
def blow(count: ti.i32, more: vec3, acceleration: Vec4Array):
    for i in range(count):
        acceleration[i].xyz += more
"""
SOLVER = "from sim.fluid.pressure.iisph import Iisph\n\nclass Mine(Iisph):\n    pass\n"
SHAPE = """\
import trimesh

def triangles(shape):
    cone = trimesh.creation.cone(shape.radius, shape.height, sections=64)
    cone.apply_transform([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    return cone
"""
LOOK = """\
def build(graph, look, size):
    return graph.node("Emission", {"Color": (1.0, 0.0, 1.0, 1.0), "Strength": look.strength}).outputs[0], None
"""
FILES = {"__init__": "", "settings": SETTINGS, "force": FORCE, "solver": SOLVER, "shape": SHAPE, "look": LOOK}
DROP = {
    "bodies": {"drop": {"shape": {"type": "sphere", "radius": 0.06}, "position": [0, 1, 0]}},
    "particle_radius": 0.02,
}


class Package:
    """As pip would have installed it, in a folder of its own."""

    def __init__(self, folder: Path):
        self.folder = folder
        for name, text in FILES.items():
            self.write(f"outside/{name}.py", text)
        self.write("outside-1.0.dist-info/METADATA", "Metadata-Version: 2.1\nName: outside\nVersion: 1.0\n")
        self.write("outside-1.0.dist-info/entry_points.txt", ENTRY_POINTS)

    def write(self, name: str, text: str) -> None:
        (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
        (self.folder / name).write_text(text)

    def python(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        path = os.pathsep.join([str(ROOT), str(self.folder)])
        environment = {**os.environ, "PYTHONPATH": path, "PYTHONDONTWRITEBYTECODE": "1"}
        command = [sys.executable, *map(str, arguments)]
        return subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)

    def simulate(self, out: Path, frames: int, **scene) -> Path:
        options = ["--folder", out.parent, "--frames", f"0:{frames}", "--out", out, "--arch", "cpu", "--threads", "1"]
        done = self.python("-m", "sim.segment", "--spec", json.dumps(scene), *options)
        assert done.returncode == 0, done.stderr
        return out


@pytest.fixture
def package(tmp_path) -> Package:
    return Package(tmp_path / "site")


def test_a_force_acts_where_its_settings_are_given(package, tmp_path):
    """dv = (g + a) t for a drop that falls freely."""
    fluid = DROP | {"solver": "dfsph", "extra": {"wind": {"acceleration": [3, 0, -1]}}}
    out = package.simulate(tmp_path / "out", 5, fps=50, fluid=fluid)
    found = velocities(read_frame(out, 5)).mean(axis=0)
    assert found == pytest.approx(np.array([3, -9.81, -1]) * 0.1, abs=1e-5)
    plain = package.simulate(tmp_path / "plain", 1, fps=50, fluid=DROP | {"solver": "dfsph"})
    kernels = [json.loads((folder / "summary.json").read_text())["kernels"] for folder in (out, plain)]
    assert ["outside.force.blow" in names for names in kernels] == [True, False]


def test_a_solver_steps(package, tmp_path):
    """One that inherits all that it does gives the same bytes."""
    tank = {"tank": {"type": "box", "size": [0.3, 0.5, 0.3]}}
    scene = {"fps": 50, "containers": tank, "step": {"cfl": 0.4}}
    block = DROP | {"bodies": {"block": {"shape": {"type": "box", "size": [0.2, 0.2, 0.2]}, "position": [0, 0.2, 0]}}}
    frames = [
        (package.simulate(tmp_path / name, 3, **scene, fluid=block | {"solver": name}) / "fluid_00003.ply").read_bytes()
        for name in ("iisph", "mine")
    ]
    assert frames[0] == frames[1]


def test_what_is_said_of_a_solver_names_its_own_settings(package, tmp_path):
    """Of steps that end at its cap, and of settings of one that is not chosen."""
    tank = {"tank": {"type": "box", "size": [0.2, 0.5, 0.2]}}
    block = {"block": {"shape": {"type": "box", "size": [0.2, 0.2, 0.2]}, "position": [0, 0.1, 0]}}
    fluid = DROP | {"bodies": block, "solver": "mine", "extra": {"mine": {"max_iterations": 1}}}
    out = package.simulate(tmp_path / "out", 2, fps=50, containers=tank, fluid=fluid)
    (text,) = json.loads((out / "summary.json").read_text())["warnings"]
    assert "fluid.extra.mine.max_iterations (1)" in text and "fluid.extra.mine.density_error" in text
    scene = tmp_path / "scene.yaml"
    scene.write_text(json.dumps({"duration": 1, "fps": 50, "containers": tank, "fluid": fluid | {"solver": "iisph"}}))
    done = package.python("-m", "sim", "check", scene)
    assert done.returncode == 0, done.stderr
    assert "extra.mine" in done.stdout + done.stderr
    assert "it is for solver: mine, and the scene has solver: iisph" in done.stdout + done.stderr


def test_a_shape_is_a_solid(package, tmp_path):
    """m = rho pi r^2 h / 3, within the share (2 pi / 64)^2 / 6 of the circle that 64 sides leave."""
    code = f"""
from pathlib import Path
from sim.spec import SimulationSpec
from sim.geometry.shapes import place
spec = SimulationSpec.model_validate({{"fps": 24, "rigid": {{"bodies": {{"cone":
    {{"shape": {{"type": "cone", "radius": 0.2, "height": 0.3}}, "motion": "dynamic", "density": 500}}}}}}}})
body = spec.rigid.bodies["cone"]
print(place(body.shape, body, Path({str(tmp_path)!r})).mass_properties(500.0).mass)
"""
    done = package.python("-c", code)
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) == pytest.approx(500 * np.pi * 0.2**2 * 0.3 / 3, rel=(2 * np.pi / 64) ** 2 / 6)
    cone = {"shape": {"type": "cone", "radius": 0.2, "height": 0.3}, "motion": "dynamic", "density": 500}
    out = package.simulate(tmp_path / "out", 1, fps=24, rigid={"bodies": {"cone": cone | {"position": [0, 1, 0]}}})
    assert (out / "body_cone.ply").exists()


def test_a_look_is_drawn(package, tmp_path):
    """A ball that shines in magenta, before black."""
    ball = {"shape": {"type": "sphere", "radius": 0.5}, "position": [0, 0.5, 0]}
    simulated = package.simulate(tmp_path / "simulation", 0, fps=24, rigid={"bodies": {"ball": ball}})
    settings = {"resolution": [48, 48], "samples": 4, "view_transform": "Standard", "ground": {"enabled": False}}
    settings |= {"materials": {"ball": {"type": "neon"}}, "background": {"type": "plain", "color": "#000000"}}
    options = ["--simulation", simulated, "--frames", "0:0", "--out", tmp_path / "frames"]
    done = package.python("-m", "render", "--spec", json.dumps(settings), *options)
    assert done.returncode == 0, done.stderr
    with Image.open(tmp_path / "frames" / "00000.png") as picture:
        red, green, blue = np.asarray(picture.convert("RGB"))[24, 24]
    assert red > 240 and blue > 240 and green < 15


@pytest.mark.parametrize(
    ("extra", "message"),
    [
        ({"wnd": {}}, "no force or solver 'wnd': did you mean 'wind'?"),
        ({"wind": {"acceleration": "fast"}}, "wind.acceleration: Input should be a valid tuple"),
    ],
)
def test_what_nobody_adds_or_takes_is_refused(package, tmp_path, extra, message):
    fluid = DROP | {"extra": extra}
    options = ["--folder", tmp_path, "--frames", "0:0", "--out", tmp_path / "out"]
    done = package.python("-m", "sim.segment", "--spec", json.dumps({"fps": 24, "fluid": fluid}), *options)
    assert done.returncode == 2
    assert message in done.stderr


@pytest.mark.parametrize(
    ("file", "stages"), [("force", {"simulate"}), ("look", {"render"}), ("settings", {"simulate", "render"})]
)
def test_an_edit_of_the_package_repeats_the_stages_that_use_it(package, file, stages):
    code = "from workflow.plan.additions import digest; print(digest('simulate'), digest('render'), digest('film'))"
    before = package.python("-c", code).stdout.split()
    package.write(f"outside/{file}.py", FILES[file] + "\n")
    after = package.python("-c", code).stdout.split()
    changed = {stage for stage, one, other in zip(("simulate", "render"), before, after, strict=True) if one != other}
    assert changed == stages
