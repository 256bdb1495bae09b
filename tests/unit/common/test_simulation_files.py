"""The table of bodies that a simulation leaves."""

from __future__ import annotations

import pytest

from common.simulation_files import BadTable, BodyTable, frames_of_files, read_sources
from sim.run.output import BODY_COLUMNS

HEAD = ",".join(BODY_COLUMNS)


def row(frame: int, body: str, x: float) -> str:
    return f'{frame},{frame / 24},"{body}",{x},0,0,1,0,0,0,1,2,3,4,5,6'


def table(folder, *rows: str) -> BodyTable:
    (folder / "bodies.csv").write_text("\n".join((HEAD, *rows)) + "\n", encoding="utf-8")
    return BodyTable(folder)


def test_bodies_by_frame_and_name(tmp_path):
    read = table(tmp_path, row(0, "a", 1), row(0, "b, c", 2), row(1, "a", 3))
    assert read.times() == {0: 0.0, 1: 1 / 24}
    assert {name: body.position for name, body in read.bodies(0).items()} == {"a": (1, 0, 0), "b, c": (2, 0, 0)}
    assert read.bodies(1)["a"] == ((3, 0, 0), (1, 0, 0, 0), (1, 2, 3), (4, 5, 6))
    assert read.bodies(2) == {}


def test_rows_that_a_run_adds_are_found_when_asked_for(tmp_path):
    read = table(tmp_path, row(0, "a", 1))
    assert set(read.times()) == {0}
    with (tmp_path / "bodies.csv").open("a", encoding="utf-8") as file:
        file.write(row(1, "a", 5) + "\n")
    assert read.bodies(1)["a"].position == (5, 0, 0)
    assert set(read.times()) == {0, 1}


def test_only_frames_that_are_wanted_are_kept(tmp_path):
    table(tmp_path, row(0, "a", 1), row(1, "a", 2), row(2, "a", 3))
    read = BodyTable(tmp_path, [1])
    assert set(read.times()) == {1}
    assert read.bodies(2) == {}


@pytest.mark.parametrize(
    "text", ["", "x,y\n1,2\n", f"{HEAD}\n1,0,a,1\n", f"{HEAD}\none,0,a,0,0,0,1,0,0,0,1,2,3,4,5,6\n"]
)
def test_what_is_no_table_is_refused_with_its_name(tmp_path, text):
    (tmp_path / "bodies.csv").write_text(text, encoding="utf-8")
    with pytest.raises(BadTable, match=r"bodies\.csv is not a table of rigid bodies"):
        BodyTable(tmp_path).times()


def test_frames_of_files(tmp_path):
    for name in ("fluid_00000.ply", "fluid_00001.ply", "cloth_a_b_00001.ply", "cloth_a_b_00007.ply", "body_a.ply"):
        (tmp_path / name).touch()
    assert frames_of_files(tmp_path) == {0, 1, 7}


def test_sources_of_particles_by_their_identities(tmp_path):
    """Those of a source that stops and goes on have one name; particles may be missing."""
    (tmp_path / "sources.csv").write_text("id,time,source\n0,0,pool\n64,0.5,a tap\n80,0.75,pool\n")
    found = read_sources(tmp_path)
    assert found.names == ("pool", "a tap")
    rows = found.rows([0, 63, 64, 79, 80, 1000])
    assert [found.index[row] for row in rows] == [0, 0, 1, 1, 0, 0]
    assert [found.time[row] for row in rows] == [0, 0, 0.5, 0.5, 0.75, 0.75]


def test_nothing_came_yet(tmp_path):
    (tmp_path / "sources.csv").write_text("id,time,source\n")
    assert read_sources(tmp_path).rows([]) == []
    with pytest.raises(BadTable, match="not about all particles"):
        read_sources(tmp_path).rows([0])


@pytest.mark.parametrize(
    "rows", ["id,time\n0,0\n", "id,time,source\n5,0,a\n5,1,b\n", "id,time,source\n0,nan,a\n", "id,time,source\nx,0,a\n"]
)
def test_sources_that_are_none_are_refused_with_their_name(tmp_path, rows):
    (tmp_path / "sources.csv").write_text(rows)
    with pytest.raises(BadTable, match=r"sources\.csv is not a table of the sources"):
        read_sources(tmp_path)
