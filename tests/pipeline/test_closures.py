"""The source files that a stage loads when it runs are among those that it is said to depend on."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from pathlib import Path

import pytest

from workflow.plan import record
from workflow.plan.jobs import ENTRY
from workflow.plan.sources import closure
from workflow.plan.specs import FOLDER

RECORDER = """\
import json, pathlib, runpy, sys
entry, target, *arguments = sys.argv[1:]
sys.argv = [entry, *arguments]
try:
    runpy.run_module(entry, run_name="__main__", alter_sys=True)
except SystemExit as end:
    assert not end.code, end.code
files = {getattr(module, "__file__", None) for module in list(sys.modules.values())}
pathlib.Path(target).write_text(json.dumps(sorted(filter(None, files))))
"""


FOAM = json.dumps({"particle_radius": 0.05, "support_radius": 0.2, "fps": 4})
WET = json.dumps({"drying_time": 10, "particle_radius": 0.05, "fps": 4})
"""The scene of these tests does neither foam nor show what is wet."""


@pytest.fixture
def loaded(project, tmp_path):
    def run(entry: str, *arguments: str) -> set[Path]:
        target = tmp_path / "modules.json"
        command = [sys.executable, "-c", RECORDER, entry, str(target), *arguments]
        done = subprocess.run(command, cwd=project.folder, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        files = {Path(file).resolve() for file in json.loads(target.read_text())}
        return {file for file in files if file.is_relative_to(project.folder.resolve())}

    return run


def recorded_spec(project, result: Path) -> str:
    """The settings in JSON that a result was made with."""
    values = record.params(result.relative_to(project.folder).as_posix(), project.folder)
    file = next(ast.literal_eval(value) for value in values if value.startswith(f"'{FOLDER}/"))
    return (project.folder / file).read_text()


def arguments_of(project, stage: str) -> list[str]:
    simulation, surface = project.results / "simulation" / "000", project.results / "surface" / "000"
    frames = project.results / "frames" / "000"
    made = {"simulate": simulation, "reconstruct": surface, "render": frames, "film": project.film}
    spec = recorded_spec(project, made[stage]) if stage in made else {"foam": FOAM, "wet": WET}[stage]
    spec = ["--spec", spec, "--out", str(project.folder / "again")]
    return (
        spec
        + {
            "simulate": ["--folder", str(project.scene.parent), "--frames", "0:1"],
            "reconstruct": ["--simulation", str(simulation), "--frames", "0:1"],
            "foam": ["--simulation", str(simulation), "--frames", "0:1"],
            "wet": ["--simulation", str(simulation), "--frames", "0:1"],
            "render": ["--simulation", str(simulation), "--surface", str(surface), "--frames", "0:0", "--fps", "4"],
            "film": ["--frames-from", str(frames), str(frames.with_name("001")), "--simulation", str(simulation)],
        }[stage]
    )


@pytest.mark.parametrize("stage", list(ENTRY))
def test_closure_covers_what_is_loaded(project, loaded, stage):
    materials = frozenset({"fluid"} if stage == "foam" else {"fluid", "rigid"})
    expected = set(closure(ENTRY[stage], project.folder.resolve(), materials))
    found = loaded(ENTRY[stage], *arguments_of(project, stage))
    assert found, "nothing of the project was loaded"
    unused = {file for file in found if "cloth" in file.parts}
    assert found - unused <= expected
