"""Solvers, forces, shapes and looks that an installed package adds: nothing of the tree is touched for them."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from plyfile import PlyData

from tests.support.particles import positions, read_frame, read_table, velocities

ROOT = Path(__file__).resolve().parents[2]
OUTSIDE = ROOT / "tests" / "outside"
DROP = {
    "bodies": {"drop": {"shape": {"type": "sphere", "radius": 0.06}, "position": [0, 1, 0]}},
    "particle_radius": 0.02,
}
TOWEL = {"shape": {"type": "sheet", "size": [0.4, 0.2]}, "spacing": 0.05, "position": [0, 1, 0]}


class Package:
    """As pip would have installed it, in a folder of its own."""

    def __init__(self, folder: Path):
        self.folder = folder
        shutil.copytree(OUTSIDE, folder / "outside", ignore=shutil.ignore_patterns("*.txt", "__pycache__"))
        about = folder / "outside-1.0.dist-info"
        about.mkdir()
        (about / "METADATA").write_text("Metadata-Version: 2.1\nName: outside\nVersion: 1.0\n")
        shutil.copy(OUTSIDE / "entry_points.txt", about)

    def python(self, *arguments: Any, cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
        path = os.pathsep.join([str(ROOT), str(self.folder)])
        environment = {**os.environ, "PYTHONPATH": path}
        command = [sys.executable, *map(str, arguments)]
        return subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True)

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


@pytest.mark.parametrize(
    ("kind", "name"),
    [
        ("solvers", "iisph"),
        ("integrators", "xpbd"),
        ("shapes", "torus"),
        ("probes", "front"),
        ("looks", "glass"),
        ("solvers", "wind"),
    ],
)
def test_a_name_that_is_taken_is_refused(package, kind, name):
    """By what is built in, and by a force where both have settings in one group: neither acts for the other."""
    (points,) = package.folder.glob("*.dist-info/entry_points.txt")
    lines = points.read_text().splitlines()
    lines.insert(lines.index(f"[tidemill.{kind}]") + 1, f"{name} = outside.settings:Mine")
    points.write_text("\n".join(lines))
    done = package.python("-m", "sim", "check", ROOT / "scenes" / "tiny" / "splash.yaml")
    assert done.returncode == 2, done.stderr
    assert f"the package outside adds a {kind[:-1]} named '{name}'" in done.stderr
    assert f"tidemill.{kind}" in done.stderr and "Traceback" not in done.stderr


def test_a_shape_is_a_solid(package, tmp_path):
    """m = rho pi r^2 h / 3, within the share (2 pi / 64)^2 / 6 of the circle that 64 sides leave."""
    code = f"""
from pathlib import Path
from typing import Any
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


@pytest.mark.slow  # 100,000 points of a cone are about as near to one on its axis
def test_bodies_meet_a_shape_by_its_mesh(package, tmp_path):
    cone = {"shape": {"type": "cone", "radius": 0.2, "height": 0.3}, "motion": "dynamic", "density": 500}
    out = package.simulate(tmp_path / "out", 1, fps=24, rigid={"bodies": {"cone": cone | {"position": [0, 1, 0]}}})
    assert (out / "body_cone.ply").exists()


@pytest.fixture
def blender(tmp_path) -> Path:
    """What stands in for an installed one: a Python that knows bpy and NumPy, and nothing else of site-packages."""
    known = tmp_path / "known"
    known.mkdir()
    for name in ("bpy", "numpy", "numpy.libs"):
        place = Path(np.__file__).parents[1] / name
        if place.exists():
            (known / name).symlink_to(place)
    start = tmp_path / "start.py"
    start.write_text(f"""
import runpy, sys
sys.path.append({str(known)!r})
runpy.run_path(sys.argv[sys.argv.index("--python") + 1], run_name="__main__")
""")
    program = tmp_path / "blender"
    program.write_text(f'#!/bin/sh\nexec {sys.executable} -I -S {start} "$@"\n')
    program.chmod(0o755)
    return program


