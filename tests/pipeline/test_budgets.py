"""`--config budget=...`: the finest film that is predicted to fit, on the machine at hand."""

from __future__ import annotations

import json
import re

import pytest

TARGET = "renders/tests/pond"


@pytest.mark.slow
def test_a_film_within_a_budget(fresh):
    """Tiny, so that most of its time is that of processes that begin."""
    told = fresh.snakemake("-n", TARGET, "--config", "budget=1s")
    needed = float(re.search(r"takes about (\d+) s", told.text).group(1))
    assert told.code == 1
    assert "Traceback" not in told.text

    budget = f"budget={10 * needed:.0f}s"
    ran = fresh.snakemake("--cores", "2", TARGET, "--config", budget)
    assert ran.code == 0, ran.text
    choice = json.loads(fresh.folder.joinpath("results", "tests", "pond", "budget.json").read_text())
    assert choice["detail"] == 2.0
    assert f"predicted {choice['forecast']['wall_s']:.0f} s" in ran.text
    assert fresh.folder.joinpath("results", "tests", "pond", "budget", "simulation").is_dir()
    again = fresh.snakemake("-n", "--cores", "2", TARGET, "--config", budget)
    assert "pilot" not in again.text
    assert not again.jobs
