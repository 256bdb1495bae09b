"""How fast the solvers are beside SPlisHSPlasH: the same dam break, in turns on this machine, medians.

Set-up of the peer, once, in an environment of its own:

    python3.11 -m venv peers && peers/bin/pip install pySPlisHSPlasH==2.19.0

    python tests/benchmarks/dam_break.py --peer peers/bin/python
    python tests/benchmarks/dam_break.py --peer peers/bin/python --method wcsph --seconds 0.04 --boundary akinci

Where the peer's bundled GL library crashes, `--preload libGLdispatch.so.0` helps. Use a machine that is idle.

Compared is stepping alone. Kernels that compile and the first call of each are told apart on our side, as are the
peer's maps of the walls and its first step. A particle holds d^3 of water on both sides. Each goes as far in a step as
it does by default, which is 0.45 d for our DFSPH and 0.4 d for the peer, unless `--cfl` says so for both.
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
RADIUS = 0.0125
ITERATIONS = ("pressure_iterations", "divergence_iterations")
"""Columns of steps.csv."""


def ours(method: str, seconds: float, threads: int, cfl: float | None) -> dict[str, float]:
    with tempfile.TemporaryDirectory() as out:
        settings = [f"fluid.solver={method}", f"duration={seconds}"] + ([f"step.cfl={cfl}"] if cfl else [])
        options = [word for setting in settings for word in ("--set", setting)]
        command = [sys.executable, "-m", "sim", "run", SCENE, "--out", out, "--quiet", "--arch", "cpu", *options]
        subprocess.run([*map(str, command), "--threads", str(threads)], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
        return of_a_run(Path(out))


def of_a_run(out: Path) -> dict[str, float]:
    """What a run of ours came to, by what it left in its folder."""
    summary = json.loads((out / "summary.json").read_text())
    with (out / "steps.csv").open() as file:
        rows = list(csv.DictReader(file))
    counts, wall = summary["counts"], summary["wall_s"]
    return {
        "particles": counts["particles"],
        "steps": counts["steps"],
        "wall": wall["stepping"],
        "before": wall["build"] + wall["compile"],
        "iterations": statistics.mean(sum(float(row.get(name) or 0) for name in ITERATIONS) for row in rows),
        "compression": statistics.mean(float(row["density_error_avg"]) for row in rows),
    }


def peer(options: argparse.Namespace) -> dict[str, float]:
    environment = dict(os.environ, OMP_NUM_THREADS=str(options.threads))
    if options.preload:
        environment["LD_PRELOAD"] = options.preload
    command = [options.peer, Path(__file__).with_name("splishsplash.py"), "--method", options.method]
    command += ["--boundary", options.boundary, "--radius", RADIUS, "--seconds", options.seconds]
    command += ["--cfl", options.cfl] if options.cfl else []
    told = subprocess.run(list(map(str, command)), env=environment, check=True, capture_output=True, text=True).stdout
    return json.loads(next(line for line in told.splitlines() if line.startswith("RESULT")).removeprefix("RESULT"))


def report(name: str, runs: list[dict[str, float]]) -> dict[str, float]:
    middle = {key: statistics.median(run[key] for run in runs) for key in runs[0]}
    middle["rate"] = statistics.median(run["particles"] * run["steps"] / run["wall"] for run in runs)
    walls = ", ".join(f"{run['wall']:.1f}" for run in runs)
    print(f"{name}: {middle['particles']:,.0f} particles, {middle['steps']:.0f} steps")
    print(f"    {middle['wall']:.1f} s, the median of {walls} s, and {middle['before']:.1f} s before them")
    print(f"    {1e3 * middle['wall'] / middle['steps']:.1f} ms and {middle['iterations']:.1f} iterations a step")
    print(f"    {middle['rate'] / 1e6:.2f} M particle-steps/s, mean compression {middle['compression']:.5f}")
    return middle


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--peer", type=Path, help="Python of the peer's environment; without it only our side runs")
    parser.add_argument("--preload", metavar="LIBRARY", help="library to load before the peer's own")
    parser.add_argument("--method", choices=("wcsph", "pcisph", "iisph", "dfsph"), default="dfsph")
    parser.add_argument("--boundary", choices=("akinci", "density-map", "volume-map"), default="volume-map")
    parser.add_argument("--cfl", type=float, metavar="NUMBER", help="how far the fastest particle goes in a step, in d")
    parser.add_argument("--seconds", type=float, default=1.0, help="simulated time [s] (default: 1)")
    parser.add_argument("--repeats", type=int, default=3, help="runs of each, in turns (default: 3)")
    parser.add_argument("--threads", type=int, default=2, help="for both (default: 2)")
    options = parser.parse_args()

    ours(options.method, 0.04, options.threads, options.cfl)  # kernels are in Taichi's cache from here on
    own, theirs = [], []
    for _ in range(options.repeats):
        own.append(ours(options.method, options.seconds, options.threads, options.cfl))
        if options.peer:
            theirs.append(peer(options))
    mine = report(f"Tidemill {options.method}", own)
    if theirs:
        other = report(f"SPlisHSPlasH {options.method}, {options.boundary}", theirs)
        longer, faster = other["wall"] / mine["wall"], mine["rate"] / other["rate"]
        print(f"the peer takes {longer:.2f} times as long; we do {faster:.2f} times its particle-steps per second")


if __name__ == "__main__":
    main()
