"""States from which a run would go on."""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scene.settings import Refused
from sim.run.checkpoint import Checkpoint, frame_of
from sim.segment import simulate
from sim.spec import SimulationSpec
from tests.fuzz.mutations import broken, broken_bytes, fuzzed

SPEC = SimulationSpec.model_validate(
    {
        "fps": 100,
        "containers": {"tank": {"type": "box", "size": [0.4, 0.4, 0.4]}},
        "fluid": {
            "solver": "dfsph",
            "particle_radius": 0.02,
            "bodies": {"water": {"shape": {"type": "box", "size": [0.2, 0.2, 0.2]}, "position": [0, 0.15, 0]}},
        },
        "rigid": {
            "bodies": {
                "ball": {"shape": {"type": "sphere", "radius": 0.05}, "motion": "dynamic", "position": [0, 0.35, 0]}
            }
        },
        "cloth": {
            "sheets": {"rag": {"shape": {"type": "sheet", "size": [0.1, 0.1]}, "spacing": 0.05, "position": [0, 1, 0]}}
        },
        "probes": {"volume": {"type": "volume"}},
    }
)


@pytest.fixture(scope="module")
def state(tmp_path_factory) -> Path:
    """A state of a run with all materials."""
    out = tmp_path_factory.mktemp("run")
    assert simulate(SPEC, Path(), out, first=0, last=1, arch="cpu", threads=1, quiet=True) == 0
    return out / "state_00001.npz"


@dataclass
class Survives:
    path: Path
    survived: Callable[..., AbstractContextManager[None]]

    def __call__(self, content: bytes | None = None) -> None:
        if content is not None:
            self.path.write_bytes(content)
        with self.survived(Refused):
            frame_of(self.path)
            found = Checkpoint.load(self.path, SPEC)
            assert found.clock.frame >= 0
            assert np.isfinite([found.clock.time, found.clock.last_step, found.clock.step_scale]).all()
            assert np.isfinite(found.origin).all()
            assert all(np.isfinite(values).all() for values in found._arrays().values())


@pytest.fixture
def survives(tmp_path, survived):
    """Loads a state; anything but Refused fails the test, and so do numbers that are not finite."""
    return Survives(tmp_path / "state_00001.npz", survived)


def test_bytes(state, survives):
    @fuzzed(30)
    @given(broken_bytes(state.read_bytes()))
    def check(changed):
        survives(changed)

    check()


def test_heads(state, survives):
    with np.load(state) as stored:
        contents = {name: stored[name] for name in stored.files}
    head = json.loads(str(contents["meta"]))

    @fuzzed(80)
    @given(broken(head))
    def check(changed):
        np.savez(survives.path, **{**contents, "meta": np.array(json.dumps(changed))})
        survives()

    check()


SHAPES = st.sampled_from([(), (0,), (1,), (3,), (4, 3), (0, 3), (125, 3), (125, 4), (2, 2, 2)])
KINDS = st.sampled_from(["f4", "f8", "i4", "i8", "u1", "U3", "?"])


def test_arrays(state, survives):
    with np.load(state) as stored:
        contents = {name: stored[name] for name in stored.files}

    @fuzzed(80)
    @given(st.sampled_from(sorted(contents)), SHAPES, KINDS, st.sampled_from([0, 1, np.nan, np.inf, -1e30]))
    def check(name, shape, kind, value):
        with np.errstate(all="ignore"):
            values = np.full(shape, value).astype(kind)
        np.savez(survives.path, **{**contents, name: values})
        survives()

    check()


@pytest.mark.parametrize("name", ["meta", "origin", "fluid.position", "cloth.position"])
def test_what_is_missing(state, survives, name):
    with np.load(state) as stored:
        contents = {key: stored[key] for key in stored.files if key != name}
    np.savez(survives.path, **contents)
    with pytest.raises(Refused):
        Checkpoint.load(survives.path, SPEC)
