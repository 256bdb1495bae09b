"""`--config error=...`: the cheapest film that a study found exact enough."""

from __future__ import annotations

import json

import pytest

TARGET = "renders/tests/pond"
STUDY = """\
description: How far is the water's height from that of finer particles?
scene: ../tests/pond.yaml
grids:
  - fluid.particle_radius: [50 mm, 40 mm]
quantity: {name: potential energy, table: steps, column: potential_energy}
reference: {type: trial, set: {fluid.particle_radius: 35 mm}}
repeats: 1
speaks_for: fluid
"""


@pytest.mark.slow
def test_a_film_as_exact_as_a_study_says(fresh):
    study = fresh.folder / "scenes" / "studies" / "pond.yaml"
    study.parent.mkdir()
    study.write_text(STUDY)
    missing = fresh.snakemake("-n", TARGET, "--config", "error=50%")
    assert missing.code == 1
    assert "snakemake --cores all studies/pond" in missing.text
    assert fresh.snakemake("--cores", "2", "studies/pond").code == 0

    ran = fresh.snakemake("--cores", "2", TARGET, "--config", "error=50%")
    assert ran.code == 0, ran.text
    results = fresh.folder / "results" / "tests" / "pond"
    choice = json.loads((results / "accuracy.json").read_text())
    assert choice["spacings"]["fluid.particle_radius"] in (0.05, 0.04)
    assert "in study pond with" in choice["reasons"][0]
    assert f"predicted {choice['forecast']['wall_s']:.0f} s" in ran.text
    assert (results / "accuracy" / "simulation").is_dir()
    again = fresh.snakemake("-n", "--cores", "2", TARGET, "--config", "error=50%")
    assert "pilot" not in again.text
    assert not again.jobs

    least = fresh.snakemake("-n", TARGET, "--config", "error=0.000001%")
    assert least.code == 1
    assert "can be trusted with that" in least.text
