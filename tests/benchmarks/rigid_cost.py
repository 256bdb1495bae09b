"""What rigid bodies cost: a fluid alone, the same with bodies in it, and the bodies alone; and what a scene pays for
them that has none, against the project as it was before they came.

    git worktree add ../before b3aba19
    python tests/benchmarks/rigid_cost.py --against ../before

Without bodies, only the last of these: `--bodies 0 --against` a checkout of 3c8976e~1 tells what cloth costs a scene
that has none.

All runs take turns, each in a process of its own, and a ratio is the median over its turns: other work on the machine
then weighs on both sides. What a simulated second costs is the median time of a step on the wall, times its steps: a
few steps of each run load kernels.
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
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
TANK = (1.0, 0.6, 0.5)
WATER = (0.5, 0.4, 0.5)
"""Of the column that breaks in the tank [m]."""
FPS = 20


def water(particles: int) -> dict[str, Any]:
    radius = (WATER[0] * WATER[1] * WATER[2] / particles) ** (1 / 3) / 2
    place = [(WATER[0] - TANK[0]) / 2, WATER[1] / 2, 0]
    body = {"shape": {"type": "box", "size": [edge - 2 * radius for edge in WATER]}, "position": place}
    return {"solver": "dfsph", "particle_radius": radius, "bodies": {"column": body}}


def crates(number: int) -> dict[str, Any]:
    """Crates of 6 cm and half the density of water, in layers on the dry side of the tank."""
    bodies = {}
    for k in range(number):
        row, rest = k % 5, k // 5
        place = [0.06 + 0.09 * (rest % 4), 0.04 + 0.08 * (rest // 4), -0.18 + 0.09 * row]
        shape = {"type": "box", "size": [0.06] * 3}
        bodies[f"crate{k}"] = {"motion": "dynamic", "density": 500, "shape": shape, "position": place}
    return {"bodies": bodies}


@dataclass(frozen=True)
class Case:
    name: str
    tree: Path
    spec: dict[str, Any]


@dataclass(frozen=True)
class Found:
    cost: float
    """Seconds on the wall per simulated second."""
    steps: int
    step: float
    """Median time of a step [s]."""
    particles: int


def run(case: Case, seconds: float, threads: int) -> Found:
    spec = {"fps": FPS, "containers": {"tank": {"type": "box", "size": TANK}}, **case.spec}
    with tempfile.TemporaryDirectory() as out:
        options = ["--folder", out, "--out", out, "--frames", f"0:{round(seconds * FPS)}", "--threads", str(threads)]
        command = [sys.executable, "-m", "sim.segment", "--spec", json.dumps(spec), "--arch", "cpu", *options]
        environment = os.environ | {"PYTHONPATH": str(case.tree)}
        done = subprocess.run(command, cwd=case.tree, env=environment, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{case.name}: exit status {done.returncode}\n{done.stderr}")
        summary = json.loads((Path(out) / "summary.json").read_text())
        with (Path(out) / "steps.csv").open() as file:
            walls = [float(row["wall_s"]) for row in csv.DictReader(file)]
    step = statistics.median(walls)
    return Found(step * len(walls) / seconds, len(walls), step, summary["counts"]["particles"])


def ratio(found: dict[str, list[Found]], upper: str, lower: str) -> str:
    """Median over the turns, and the least and greatest of them."""
    ratios = [one.cost / other.cost for one, other in zip(found[upper], found[lower], strict=True)]
    return f"{statistics.median(ratios):.3f} ({min(ratios):.3f} to {max(ratios):.3f})"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--particles", type=int, default=15_000, help="about as many (default: 15000)")
    parser.add_argument("--bodies", type=int, default=10, help="crates (default: 10); 0: the fluid alone")
    parser.add_argument("--seconds", type=float, default=0.5, help="simulated time [s] (default: 0.5)")
    parser.add_argument("--turns", type=int, default=3, help="runs of every scene (default: 3)")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--against", type=Path, metavar="TREE", help="another checkout, for the fluid alone")
    options = parser.parse_args()
    fluid, rigid = {"fluid": water(options.particles)}, {"rigid": crates(options.bodies)}
    cases = [Case("fluid", ROOT, fluid)]
    if options.bodies:
        cases += [Case("both", ROOT, fluid | rigid), Case("bodies", ROOT, rigid)]
    if options.against:
        cases.insert(1, Case("before", options.against.resolve(), fluid))
    for case in cases:
        run(case, 2 / FPS, options.threads)
    found: dict[str, list[Found]] = {case.name: [] for case in cases}
    for turn in range(options.turns):
        # The other way round every other turn: what runs first is not always the same.
        for case in cases if turn % 2 == 0 else reversed(cases):
            found[case.name].append(run(case, options.seconds, options.threads))
    print("| scene | particles | crates | steps | time of a step [ms] | seconds per simulated second |")
    print("| --- | --- | --- | --- | --- | --- |")
    for case in cases:
        one, number = found[case.name][0], options.bodies if "rigid" in case.spec else 0
        step, cost = (statistics.median(getattr(run, name) for run in found[case.name]) for name in ("step", "cost"))
        print(f"| {case.name} | {one.particles:,} | {number} | {one.steps} | {1e3 * step:.1f} | {cost:.1f} |")
    if options.bodies:
        print(f"both over fluid: {ratio(found, 'both', 'fluid')}")
        print(f"bodies over fluid: {ratio(found, 'bodies', 'fluid')}")
    if options.against:
        print(f"fluid over the same before: {ratio(found, 'fluid', 'before')}")


if __name__ == "__main__":
    main()
