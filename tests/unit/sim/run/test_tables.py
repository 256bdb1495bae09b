"""Tables grow by whole frames, and go on where an earlier run ended."""

from __future__ import annotations

import os

import pytest

from common.files import Reserve, write_json
from sim.run.table import Table

COLUMNS = ("step", "time")


def table(path, until=None):
    return Table(path, COLUMNS, until)


def test_rows_come_with_the_frame(tmp_path):
    path = tmp_path / "steps.csv"
    steps = table(path)
    steps.add(1, 0.1)
    assert path.read_text() == "step,time\n"
    steps.flush()
    steps.add(2, 0.2)
    steps.drop()
    steps.add(2, float("nan"))
    steps.flush()
    assert path.read_text() == "step,time\n1,0.1\n2,\n"


def test_a_frame_is_taken_back(tmp_path):
    path = tmp_path / "steps.csv"
    steps = table(path)
    steps.add(1, 0.1)
    steps.flush()
    steps.mark()
    steps.undo()
    assert path.read_text() == "step,time\n1,0.1\n"
    steps.add(2, 0.2)
    steps.flush()
    steps.undo()
    steps.add(3, 0.3)
    steps.flush()
    assert path.read_text() == "step,time\n1,0.1\n3,0.3\n"


def test_a_table_goes_on(tmp_path):
    path = tmp_path / "steps.csv"
    first = table(path)
    for step in range(1, 7):
        first.add(step, step / 30)
    first.flush()
    first.close()
    second = table(path, until=4 / 30)
    second.add(5, 0.5)
    second.flush()
    assert path.read_text().splitlines()[-2:] == ["4,0.133333333", "5,0.5"]


@pytest.mark.parametrize("left", ["", "step,time\n1,", "other,columns\n1,0.1\n", "step,time\nx,y\n", "step,time\n\n"])
def test_what_is_no_such_table_is_replaced(tmp_path, left):
    path = tmp_path / "steps.csv"
    path.write_text(left)
    table(path, until=1.0)
    assert path.read_text() == "step,time\n"


def test_a_new_run_starts_new_tables(tmp_path):
    path = tmp_path / "steps.csv"
    path.write_text("step,time\n1,0.1\n")
    table(path)
    assert path.read_text() == "step,time\n"


def test_the_reserve_takes_room_and_gives_it_back(tmp_path):
    """Without a name, so that a process that is killed leaves nothing of it."""
    reserve = Reserve(tmp_path)
    for size, held in ((10_000, 10_000), (5_000, 10_000), (12_000, 12_000)):
        reserve.hold(size)
        assert os.fstat(reserve._file.fileno()).st_size == held
    assert not list(tmp_path.iterdir())
    reserve.release()
    reserve.release()
    assert reserve._file is None


def test_half_a_file_never_has_its_name(tmp_path):
    with pytest.raises(ValueError):
        write_json(tmp_path / "summary.json", {"bad": float("nan")})
    assert not list(tmp_path.iterdir())
