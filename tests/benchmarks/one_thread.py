"""Small scenes on one thread, and on several: from which size on these are faster.

Drops of water in a box, a cloth on a ball and stacks of boxes, of several sizes, each run in turns on one thread and on
several, whatever `sim.run.one_thread` would choose. Prints a Markdown table of times per step; use a machine that is
idle.

python -m tests.benchmarks.one_thread --threads 2 --turns 2
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest import mock

ROOT = Path(__file__).parents[2]
FPS, FRAMES = 100, 20
FLOOR = {"shape": {"type": "plane"}}


def water(solver: str, cells: int) -> dict[str, Any]:
    side = 0.025 * cells
    drop = {"shape": {"type": "box", "size": [side] * 3}, "position": [0, side / 2 + 0.05, 0]}
    box = {"type": "box", "size": [1.5, 1.5, 1.5]}
    return {
        "containers": {"box": box},
        "fluid": {"solver": solver, "particle_radius": 0.0125, "bodies": {"drop": drop}},
    }


def cloth(cells: int) -> dict[str, Any]:
    sheet = {"shape": {"type": "sheet", "size": [1, 1]}, "spacing": 1 / cells, "position": [0, 0.72, 0]}
    ball = {"shape": {"type": "sphere", "radius": 0.25}, "position": [0, 0.45, 0]}
    return {"rigid": {"bodies": {"floor": FLOOR, "ball": ball}}, "cloth": {"sheets": {"cloth": sheet}}}


def boxes(columns: int) -> dict[str, Any]:
    bodies: dict[str, Any] = {"floor": FLOOR}
    for place in range(columns**2 * 4):
        column, level = divmod(place, 4)
        x, z = divmod(column, columns)
        position = [0.12 * x, 0.06 + 0.11 * level, 0.12 * z]
        box = {"shape": {"type": "box", "size": [0.1] * 3}, "motion": "dynamic", "density": 500}
        bodies[f"box{place}"] = box | {"position": position}
    return {"rigid": {"bodies": bodies}}


SCENES: dict[str, Callable[[], dict[str, Any]]] = {
    **{f"DFSPH, {n**3:,} particles": lambda n=n: water("dfsph", n) for n in (6, 12, 17, 24)},
    **{f"WCSPH, {n**3:,} particles": lambda n=n: water("wcsph", n) for n in (6, 10, 17)},
    **{f"cloth, {(n + 1) ** 2:,} points": lambda n=n: cloth(n) for n in (20, 60, 100)},
    **{f"{n * n * 4:,} boxes": lambda n=n: boxes(n) for n in (2, 5, 10)},
}


def run(name: str, threads: int, out: Path) -> None:
    """In this process."""
    from sim.run import stepping
    from sim.segment import simulate
    from sim.spec import SimulationSpec

    spec = SimulationSpec.model_validate({"fps": FPS, **SCENES[name]()})
    with mock.patch.object(stepping, "takes_one_thread", lambda *_: threads == 1):
        simulate(spec, out, out, first=0, last=FRAMES, threads=threads, arch="cpu", quiet=True)


def measured(name: str, threads: int) -> float:
    """Time of a step [ms]."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", __spec__.name, "--child", name, "--threads", str(threads), "--out", folder]
        subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
        summary = json.loads((Path(folder) / "summary.json").read_text())
    return 1000 * summary["wall_s"]["stepping"] / summary["counts"]["steps"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--threads", type=int, default=2, help="of the runs that have several (default 2)")
    parser.add_argument("--turns", type=int, default=2, help="runs of each (default 2)")
    parser.add_argument("--child", choices=SCENES, help=argparse.SUPPRESS)
    parser.add_argument("--out", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.child:
        run(options.child, options.threads, options.out)
        return
    print(f"| scene | one thread [ms] | {options.threads} threads [ms] | ratio |\n| --- | --- | --- | --- |")
    for name in SCENES:
        times: dict[int, list[float]] = {1: [], options.threads: []}
        for count in list(times) * options.turns:
            times[count].append(measured(name, count))
        one, several = (statistics.median(found) for found in times.values())
        print(f"| {name} | {one:.2f} | {several:.2f} | {one / several:.2f} |", flush=True)


if __name__ == "__main__":
    main()
