"""An earlier version of this project, beside the present one."""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[2]


@contextmanager
def earlier(revision: str) -> Iterator[Path]:
    """A folder with the sources of this revision of git, which goes at the end."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "before"
        subprocess.run(["git", "worktree", "add", "--quiet", "--detach", folder, revision], cwd=ROOT, check=True)
        try:
            yield folder
        finally:
            subprocess.run(["git", "worktree", "remove", "--force", folder], cwd=ROOT, check=True)


def parser(description: str | None) -> argparse.ArgumentParser:
    """Of the options that all comparisons with an earlier version have."""
    made = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("revision", help="of git, to compare with")
    made.add_argument("--quality", default="draft")
    made.add_argument("--threads", type=int, default=2)
    return made


def simulate(
    tree: Path, scene: Path, out: Path, options: argparse.Namespace, *more: str, program: Sequence[str] = ("-m", "sim")
) -> float:
    """Run a scene by the sources in `tree`; seconds of the whole command, the start of Python included."""
    command = [sys.executable, *program, "run", scene, "--out", out, "--quiet", "--arch", "cpu", *more]
    command += ["--quality", options.quality, "--threads", options.threads]
    given = os.environ | {"PYTHONPATH": str(tree)}
    start = time.perf_counter()
    done = subprocess.run(list(map(str, command)), cwd=tree, env=given, capture_output=True, text=True, check=False)
    wall = time.perf_counter() - start
    if done.returncode:
        sys.exit(f"{scene} in {tree}: exit {done.returncode}\n{done.stderr}")
    return wall


def compare(
    options: argparse.Namespace, measure: Callable[[Path, Path], dict[str, float]], units: dict[str, str]
) -> None:
    """Print of each scene the medians of what is measured by both versions in the same turns, their ratio, and the
    range of the ratios of turns. A first turn does not count, and each version goes first every other time."""
    with earlier(options.revision) as before:
        for scene in options.scenes:
            told: dict[Path, list[dict[str, float]]] = {before: [], ROOT: []}
            for turn in range(options.turns + 1):
                for tree in list(told)[:: 1 if turn % 2 else -1]:
                    told[tree].append(measure(tree, scene))
            print(scene)
            for key, unit in units.items():
                old, new = ([one[key] for one in runs[1:]] for runs in told.values())
                ratios = sorted(b / a for a, b in zip(old, new, strict=True))
                a, b = statistics.median(old), statistics.median(new)
                print(
                    f"  {a:,.4g} -> {b:,.4g} {unit}: {b / a:.2f} times ({ratios[0]:.2f} to {ratios[-1]:.2f})",
                    flush=True,
                )
