"""What each optional term costs a scene: start-up, memory and time of a step, beside the same scene without it.

    python tests/benchmarks/terms.py [--turns 3] [TERM ...]

A pool of 8,000 particles settles; all variants take turns, each in a process of its own, and the table holds medians.
Kernels are compiled before, so that start-up is what every later run takes.
"""

from __future__ import annotations

import argparse
import copy
import json
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from snakemake.utils import update_config

ROOT = Path(__file__).parents[2]
FRAMES = 4
BASE: dict[str, Any] = {
    "fps": 50,
    "containers": {"tank": {"type": "box", "size": [0.4, 0.6, 0.4]}},
    "fluid": {
        "solver": "dfsph",
        "particle_radius": 0.01,
        "viscosity": 0,
        "bodies": {"water": {"shape": {"type": "box", "size": [0.4, 0.4, 0.4]}, "position": [0, 0.2, 0]}},
    },
}
"""DFSPH without any optional term."""
BALL = {"shape": {"type": "sphere", "radius": 0.05}, "position": [0, 0.5, 0]}
SHEET = {"shape": {"type": "sheet", "size": [0.3, 0.3]}, "spacing": 0.02, "position": [0, 0.5, 0], "pins": ["corners"]}
DOWN = [{"axis": [1, 0, 0], "angle": 180}]
TAP = {"shape": {"type": "disc", "radius": 0.03}, "position": [0, 0.55, 0], "rotation": DOWN, "speed": 1}
TERMS: dict[str, dict[str, Any]] = {
    "viscosity, explicit": {"fluid": {"viscosity": 1e-3, "viscosity_solver": "explicit"}},
    "viscosity, implicit": {"fluid": {"viscosity": 1e-3, "viscosity_solver": "implicit"}},
    "XSPH": {"fluid": {"xsph": 0.05}},
    "surface tension, Becker and Teschner": {"fluid": {"surface_tension": 0.07}},
    "surface tension, Akinci": {"fluid": {"surface_tension": 0.07, "surface_tension_model": "akinci2013"}},
    "a tap": {"fluid": {"emitters": {"tap": TAP}}},
    "a probe of the height": {"probes": {"height": {"type": "water_height", "x": 0, "z": 0}}},
    "a body that stands": {"rigid": {"bodies": {"ball": BALL}}},
    "a body that moves as prescribed": {
        "rigid": {"bodies": {"ball": BALL | {"motion": "prescribed", "velocity": [0, -0.1, 0]}}}
    },
    "a body that obeys forces": {"rigid": {"bodies": {"ball": BALL | {"motion": "dynamic"}}}},
    "a sheet of cloth": {"cloth": {"sheets": {"sheet": SHEET}}},
}


def with_term(more: Mapping[str, Any]) -> dict[str, Any]:
    scene = copy.deepcopy(BASE)
    update_config(scene, more)
    return scene


def run(scene: Mapping[str, Any]) -> dict[str, float]:
    """Of one run in a process of its own: start-up [s], milliseconds of a step, bytes, kernels, modules."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "sim.segment", "--spec", json.dumps(scene), "--folder", folder]
        command += ["--frames", f"0:{FRAMES}", "--out", f"{folder}/out", "--arch", "cpu", "--threads", "1"]
        start = time.perf_counter()
        subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
        whole = time.perf_counter() - start
        summary = json.loads(Path(folder, "out", "summary.json").read_text(encoding="utf-8"))
    stepping, steps = summary["wall_s"]["stepping"], summary["counts"]["steps"]
    return {
        "start-up [s]": whole - stepping,
        "a step [ms]": 1e3 * stepping / steps,
        "steps": steps,
        "memory [MB]": sum(summary["bytes"].values()) / 1e6,
        "kernels": len(summary["kernels"]),
        "modules": len(summary["modules"]),
    }


def main(argv: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--turns", type=int, default=3, help="runs of each variant (default: 3)")
    parser.add_argument("terms", nargs="*", metavar="TERM", help="only these")
    given = parser.parse_args(argv)
    chosen = {name: more for name, more in TERMS.items() if not given.terms or name in given.terms}
    scenes = {"none": BASE} | {name: with_term(more) for name, more in chosen.items()}
    for scene in scenes.values():
        run(scene)
    found: dict[str, list[dict[str, float]]] = {name: [] for name in scenes}
    for _ in range(given.turns):
        for name, scene in scenes.items():
            found[name].append(run(scene))
    columns = list(found["none"][0])
    print(f"| term | {' | '.join(columns)} |\n|{' --- |' * (len(columns) + 1)}")
    for name, runs in found.items():
        medians = (statistics.median(one[column] for one in runs) for column in columns)
        print(f"| {name} | {' | '.join(f'{value:.4g}' for value in medians)} |")


if __name__ == "__main__":
    main()