@pytest.mark.parametrize("installed", [False, True])
def test_a_look_is_drawn(package, tmp_path, blender, installed):
    """A ball that shines in magenta, before black."""
    ball = {"shape": {"type": "sphere", "radius": 0.5}, "position": [0, 0.5, 0]}
    simulated = package.simulate(tmp_path / "simulation", 0, fps=24, rigid={"bodies": {"ball": ball}})
    settings = {"resolution": [48, 48], "samples": 4, "view_transform": "Standard", "ground": {"enabled": False}}
    settings |= {"materials": {"ball": {"type": "neon"}}, "background": {"type": "plain", "color": "#000000"}}
    options = ["--blender", blender] if installed else []
    options += ["--simulation", simulated, "--frames", "0:0", "--out", tmp_path / "frames"]
    done = package.python("-m", "render", "--spec", json.dumps(settings), *options)
    assert done.returncode == 0, done.stderr
    with Image.open(tmp_path / "frames" / "00000.png") as picture:
        red, green, blue = np.asarray(picture.convert("RGB"))[24, 24]
    assert red > 240 and blue > 240 and green < 15


def test_a_look_that_needs_what_blender_has_not_is_refused(package, tmp_path, blender):
    look = package.folder / "outside" / "look.py"
    look.write_text(f"import pydantic\n\n{look.read_text()}")
    ball = {"shape": {"type": "sphere", "radius": 0.5}, "position": [0, 0.5, 0]}
    simulated = package.simulate(tmp_path / "simulation", 0, fps=24, rigid={"bodies": {"ball": ball}})
    settings = {"resolution": [16, 16], "samples": 1, "materials": {"ball": {"type": "neon"}}}
    options = ["--simulation", simulated, "--frames", "0:0", "--out", tmp_path / "frames", "--blender", blender]
    done = package.python("-m", "render", "--spec", json.dumps(settings), *options)
    assert done.returncode == 2
    assert "the look `type: neon` cannot be built in this Blender: No module named 'pydantic'" in done.stderr
    assert "without --blender or TIDEMILL_BLENDER" in done.stderr


def test_an_integrator_steps(package, tmp_path):
    """One that inherits all that it does gives the same bytes."""
    frames = []
    for name in ("symplectic_euler", "same"):
        cloth = {"sheets": {"towel": TOWEL | {"pins": ["left"]}}, "integrator": name}
        folder = package.simulate(tmp_path / name, 3, fps=50, cloth=cloth)
        frames.append((folder / "cloth_towel_00003.ply").read_bytes())
    assert frames[0] == frames[1]


def stable_step(sheet: dict[str, Any]) -> float:
    """Of explicit methods [s]."""
    from sim.cloth.fabric.mesh import Elastic
    from sim.cloth.integrators.symplectic_euler import longest_step
    from sim.cloth.model import find_sheets
    from sim.cloth.spec import Cloth

    (item,) = find_sheets(Cloth.model_validate({"sheets": {"towel": sheet}}), Path())
    return longest_step(Elastic([item.sheet], [item.fabric], item.held))


def test_an_integrator_of_its_own_has_settings_of_its_own(package, tmp_path):
    """The middle of a sheet that swings in itself falls by g t^2 / 2. Velocity Verlet keeps the energy but for about
    (w dt)^2 / 4 of what is elastic, where 2 / w is the longest stable step."""
    sheet = TOWEL | {"rest_scale": 1.02, "damping": 0, "bend_damping": 0, "bend_stiffness": 0}
    cloth = {"sheets": {"towel": sheet}, "integrator": "verlet", "extra": {"verlet": {"substeps": 50}}}
    out = package.simulate(tmp_path / "out", 5, fps=50, cloth=cloth)
    vertices = PlyData.read(out / "cloth_towel_00005.ply")["vertex"]
    assert np.mean(vertices["y"]) == pytest.approx(1 - 9.81 * 0.1**2 / 2, abs=1e-6)
    steps = read_table(out / "steps.csv")
    assert set(steps["cloth_substeps"]) == {50}
    parts = [steps[f"cloth_{kind}_energy"] for kind in ("kinetic", "potential", "elastic")]
    assert np.ptp(sum(parts)) < (steps["dt"].max() / 50 / stable_step(sheet)) ** 2 * parts[2].max()


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


