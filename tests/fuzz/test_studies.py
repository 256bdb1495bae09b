"""Study files, and the wedges of scenes."""

from __future__ import annotations

import json

from hypothesis import given
from hypothesis import strategies as st

from scene.document import SceneError
from scene.load import combination_of, load
from scene.settings import Refused
from tests.fuzz.mutations import VALUES, broken, fuzzed
from workflow.study.formula import FUNCTIONS, evaluate
from workflow.study.load import load_study

SCENE = {
    "duration": 1,
    "fps": 4,
    "rigid": {"bodies": {"ball": {"shape": {"type": "sphere", "radius": 0.1}, "motion": "dynamic"}}},
}
STUDY = {
    "description": "How exact is free fall?",
    "scene": "fall.yaml",
    "grids": [{"rigid.max_step": ["20 ms", "10 ms"], "rigid.max_iterations": [1, 5]}],
    "quantity": {"name": "height", "table": "bodies", "of": "ball", "column": "y", "take": "curve", "until": 1},
    "reference": {"type": "formula", "value": "1 - g * t**2 / 2", "where": {"g": 9.81}, "source": "Galilei 1638"},
    "scale": 1,
}


def written(data: object) -> str:
    return json.dumps(data).replace("NaN", ".nan").replace("Infinity", ".inf")


def test_studies(tmp_path, survived):
    tmp_path.joinpath("fall.yaml").write_text(written(SCENE))
    path = tmp_path / "study.yaml"

    @fuzzed(80)
    @given(broken(STUDY))
    def check(changed):
        path.write_text(written(changed))
        with survived(SceneError):
            assert load_study(path, "study").trials

    check()


def test_wedges(tmp_path, survived):
    path = tmp_path / "fall.yaml"
    paths = st.sampled_from(["gravity", "fps", "rigid.bodies.ball.density", "rigid.max_step", "render", "a.b", ""])

    @fuzzed(80)
    @given(st.dictionaries(paths | st.text(max_size=8), st.lists(VALUES, max_size=3), max_size=3))
    def check(wedge):
        path.write_text(written({**SCENE, "wedge": wedge}))
        with survived(SceneError):
            scene = load(path, root=tmp_path)
            for combination in scene.wedge:
                assert combination_of(scene, combination.name).name == f"fall@{combination.name}"

    check()


@fuzzed(500)
@given(
    st.lists(
        st.sampled_from([*FUNCTIONS, *"xyt+-*/()[]{}.,'=<:", "**", "//", "9", "1e308", "lambda", "__class__", " if "]),
        max_size=12,
    ).map("".join)
    | st.text(max_size=20)
)
def test_formulas(survived, text):
    with survived(Refused):
        assert abs(evaluate(text, {"x": 1.5, "y": -2.0, "t": 0.0})) < float("inf")
