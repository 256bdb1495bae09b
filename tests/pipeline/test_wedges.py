"""`snakemake wedges/NAME`: a film of every combination, one sheet and one table."""

from __future__ import annotations

import csv

import pytest

from tests.support import falling_ball

SCENE = falling_ball.scene(
    0.25,
    """\
wedge:
  rigid.bodies.ball.position: [[0, 1, 0], [0, 2, 0]]
render:
  resolution: [65, 49]
  samples: 1
""",
)
TARGET = "wedges/ball"


@pytest.mark.slow
def test_a_wedge_from_start_to_end(fresh):
    scene = fresh.folder / "scenes" / "ball.yaml"
    scene.write_text(SCENE)
    fresh.make(TARGET)
    films = sorted(path.name for path in fresh.folder.joinpath("renders").iterdir())
    assert films == ["ball@position=0_1_0", "ball@position=0_2_0"]
    assert fresh.folder.joinpath("renders", films[0], f"{films[0]}.mp4").stat().st_size > 0
    with fresh.folder.joinpath(TARGET, "table.csv").open() as file:
        table = list(csv.DictReader(file))
    assert [row["name"] for row in table] == films
    assert [row["status"] for row in table] == ["done", "done"]
    assert fresh.folder.joinpath(TARGET, "contact.png").stat().st_size > 1000
    assert fresh.dry_run(TARGET).nothing

    fresh.edit("[[0, 1, 0], [0, 2, 0]]", "[[0, 1, 0], [0, 2, 0], [0, 3, 0]]", scene)
    assert sorted(stage for stage, _, _ in fresh.dry_run(TARGET).jobs) == ["film", "render", "simulate", "wedge"]
    # The film of the scene itself has its own values, and knows nothing of the wedge.
    assert fresh.dry_run("renders/ball").stages == {"simulate", "render", "film"}


def test_a_scene_without_a_wedge_is_refused(fresh):
    ran = fresh.snakemake("--dry-run", "wedges/tests/pond")
    assert ran.code == 1
    assert "pond.yaml has no wedge" in ran.text
    assert "Traceback" not in ran.text
