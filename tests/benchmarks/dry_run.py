"""How long `snakemake -n` takes for a film of 600 frames, beside Snakemake itself on as many jobs that do nothing.

    python tests/benchmarks/dry_run.py

Both take turns, each in a process of its own; the ratio is the median over the turns.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[2]
JOBS = 251
SCENE = """\
duration: 25
fps: 24
fluid:
  particle_radius: 0.05
  bodies:
    block: {shape: {type: box, size: [0.3, 0.4, 0.5]}, position: [0, 0.2, 0]}
"""
BARE = f"""\
rule all:
    input: expand("{{n}}.txt", n=range({JOBS - 1}))
rule one:
    output: "{{n}}.txt"
    shell: "touch {{output}}"
"""


def dry_run(snakefile: Path, folder: Path, target: str) -> float:
    """Seconds on the wall of a dry run that plans JOBS jobs."""
    command = [sys.executable, "-m", "snakemake", "--dry-run", "--snakefile", str(snakefile), target]
    start = time.perf_counter()
    done = subprocess.run(command, cwd=folder, env=os.environ | {"NO_COLOR": "1"}, capture_output=True, text=True)
    wall = time.perf_counter() - start
    jobs = [line.split()[1] for line in done.stdout.splitlines() if line.startswith("total ")]
    if done.returncode or jobs[:1] != [str(JOBS)]:
        sys.exit(f"{target}: exit status {done.returncode}, {jobs[:1]} jobs\n{done.stdout}{done.stderr}")
    return wall


def project(folder: Path) -> Path:
    """A folder with the sources and one scene; returns its Snakefile."""
    for name in ("common", "scene", "workflow", "sim", "render", "Snakefile"):
        (folder / name).symlink_to(ROOT / name)
    (folder / "scenes").mkdir()
    (folder / "scenes" / "film.yaml").write_text(SCENE)
    return folder / "Snakefile"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--turns", type=int, default=5, help="runs of either (default: 5)")
    options = parser.parse_args()
    film, bare = [], []
    with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as other:
        snakefile, nothing = project(Path(one)), Path(other) / "Snakefile"
        nothing.write_text(BARE)
        for _ in range(options.turns):
            film.append(dry_run(snakefile, Path(one), "renders/film"))
            bare.append(dry_run(nothing, Path(other), "all"))
    ratios = [a / b for a, b in zip(film, bare, strict=True)]
    print(f"film of 600 frames, {JOBS} jobs: {statistics.median(film):.2f} s")
    print(f"as many jobs that do nothing: {statistics.median(bare):.2f} s")
    print(f"ratio: {statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})")


if __name__ == "__main__":
    main()
