"""A scene compiles the kernels of what it has, and no others."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.in_time import in_time

ROOT = Path(__file__).resolve().parents[4]
FLUID = {"solver": "dfsph", "particle_radius": 0.02, "bodies": {"b": {"shape": {"type": "sphere", "radius": 0.06}}}}
FEATURES = {
    "surface_tension": {"surface_tension": 0.07, "surface_tension_model": "akinci2013"},
    "adhesion": {"adhesion": 0.05},
    "implicit_viscosity_sums": {"viscosity": 10.0},
    "xsph": {"xsph": 0.1},
}
"""Settings by the module of sim.fluid that they need."""
ITERATIVE = {"incompressible", "projection", "conjugate_gradient_sums"}
BOUNDARY = {path.stem for path in (ROOT / "sim/fluid/boundary").glob("*.py")}
CORRECTED = {"gradient_correction", "hyperviscosity"}
ABSENT = (
    "surface_tension",
    "adhesion",
    "implicit_viscosity_sums",
    "xsph",
    "wcsph",
    "pcisph",
    "emitters",
    "streams",
    "drains",
)


TANK = {"containers": {"tank": {"type": "box", "size": [0.5, 0.5, 0.5]}}}
BALL = {"shape": {"type": "sphere", "radius": 0.05}, "position": [0.16, 0.1, 0]}
SPOUT = {"shape": {"type": "disc", "radius": 0.05}, "position": [0.1, 0.3, 0], "speed": 8}
ADDED = {
    "solid bodies": ({}, {"rigid": {"bodies": {"ball": BALL}}}, {"samples"}),
    "bodies that move": (
        {},
        {"rigid": {"bodies": {"ball": BALL | {"motion": "prescribed", "velocity": [0, 0.1, 0]}}}},
        {"samples"},
    ),
    "bodies that obey forces": (
        {},
        {"rigid": {"bodies": {"ball": BALL | {"motion": "dynamic"}}}},
        {"samples", "reaction_sums", "lubrication_sums"},
    ),
    "emitters": ({"emitters": {"spout": SPOUT}}, {}, {"streams"}),
    "drains": ({"drains": {"all": {"shape": {"type": "box", "size": [1, 1, 1]}}}}, {}, {"drains"}),
    "becker2007": ({"surface_tension": 0.07}, {}, set()),
    "no walls": ({}, {"containers": {}}, set()),
    "no viscosity": ({"viscosity": 0}, {}, set()),
    "wcsph": ({"solver": "wcsph"}, {}, {"wcsph"}),
    "pcisph": ({"solver": "pcisph"}, {}, {"pcisph"}),
    "iisph": ({"solver": "iisph"}, {}, set()),
    "jacobi": ({"dfsph": {"iteration": "jacobi"}}, {}, {"dfsph_jacobi"}),
}
"""Settings of the fluid and of the scene, and the modules whose kernels they add to plain DFSPH."""


def summary(out: Path, scene: dict = TANK, **fluid) -> dict:
    """Of two frames, simulated in a process of their own."""
    spec = {"fps": 100, "fluid": FLUID | fluid} | scene
    command = [sys.executable, "-m", "sim.segment", "--folder", out, "--frames", "0:1", "--out", out]
    options = ["--spec", json.dumps(spec), "--arch", "cpu", "--threads", "1"]
    done = subprocess.run([*command, *options], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads((out / "summary.json").read_text())


def modules(told: dict) -> set[str]:
    names = (name.split(".") for name in told["kernels"] if name.startswith(("sim.fluid.", "sim.coupling.")))
    return {parts[-2] for parts in names}


def test_a_scene_without_features_compiles_none_of_their_kernels(tmp_path):
    told = summary(tmp_path)
    assert {"momentum", "projection", "measure"} <= modules(told)
    assert not modules(told) & set(ABSENT)
    assert told["chosen"] == {"fluid.viscosity_solver": "explicit"}


@pytest.mark.parametrize("feature", [*list(FEATURES)[::2], *in_time(*list(FEATURES)[1::2])])
def test_a_scene_with_a_feature_compiles_its_kernels(tmp_path, feature):
    told = summary(tmp_path, **FEATURES[feature])
    assert modules(told) & set(FEATURES) == {feature}
    assert told["chosen"]["fluid.viscosity_solver"] == (
        "implicit" if feature == "implicit_viscosity_sums" else "explicit"
    )


@pytest.fixture(scope="module")
def plain(tmp_path_factory) -> set[str]:
    return modules(summary(tmp_path_factory.mktemp("plain")))


@pytest.mark.parametrize("name", [*list(ADDED)[::2], *in_time(*list(ADDED)[1::2])])
def test_what_a_scene_has_adds_its_own_kernels_only(tmp_path, plain, name):
    fluid, scene, added = ADDED[name]
    found = modules(summary(tmp_path, TANK | scene, **fluid))
    assert found - plain == added
    lost = plain - found
    assert (
        not lost
        or (name == "no walls" and lost <= BOUNDARY)
        or (name in ("wcsph", "pcisph") and lost <= ITERATIVE | CORRECTED)
        or (name == "iisph" and lost - {"dfsph"} == CORRECTED)
        or (name == "jacobi" and lost - {"dfsph"} == CORRECTED | {"conjugate_gradient_sums"})
    )
