"""What planning costs at scale: wall time and memory of `snakemake -n` for a long film and for a wide wedge.

python tests/benchmarks/scale.py [--frames 10000] [--combinations 100] [--turns 3]
"""

from __future__ import annotations

import argparse
import json
import os
import re
import statistics
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.benchmarks.dry_run import project

SCENE = """\
duration: {duration!r}
fps: 24
fluid:
  particle_radius: 0.05
  bodies:
    block: {{shape: {{type: box, size: [0.3, 0.4, 0.5]}}, position: [0, 0.2, 0]}}
"""


def planned(folder: Path, target: str) -> tuple[int, float, float]:
    """Jobs of a dry run, its wall time [s] and its largest memory [MB]."""
    out = folder / "dry_run.txt"
    command = [sys.executable, "-m", "snakemake", "--dry-run", "--quiet", "rules", "--cores", "2", target]
    start = time.perf_counter()
    with out.open("w") as sink:
        actions = [(os.POSIX_SPAWN_DUP2, sink.fileno(), 1), (os.POSIX_SPAWN_DUP2, sink.fileno(), 2)]
        os.chdir(folder)
        pid = os.posix_spawn(command[0], command, os.environ | {"NO_COLOR": "1"}, file_actions=actions)
        _, status, usage = os.wait4(pid, 0)
    wall = time.perf_counter() - start
    total = re.search(r"^total +(\d+)", out.read_text(), re.MULTILINE)
    if status or total is None:
        sys.exit(f"{target}: {out.read_text()}")
    return int(total[1]), wall, usage.ru_maxrss / 1024


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=10_000)
    parser.add_argument("--combinations", type=int, default=100)
    parser.add_argument("--turns", type=int, default=3)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        project(folder)
        (folder / "scenes" / "long.yaml").write_text(SCENE.format(duration=(options.frames - 1) / 24))
        values = json.dumps([1e-6 * (1 + index) for index in range(options.combinations)])
        wide = SCENE.format(duration=1) + f"wedge:\n  fluid.viscosity: {values}\n"
        (folder / "scenes" / "wide.yaml").write_text(wide)
        for target, what in (
            ("renders/long", f"{options.frames:,} frames"),
            ("wedges/wide", f"{options.combinations} combinations"),
        ):
            turns = [planned(folder, target) for _ in range(options.turns)]
            jobs, walls, memory = turns[0][0], [turn[1] for turn in turns], max(turn[2] for turn in turns)
            wall = statistics.median(walls)
            print(f"{what:18} {jobs:6} jobs  {wall:6.2f} s  {1000 * wall / jobs:5.1f} ms a job  {memory:5.0f} MB")


if __name__ == "__main__":
    main()
