"""What a particle costs in small and in large scenes: time of a step and memory, over the number of particles.

python tests/benchmarks/scaling.py --method dfsph --particles 50000 200000 1000000 4000000

Sizes take turns, from small to large and back. Told are the medians over all steps but the first two of each run, which
may load kernels, and how much more a particle costs than in the smallest scene; the arrays of the simulation, and the
most memory that a process had, Python and its libraries included.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "scenes/bench/splishsplash_dam_break.yaml"
EDGE = 0.975
"""Of the cube of water in the scene [m]."""


def run(method: str, particles: int, seconds: float, threads: int) -> dict[str, float]:
    radius = EDGE / (2 * round(particles ** (1 / 3)))
    settings = (
        f"fluid.solver={method}",
        f"fluid.particle_radius={radius}",
        f"duration={seconds}",
        f"fps={1 / seconds}",
    )
    options = [word for setting in settings for word in ("--set", setting)]
    with tempfile.TemporaryDirectory() as out:
        command = [sys.executable, "-m", "sim", "run", SCENE, "--out", out, "--quiet", "--arch", "cpu", *options]
        command = [*map(str, command), "--threads", str(threads)]
        with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL) as running:
            _, status, usage = os.wait4(running.pid, 0)
            running.returncode = os.waitstatus_to_exitcode(status)
        if running.returncode:
            sys.exit(f"exit status {running.returncode}")
        summary = json.loads((Path(out) / "summary.json").read_text())
        with (Path(out) / "steps.csv").open() as file:
            rows = list(csv.DictReader(file))
    count = summary["counts"]["particles"]
    iterations = [float(row.get("pressure_iterations") or 0) for row in rows]
    return {
        "particles": count,
        "steps": len(rows),
        # The first steps may still load kernels.
        "nanoseconds": 1e9 * statistics.median(float(row["wall_s"]) for row in rows[2:]) / count,
        "iterations": statistics.mean(iterations),
        "bytes": sum(summary["bytes"].values()) / count,
        "gigabytes": usage.ru_maxrss * 1024 / 1e9,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--method", choices=("wcsph", "pcisph", "iisph", "dfsph"), default="wcsph")
    parser.add_argument("--particles", type=int, nargs="+", default=[50_000, 200_000, 1_000_000])
    parser.add_argument("--seconds", type=float, default=0.01, help="simulated time [s] (default: 0.01)")
    parser.add_argument("--turns", type=int, default=2, help="runs of each (default: 2)")
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    found: dict[int, list[dict[str, float]]] = {particles: [] for particles in options.particles}
    for turn in range(options.turns):
        for particles in options.particles[:: 1 if turn % 2 == 0 else -1]:
            found[particles].append(run(options.method, particles, options.seconds, options.threads))
    print("| particles | steps | iterations | ns a particle-step | over the first | bytes a particle | GB in all |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    first = 0.0
    for runs in found.values():
        told = {key: statistics.median(each[key] for each in runs) for key in runs[0]}
        first = first or told["nanoseconds"]
        print(
            f"| {told['particles']:,.0f} | {told['steps']:.0f} | {told['iterations']:.1f} | {told['nanoseconds']:.0f} "
            f"| {told['nanoseconds'] / first:.2f} | {told['bytes']:.0f} | {told['gigabytes']:.2f} |"
        )


if __name__ == "__main__":
    main()
