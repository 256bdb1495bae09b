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
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from tests.benchmarks.earlier import compare, parser, simulate  # noqa: E402

LOADING = 3
"""Steps at the beginning that do not count."""
UNITS = {"cost": "s a simulated second", "steps": "steps in it", "rest": "s beside steps", "bytes": "bytes"}


def run(tree: Path, scene: Path, options: argparse.Namespace) -> dict[str, float]:
    """What the first frames of a scene cost by the sources in `tree`."""
    with tempfile.TemporaryDirectory() as name:
        out = Path(name)
        wall = simulate(tree, scene, out, options, "--frames", f"0:{options.frames}")
        summary = json.loads((out / "summary.json").read_text())
        with (out / "steps.csv").open() as file:
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
    parse = parser(__doc__)
    parse.add_argument("scenes", nargs="+", type=Path)
    parse.add_argument("--frames", type=int, default=8)
    parse.add_argument("--turns", type=int, default=3)
    options = parse.parse_args()
    compare(options, lambda tree, scene: run(tree, scene, options), UNITS)


if __name__ == "__main__":
    main()