def test_steps_that_an_integrator_allows_are_refused_where_they_are_too_short(package, tmp_path):
    cloth = {"sheets": {"towel": TOWEL}, "integrator": "verlet", "extra": {"verlet": {"longest": 1e-9}}}
    options = ["--folder", tmp_path, "--frames", "0:0", "--out", tmp_path / "out"]
    done = package.python("-m", "sim.segment", "--spec", json.dumps({"fps": 24, "cloth": cloth}), *options)
    assert done.returncode == 2
    assert "the patience of this integrator allows steps of 1e-09 s only" in done.stderr
    assert "raise cloth.extra.verlet.longest" in done.stderr


def probed(folder: Path, probe: str) -> np.ndarray:
    """Rows of one probe, as a record array."""
    rows = read_table(folder / "probes.csv")
    return rows[rows["probe"] == probe]


def test_a_probe_of_the_fluid_measures(package, tmp_path):
    """L = m x cross v about a place of its own: of what falls freely from rest x beside it, -m x g t about z; rows have
    its own rate, name and unit."""
    from sim.fluid.kernel import particle_mass

    probes = {"spin": {"type": "angular_momentum", "about": [-0.5, 0, 0], "rate": 100}}
    out = package.simulate(tmp_path / "out", 2, fps=50, fluid=DROP | {"solver": "dfsph"}, probes=probes)
    rows = probed(out, "spin")
    assert [str(unit) for unit in rows["unit"]] == ["kg m^2/s"] * 15
    turning = rows[rows["quantity"] == "angular_momentum_z"]
    mass = particle_mass(0.04, 0.08, 1000) * len(read_frame(out, 2))
    beside = positions(read_frame(out, 0))[:, 0].mean() + 0.5
    assert turning["value"] == pytest.approx(-mass * beside * 9.81 * turning["time"], abs=1e-5 * mass)


def test_a_probe_of_cloth_measures(package, tmp_path):
    """y - g t^2 / 2 of a sheet that falls flat."""
    scene = {"cloth": {"sheets": {"towel": TOWEL}}, "probes": {"top": {"type": "highest", "sheet": "towel"}}}
    rows = probed(package.simulate(tmp_path / "out", 3, fps=50, **scene), "top")
    assert len(rows) == 4
    assert rows["value"] == pytest.approx(1 - 9.81 * rows["time"] ** 2 / 2, abs=1e-8)


