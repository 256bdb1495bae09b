"""What scenes cost here and in an earlier version, in turns: time of steps, their number, the rest of a run, memory.

python tests/benchmarks/versions.py REVISION scenes/bunny.yaml scenes/bowl.yaml --frames 8

The earlier version is checked out beside this one, and runs with the same packages. A first run of each, which compiles
kernels and measures meshes, does not count; nor do the first steps of the others, which load kernels. Each version goes
first every other time: what runs second meets a machine that is warmer, and may be slower for it.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from tests.benchmarks.earlier import change, earlier  # noqa: E402

LOADING = 3
"""Steps at the beginning that do not count."""
UNITS = {"cost": "s a simulated second", "steps": "steps in it", "rest": "s beside steps", "bytes": "bytes"}


def run(tree: Path, scene: Path, options: argparse.Namespace) -> dict[str, float]:
    """What the first frames of a scene cost by the sources in `tree`."""
    with tempfile.TemporaryDirectory() as out:
        command = [sys.executable, "-m", "sim", "run", scene, "--out", out, "--quiet", "--arch", "cpu"]
        command += ["--frames", f"0:{options.frames}", "--quality", options.quality, "--threads", options.threads]
        given = os.environ | {"PYTHONPATH": str(tree)}
        start = time.perf_counter()
        done = subprocess.run(list(map(str, command)), cwd=tree, env=given, capture_output=True, text=True, check=False)
        wall = time.perf_counter() - start
        if done.returncode:
            sys.exit(f"{scene} in {tree}: exit {done.returncode}\n{done.stderr}")
        summary = json.loads((Path(out) / "summary.json").read_text())
        with (Path(out) / "steps.csv").open() as file:
            rows = list(csv.DictReader(file))
    simulated = float(rows[-1]["time"]) - float(rows[LOADING - 1]["time"])
    stepping = sum(float(row["wall_s"]) for row in rows[LOADING:])
    return {
        "cost": stepping / simulated,
        "steps": (len(rows) - LOADING) / simulated,
        "rest": wall - stepping,
        "bytes": sum(summary["bytes"].values()),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("revision", help="of git, to compare with")
    parser.add_argument("scenes", nargs="+", type=Path)
    parser.add_argument("--quality", default="draft")
    parser.add_argument("--frames", type=int, default=8)
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    with earlier(options.revision) as before:
        for scene in options.scenes:
            told: dict[Path, list[dict[str, float]]] = {before: [], ROOT: []}
            for turn in range(options.turns + 1):
                for tree in list(told)[:: 1 if turn % 2 else -1]:
                    told[tree].append(run(tree, scene, options))
            print(scene)
            for key, unit in UNITS.items():
                old, new = ([one[key] for one in runs[1:]] for runs in told.values())
                print(change(old, new, unit), flush=True)


if __name__ == "__main__":
    main()
