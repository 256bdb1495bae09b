"""The two ways in which DFSPH finds pressures, side by side: published Jacobi iterations and conjugate gradients.

The dam break of `scenes/dam_break.yaml` at draft, and the standing wave of
`tests/verification/fluid/pressure/test_solvers_wave.py` on 10 layers, with the same errors allowed. Runs are made in
turns; of times the median is given, all else is the same in each run. Prints a Markdown table. Use a machine that is
idle.

python -m tests.benchmarks.dfsph_iterations --seconds 1.5 --repeats 3
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.support.fluid.solvers import steps
from tests.verification.fluid.pressure.test_solvers_wave import swing

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "scenes/dam_break.yaml"
ITERATIONS = ("conjugate_gradients", "jacobi")
COLUMNS = (
    "scene",
    "`density_error`",
    "`iteration`",
    "steps",
    "iterations for densities",
    "for the divergence",
    "stepping [s]",
    "mean compression",
    "greatest of a particle",
    "capped",
    "frames again",
)


def dam_break(out: Path, options: argparse.Namespace, settings: dict[str, object]) -> None:
    changes = {"duration": options.seconds} | {f"fluid.dfsph.{name}": value for name, value in settings.items()}
    command = [
        sys.executable,
        "-m",
        "sim",
        "run",
        SCENE,
        "--out",
        out,
        "--quiet",
        "--arch",
        "cpu",
        "--quality",
        "draft",
    ]
    command += [word for name, value in changes.items() for word in ("--set", f"{name}={value}")]
    command += ["--threads", options.threads]
    subprocess.run([str(word) for word in command], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)


def standing_wave(out: Path, _: argparse.Namespace, settings: dict[str, object]) -> None:
    """On one thread, as the test has it."""
    swing(out, "dfsph", 10, 2, dfsph=settings)


SCENES = {"dam break": dam_break, "standing wave": standing_wave}


def measured(scene: str, options: argparse.Namespace, error: float, iteration: str) -> tuple[float, list[str]]:
    """Stepping time [s], and what is the same in each run."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        SCENES[scene](out, options, {"iteration": iteration, "density_error": error})
        table, summary = steps(out), json.loads((out / "summary.json").read_text())
    counts = summary["counts"]
    found = [
        f"{table['pressure_iterations'].mean():.1f}",
        f"{table['divergence_iterations'].mean():.1f}",
        f"{table['density_error_avg'].mean():.1e}",
        f"{table['density_error_max'].max():.2f}",
        str(counts["pressure_capped"]),
        str(counts["retries"]),
    ]
    return summary["wall_s"]["stepping"], [str(len(table)), *found]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--errors", type=float, nargs="+", default=[1e-3, 1e-4], help="density_error of the runs")
    parser.add_argument("--seconds", type=float, default=1.5, help="simulated time of the dam break [s] (default: 1.5)")
    parser.add_argument("--repeats", type=int, default=3, help="runs of each, in turns (default: 3)")
    parser.add_argument("--threads", type=int, default=2, help="of the dam break (default: 2)")
    options = parser.parse_args()

    cases = [(scene, error, iteration) for scene in SCENES for error in options.errors for iteration in ITERATIONS]
    times: dict[tuple[str, float, str], list[float]] = {case: [] for case in cases}
    same: dict[tuple[str, float, str], list[str]] = {}
    for _ in range(options.repeats):
        for case in cases:
            scene, error, iteration = case
            time, same[case] = measured(scene, options, error, iteration)
            times[case].append(time)
    print(f"| {' | '.join(COLUMNS)} |\n|{' --- |' * len(COLUMNS)}")
    for scene, error, iteration in cases:
        case = (scene, error, iteration)
        taken, densities, divergence, *rest = same[case]
        row = [
            scene,
            f"{error:g}",
            iteration,
            taken,
            densities,
            divergence,
            f"{statistics.median(times[case]):.1f}",
            *rest,
        ]
        print(f"| {' | '.join(row)} |")


if __name__ == "__main__":
    main()