@pytest.fixture
def drop(package, tmp_path) -> Path:
    """A folder with a scene and what a run of it has left."""
    (tmp_path / "scenes").mkdir()
    scene = {"duration": 0.04, "fps": 50, "fluid": DROP | {"solver": "dfsph"}}
    (tmp_path / "scenes" / "drop.yaml").write_text(json.dumps(scene))
    done = package.python("-m", "sim", "run", "scenes/drop.yaml", "--out", "out", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    return tmp_path


def exported(package: Package, folder: Path, out: str, *options: str) -> subprocess.CompletedProcess[str]:
    return package.python("-m", "workflow.export", "drop", "--simulation", "out", "--out", out, *options, cwd=folder)


def test_a_format_is_written_and_read_back(package, drop):
    """All that its columns ask for of the frames asked for, as the files of particles have it."""
    done = exported(package, drop, "drop.csv", "--frames", "1:2", "--spec", '{"columns": ["y", "id"]}')
    assert done.returncode == 0, done.stderr
    table = read_table(drop / "drop.csv")
    assert table.dtype.names == ("frame", "y", "id")
    for frame in (1, 2):
        points, rows = read_frame(drop / "out", frame), table[table["frame"] == frame]
        assert np.array_equal(rows["id"], points["id"])
        assert np.array_equal(rows["y"].astype(np.float32), points["y"])
    refused = {
        "drop.cvs": "no format 'cvs'. did you mean 'csv'?",
        "drop.usdc": "the surface of the water is missing. make the film first",
    }
    for out, message in refused.items():
        done = exported(package, drop, out)
        assert (done.returncode, (drop / out).exists()) == (2, False)
        assert message in done.stderr
    done = exported(package, drop, "other.csv", "--spec", '{"columns": ["mass"]}')
    assert (done.returncode, (drop / "other.csv").exists()) == (2, False)
    assert "columns.0: Input should be 'x', 'y'" in done.stderr


def cloth(**settings: Any) -> dict[str, Any]:
    return {"cloth": {"sheets": {"towel": TOWEL}} | settings}


@pytest.mark.parametrize(
    ("scene", "field", "fix"),
    [
        ({"fluid": DROP | {"extra": {"wnd": {}}}}, "fluid.extra: no force or solver 'wnd'", "did you mean 'wind'?"),
        (cloth(extra={"vrlet": {}}), "cloth.extra: no integrator 'vrlet'", "did you mean 'verlet'?"),
        (cloth(extra={"verlet": {"longest": -1}}), "cloth.extra: verlet.longest", "should be greater than 0"),
        (cloth(integrator="vrlet"), "cloth.integrator", "did you mean 'verlet'?"),
        ({"fluid": DROP} | cloth(integrator="verlet"), "cloth.integrator", "use cloth.integrator: implicit_euler"),
        ({"fluid": DROP, "probes": {"spin": {"type": "angular"}}}, "unknown type 'angular'", "'angular_momentum'"),
        (
            {"fluid": DROP, "probes": {"spin": {"type": "angular_momentum", "about": 3}}},
            "probes.spin.about",
            "write a list",
        ),
        (cloth() | {"probes": {"top": {"type": "highest", "sheet": "flag"}}}, "'flag' is no sheet of cloth", "towel"),
        (
            cloth() | {"probes": {"spin": {"type": "angular_momentum"}}},
            "measures fluid, and the scene has none",
            "remove it",
        ),
        (
            {"cloth": {"sheets": {"towel": TOWEL | {"stretch_stiffness": 1e12}}, "integrator": "same"}},
            "cloth.integrator: the stiffness of the cloth allows explicit steps of",
            "use implicit_euler",
        ),
    ],
)
def test_check_names_field_and_fix(package, tmp_path, scene, field, fix):
    (tmp_path / "scene.yaml").write_text(json.dumps({"duration": 1} | scene))
    done = package.python("-m", "sim", "check", tmp_path / "scene.yaml")
    assert done.returncode == 2
    assert field in done.stderr and fix in done.stderr.partition("fix: ")[2]


@pytest.mark.parametrize(
    ("file", "jobs"),
    [
        ("force", {"fluid"}),
        ("solver", {"fluid"}),
        ("integrator", {"cloth"}),
        ("probe", {"fluid", "cloth", "rigid"}),
        ("shape", {"fluid", "cloth", "rigid"}),
        ("cone", {"fluid", "cloth", "rigid"}),
        ("look", {"render"}),
        ("format", set()),
        ("settings", {"fluid", "cloth", "rigid", "render"}),
    ],
)
def test_an_edit_of_the_package_repeats_the_jobs_that_use_it(package, file, jobs):
    before = digests(package)
    assert set(before) == {"fluid", "cloth", "rigid", "render", "reconstruct", "film"}
    with (package.folder / "outside" / f"{file}.py").open("a") as edited:
        edited.write("\n")
    after = digests(package)
    assert {job for job in before if before[job] != after[job]} == jobs


def digests(package: Package) -> dict[str, str]:
    """Of simulations by their material, and of the other stages."""
    code = """
import json
from workflow.plan.additions import digest
found = {material: digest("simulate", frozenset({material})) for material in ("fluid", "cloth", "rigid")}
print(json.dumps(found | {stage: digest(stage, frozenset()) for stage in ("render", "reconstruct", "film")}))
"""
    return json.loads(package.python("-c", code).stdout)
