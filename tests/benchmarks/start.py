"""How long scenes take to start here and in an earlier version, in turns: until their second frame is written.

python tests/benchmarks/start.py REVISION scenes/tiny/splash.yaml scenes/drape.yaml

In a turn each version runs twice with kernels kept in a folder of its own: empty at first, so that all are compiled,
and then full, so that they are loaded. A first run of each, which measures meshes, does not count. Each version goes
first every other time. Seconds are of the whole command, the start of Python included.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from tests.benchmarks.earlier import change, earlier  # noqa: E402

KINDS = ("with nothing compiled before", "with all compiled before")


def seconds(tree: Path, scene: Path, kernels: Path, options: argparse.Namespace) -> float:
    """Until the second frame of a scene is there, by the sources in `tree`."""
    with tempfile.TemporaryDirectory() as out:
        command = [sys.executable, "-m", "sim", "run", scene, "--out", out, "--quiet", "--arch", "cpu"]
        command += ["--frames", "0:1", "--quality", options.quality, "--threads", options.threads]
        given = os.environ | {"PYTHONPATH": str(tree), "TI_OFFLINE_CACHE_FILE_PATH": str(kernels)}
        start = time.perf_counter()
        done = subprocess.run(list(map(str, command)), cwd=tree, env=given, capture_output=True, text=True, check=False)
        wall = time.perf_counter() - start
    if done.returncode:
        sys.exit(f"{scene} in {tree}: exit {done.returncode}\n{done.stderr}")
    return wall


def turn(tree: Path, scene: Path, options: argparse.Namespace) -> list[float]:
    with tempfile.TemporaryDirectory() as kernels:
        return [seconds(tree, scene, Path(kernels), options) for _ in KINDS]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("revision", help="of git, to compare with")
    parser.add_argument("scenes", nargs="+", type=Path)
    parser.add_argument("--quality", default="draft")
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    with earlier(options.revision) as before:
        for scene in options.scenes:
            told: dict[Path, list[list[float]]] = {before: [], ROOT: []}
            for number in range(options.turns + 1):
                for tree in list(told)[:: 1 if number % 2 else -1]:
                    told[tree].append(turn(tree, scene, options))
            print(scene)
            for kind, said in enumerate(KINDS):
                old, new = ([one[kind] for one in runs[1:]] for runs in told.values())
                print(change(old, new, f"s {said}"), flush=True)


if __name__ == "__main__":
    main()
