"""Reading the workflow is quick and imports no stage's machinery."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import time

HEAVY = ("taichi", "bpy", "pysplashsurf", "numpy", "matplotlib", "trimesh")


def test_imports(fresh):
    code = "import json, sys, workflow.catalog, workflow.memory; print(json.dumps(sorted(sys.modules)))"
    printed = subprocess.run([sys.executable, "-c", code], cwd=fresh.folder, capture_output=True, text=True, check=True)
    assert not set(HEAVY) & set(json.loads(printed.stdout))


def test_a_dry_run_over_600_frames_takes_less_than_3_seconds(fresh):
    fresh.edit("duration: 2\nfps: 4", "duration: 25\nfps: 24")
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    ran = fresh.dry_run()
    after, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter() - start
    assert len(ran.jobs) == 50 + 50 + 150 + 1
    busy = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    assert min(busy, wall) < 3.0


def test_snakemake_has_no_complaint(fresh):
    ran = fresh.snakemake("--lint")
    complaints = [line for line in ran.text.splitlines() if line.lstrip().startswith("* ")]
    waived = ("conda environment", "variable sys")
    assert not [line for line in complaints if not any(word in line for word in waived)], ran.text
