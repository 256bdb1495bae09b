"""Which scenes an edit of a coupling repeats: those that load it, and no others."""

from __future__ import annotations

import itertools
import json
import subprocess
import sys
from pathlib import Path

import pytest

from sim.spec import SimulationSpec
from tests.support.in_time import in_time
from workflow.plan.sources import MATERIALS, closure

ROOT = Path(__file__).resolve().parents[4]
COUPLING = ROOT / "sim" / "coupling"
NEEDED = {
    "cloth_solids.py": {"cloth"},
    "fluid_cloth": {"fluid", "cloth"},
    "fluid_rigid": {"fluid", "rigid"},
    "fluid_rigid/force_on_solid.py": {"fluid"},
    "fluid_rigid/reaction.py": {"fluid"},
    "fluid_rigid/reaction_sums.py": {"fluid"},
    "fluid_solids.py": {"fluid"},
    "outlets.py": {"fluid"},
    "pressure_at.py": {"fluid"},
    "resolution.py": {"fluid"},
    "room.py": {"fluid"},
    "together.py": {"fluid", "rigid", "cloth"},
}
"""Materials without which a coupling is not loaded."""
TANK = {"tank": {"type": "box", "size": [0.4, 0.5, 0.4]}}
BLOCK = {"shape": {"type": "box", "size": [0.3, 0.15, 0.3]}, "position": [0, 0.08, 0]}
TAP = {"shape": {"type": "disc", "radius": 0.05}, "position": [0, 0.4, 0], "speed": 1, "rotation": []}
FLUID = {"solver": "dfsph", "particle_radius": 0.02, "bodies": {"block": BLOCK}}
BALL = {"shape": {"type": "sphere", "radius": 0.05}, "position": [0, 0.3, 0]}
LOOSE = BALL | {"motion": "dynamic", "density": 500}
SHEET = {"shape": {"type": "sheet", "size": [0.2, 0.2]}, "spacing": 0.05, "position": [0.05, 0.2, 0]}
PROBES = {"push": {"type": "force", "body": "tank"}, "deep": {"type": "pressure", "at": [0, 0.02, 0]}}
SCENES = {
    "fluid": {"containers": TANK, "fluid": FLUID | {"emitters": {"tap": TAP}}},
    "fluid by a body": {"containers": TANK, "fluid": FLUID, "rigid": {"bodies": {"ball": BALL}}},
    "fluid and bodies": {"containers": TANK, "fluid": FLUID, "rigid": {"bodies": {"ball": LOOSE}}},
    "fluid and cloth": {"containers": TANK, "fluid": FLUID, "cloth": {"sheets": {"sheet": SHEET}}},
    "bodies": {"rigid": {"bodies": {"ball": LOOSE}}},
    "cloth": {"cloth": {"sheets": {"sheet": SHEET}}, "containers": TANK},
    "cloth and bodies": {"cloth": {"sheets": {"sheet": SHEET}}, "rigid": {"bodies": {"ball": LOOSE}}},
    "everything": {
        "containers": TANK,
        "fluid": FLUID,
        "cloth": {"sheets": {"sheet": SHEET}},
        "rigid": {"bodies": {"ball": LOOSE}},
    },
}
QUICK = ("fluid",)
CODE = (
    "import json, sys; from sim.segment import main; code = main(sys.argv[1:]);"
    "print(json.dumps([module.__file__ for module in sys.modules.values() if getattr(module, '__file__', None)]));"
    "sys.exit(code)"
)


def needed(file: Path) -> set[str]:
    """Of the closest entry of NEEDED; nothing where there is none."""
    name = file.relative_to(COUPLING)
    return next((NEEDED[str(entry)] for entry in (name, name.parent) if str(entry) in NEEDED), set())


@pytest.mark.parametrize("size", [1, 2, 3])
def test_a_coupling_counts_for_scenes_with_its_materials(size):
    files = [file for file in COUPLING.rglob("*.py") if file.name != "__init__.py"]
    assert all(needed(file) for file in files)
    for materials in map(set, itertools.combinations(sorted(MATERIALS), size)):
        found = set(closure("sim.segment", ROOT, frozenset(materials)))
        assert found.intersection(files) == {file for file in files if needed(file) <= materials}


@pytest.mark.parametrize("name", ["fluid", *in_time(*[name for name in SCENES if name not in QUICK])])
def test_what_a_scene_loads_is_among_what_it_depends_on(tmp_path, name):
    scene = {"fps": 100, **SCENES[name]} | ({"probes": PROBES} if "fluid" in SCENES[name] else {})
    options = ["--spec", json.dumps(scene), "--folder", tmp_path, "--frames", "0:1", "--out", tmp_path / "out"]
    done = subprocess.run(
        [sys.executable, "-c", CODE, *options, "--arch", "cpu"], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    loaded = {Path(file) for file in json.loads(done.stdout.splitlines()[-1])}
    ours = {file for file in loaded if file.is_relative_to(ROOT) and ".venv" not in file.parts}
    counted = set(closure("sim.segment", ROOT, SimulationSpec.model_validate(scene).materials()))
    settings = {file for file in ours if file.name in ("spec.py", "__init__.py") or file.parent == ROOT / "scene"}
    assert ours - counted <= settings, "settings of other materials are read, and count for nothing"
    assert name == "bodies" or any(file.is_relative_to(COUPLING) for file in ours)
