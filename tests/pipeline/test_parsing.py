"""Reading the workflow is quick and imports no stage's machinery."""

from __future__ import annotations

import json
import re
import subprocess
import sys

HEAVY = ("taichi", "bpy", "pysplashsurf", "numpy", "matplotlib", "trimesh")


def test_imports(fresh):
    code = "import json, sys, workflow.catalog, workflow.plan.memory; print(json.dumps(sorted(sys.modules)))"
    printed = subprocess.run([sys.executable, "-c", code], cwd=fresh.folder, capture_output=True, text=True, check=True)
    assert not set(HEAVY) & set(json.loads(printed.stdout))


def test_a_dry_run_over_600_frames_plans_blocks_and_loads_nothing_heavy(fresh):
    """What makes it quick; `tests/benchmarks/dry_run.py` tells how quick."""
    fresh.edit("duration: 2\nfps: 4", "duration: 25\nfps: 24")
    ran = fresh.dry_run(PYTHONPROFILEIMPORTTIME="1")
    assert len(ran.jobs) == 50 + 50 + 150 + 1
    imported = set(re.findall(r"^import time:.*\| +(\S+)$", ran.text, re.MULTILINE))
    assert "snakemake.workflow" in imported
    # Snakemake itself loads numpy.
    assert not (set(HEAVY) - {"numpy"}) & imported


def test_snakemake_has_no_complaint(fresh):
    ran = fresh.snakemake("--lint")
    complaints = [line for line in ran.text.splitlines() if line.lstrip().startswith("* ")]
    waived = ("conda environment", "variable sys")
    assert not [line for line in complaints if not any(word in line for word in waived)], ran.text
