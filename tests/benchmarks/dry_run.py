"""How long `snakemake -n` takes for a film, beside Snakemake itself on as many jobs that do nothing.

    python tests/benchmarks/dry_run.py --frames 10000

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
sys.path.insert(0, str(ROOT))

from workflow.plan.timeline import Timeline  # noqa: E402

FPS = 24
SCENE = """\
duration: {duration}
fps: {fps}
fluid:
  particle_radius: 0.05
  bodies:
    block: {{shape: {{type: box, size: [0.3, 0.4, 0.5]}}, position: [0, 0.2, 0]}}
"""
BARE = """\
rule all:
    input: expand("{{n}}.txt", n=range({others}))
rule one:
    output: "{{n}}.txt"
    shell: "touch {{output}}"
"""


def jobs_of_film(frames: int) -> int:
    """Segments that are simulated and reconstructed, blocks of pictures, and the film."""
    timeline = Timeline(FPS, frames)
    return 2 * timeline.segments + timeline.blocks + 1


def dry_run(snakefile: Path, folder: Path, target: str, planned: int) -> float:
    """Seconds on the wall of a dry run that plans so many jobs."""
    command = [sys.executable, "-m", "snakemake", "--dry-run", "--snakefile", str(snakefile), target]
    start = time.perf_counter()
    done = subprocess.run(command, cwd=folder, env=os.environ | {"NO_COLOR": "1"}, capture_output=True, text=True)
    wall = time.perf_counter() - start
    jobs = [line.split()[1] for line in done.stdout.splitlines() if line.startswith("total ")]
    if done.returncode or jobs[:1] != [str(planned)]:
        sys.exit(f"{target}: exit status {done.returncode}, {jobs[:1]} jobs\n{done.stdout}{done.stderr}")
    return wall


def project(folder: Path) -> Path:
    """A folder with the sources and one for scenes; returns its Snakefile."""
    for name in ("common", "scene", "workflow", "sim", "render", "Snakefile"):
        (folder / name).symlink_to(ROOT / name)
    (folder / "scenes").mkdir()
    return folder / "Snakefile"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--turns", type=int, default=5, help="runs of either (default: 5)")
    parser.add_argument("--frames", type=int, default=600, help="of the film (default: 600)")
    options = parser.parse_args()
    film, bare, jobs = [], [], jobs_of_film(options.frames)
    with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as other:
        snakefile, nothing = project(Path(one)), Path(other) / "Snakefile"
        scene = SCENE.format(duration=options.frames / FPS, fps=FPS)
        (Path(one) / "scenes" / "film.yaml").write_text(scene)
        nothing.write_text(BARE.format(others=jobs - 1))
        for _ in range(options.turns):
            film.append(dry_run(snakefile, Path(one), "renders/film", jobs))
            bare.append(dry_run(nothing, Path(other), "all", jobs))
    ratios = [a / b for a, b in zip(film, bare, strict=True)]
    print(f"film of {options.frames} frames, {jobs} jobs: {statistics.median(film):.2f} s")
    print(f"as many jobs that do nothing: {statistics.median(bare):.2f} s")
    print(f"ratio: {statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})")


if __name__ == "__main__":
    main()
