"""What a particle costs in small and in large scenes: time of a step and memory, over the number of particles.

python tests/benchmarks/scaling.py --method wcsph --particles 50000 200000 1000000
"""

from __future__ import annotations

import argparse
import csv
import json
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
        subprocess.run([*map(str, command), "--threads", str(threads)], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
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
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--method", choices=("wcsph", "pcisph", "iisph", "dfsph"), default="wcsph")
    parser.add_argument("--particles", type=int, nargs="+", default=[50_000, 200_000, 1_000_000])
    parser.add_argument("--seconds", type=float, default=0.01, help="simulated time [s] (default: 0.01)")
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    for particles in options.particles:
        told = run(options.method, particles, options.seconds, options.threads)
        print(
            f"{told['particles']:>9,.0f} particles, {told['steps']} steps of {told['iterations']:.1f} iterations: "
            f"{told['nanoseconds']:.0f} ns and {told['bytes']:.0f} bytes a particle"
        )


if __name__ == "__main__":
    main()
