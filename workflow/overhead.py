"""What the pipeline adds to the work: wall time of the reconstruct and render jobs over splashsurf's and Cycles' own.

python -m workflow.overhead results/bunny/standard
"""

from __future__ import annotations

import argparse
import csv
import json
from pathlib import Path

from common.command import end_with

STAGES = {"surface": "splashsurf", "frames": "render"}
"""Folder of a stage's results, and the phase of its summary that is the work itself."""


def overhead(results: Path) -> dict[str, tuple[float, float]]:
    """Wall seconds of the jobs and of the work itself, by stage; raises FileNotFoundError for no such results."""
    found = {}
    for stage, phase in STAGES.items():
        jobs = sorted((results / "benchmarks" / stage).glob("*.tsv"))
        if not jobs:
            raise FileNotFoundError(f"{results} has no benchmarks of {stage} jobs: make the film first")
        wall = 0.0
        for job in jobs:
            with job.open() as stream:
                wall += float(next(csv.DictReader(stream, delimiter="\t"))["s"])
        summaries = [json.loads((results / stage / job.stem / "summary.json").read_text()) for job in jobs]
        found[stage] = wall, sum(summary["wall_s"][phase] for summary in summaries)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m workflow.overhead", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("results", type=Path, help="folder of one film's results at one quality")
    try:
        found = overhead(parser.parse_args().results)
    except FileNotFoundError as error:
        parser.error(str(error))
    for stage, (wall, own) in found.items():
        print(f"{stage:8} jobs {wall:9.1f} s   {STAGES[stage]:10} {own:9.1f} s   ratio {wall / own:.3f}")
    wall, own = (sum(values) for values in zip(*found.values(), strict=True))
    print(f"{'both':8} jobs {wall:9.1f} s   {'':10} {own:9.1f} s   ratio {wall / own:.3f}")


if __name__ == "__main__":
    end_with(main)
