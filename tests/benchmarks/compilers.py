"""What scenes cost with each compiler of kernels, in turns, and whether they give the same.

python tests/benchmarks/compilers.py .venv/bin/python /tmp/quadrants/bin/python /tmp/forge/bin/python

Each interpreter runs this tree with every compiler that it has (CONTRIBUTING.md says how to make one that has a fork);
a compiler of the same version that several have runs in the first of them. In a turn each compiler runs twice with
kernels kept in a folder of its own: empty at first, so that all are compiled, and then full, so that they are loaded.
Steps, memory and frames are those of the second run. Whoever goes first in one turn goes last in the next.

Differences are those from the compiler named first, in the last frame: of positions, particles by their identity.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from common.ply import columns, read_points  # noqa: E402
from sim.device.compiler_choice import COMPILERS, VARIABLE  # noqa: E402

SCENES = (ROOT / "scenes/dam_break.yaml", ROOT / "scenes/drape.yaml")
MEBIBYTE = 2**20
FRAMES = ("fluid_*.ply", "cloth_*.ply")
INSTALLED = """
import importlib.metadata, json, sys
found = {}
for package in sys.argv[1:]:
    try:
        found[package] = importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        pass
print(json.dumps(found))
"""
COLUMNS = {
    "compile": "compile [s]",
    "load": "load [s]",
    "cost": "s a simulated second",
    "steps": "steps",
    "memory": "peak memory [MiB]",
}


@dataclass(frozen=True)
class Candidate:
    """A compiler, and the interpreter that has it."""

    module: str
    version: str
    python: Path

    @property
    def name(self) -> str:
        return f"{COMPILERS[self.module].package} {self.version}"


def candidates(interpreters: list[Path]) -> list[Candidate]:
    """All compilers that these have, each of a version once."""
    found: dict[str, Candidate] = {}
    for python in interpreters:
        packages = {compiler.package: compiler.module for compiler in COMPILERS.values()}
        told = subprocess.run([python, "-c", INSTALLED, *packages], check=True, capture_output=True, text=True).stdout
        for package, version in json.loads(told).items():
            one = Candidate(packages[package], version, python)
            found.setdefault(one.name, one)
    return list(found.values())


def run(candidate: Candidate, scene: Path, kernels: Path, out: Path, options: argparse.Namespace) -> dict[str, float]:
    """What the first frames of a scene cost; they are in `out`."""
    command = [candidate.python, "-m", "sim", "run", scene, "--out", out, "--quiet", "--arch", "cpu"]
    command += ["--frames", f"0:{options.frames}", "--quality", options.quality, "--threads", options.threads]
    given = os.environ | {
        "PYTHONPATH": str(ROOT),
        "TI_OFFLINE_CACHE_FILE_PATH": str(kernels),
        VARIABLE: candidate.module,
    }
    with tempfile.TemporaryFile() as heard:
        process = subprocess.Popen(list(map(str, command)), cwd=ROOT, env=given, stdout=heard, stderr=heard)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            heard.seek(0)
            sys.exit(f"{scene} by {candidate.name}: exit {process.returncode}\n{heard.read().decode()}")
    summary = json.loads((out / "summary.json").read_text())
    return {
        "compile": summary["wall_s"]["compile"],
        "cost": summary["wall_s"]["stepping"] / summary["simulated_s"],
        "steps": summary["counts"]["steps"],
        "memory": used.ru_maxrss * 1024 / MEBIBYTE,
    }


def turn(candidate: Candidate, scene: Path, out: Path, options: argparse.Namespace) -> dict[str, float]:
    """What a scene costs with kernels that are compiled, and then with those that are kept."""
    with tempfile.TemporaryDirectory() as name:
        first, second = (run(candidate, scene, Path(name) / "kernels", out, options) for _ in range(2))
    return second | {"compile": first["compile"], "load": second["compile"]}


def frames(out: Path) -> list[Path]:
    """Particles and cloth of all frames."""
    return sorted(path for pattern in FRAMES for path in out.glob(pattern))


def positions(path: Path) -> np.ndarray:
    """Of all particles in the order of their identity, or of all vertices [m]; shape [n, 3]."""
    points = read_points(path)
    if "id" in (points.dtype.names or ()):
        points = np.sort(points, order="id")
    return columns(points, "xyz")


def differences(one: Path, other: Path, last: int) -> Iterator[tuple[bool, float]]:
    """Whether each file is the same, and how far apart the positions in those of the last frame are [m]."""
    for path in frames(one):
        beside = other / path.name
        same = path.read_bytes() == beside.read_bytes()
        apart = 0.0
        if path.stem.endswith(f"_{last:05d}") and not same:
            here, there = positions(path), positions(beside)
            apart = float(np.abs(here - there).max()) if here.shape == there.shape else np.inf
        yield same, apart


def row(candidate: Candidate, told: list[dict[str, float]], agreement: str) -> str:
    """A line of the table: medians, and the range of what was measured."""
    cells = [candidate.name]
    for key in COLUMNS:
        values = [one[key] for one in told]
        spread = f" ({min(values):.3g} to {max(values):.3g})" if max(values) > min(values) else ""
        cells.append(f"{statistics.median(values):,.4g}{spread}")
    return f"| {' | '.join([*cells, agreement])} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("interpreters", nargs="+", type=Path)
    parser.add_argument("--scenes", nargs="+", type=Path, default=SCENES)
    parser.add_argument("--quality", default="draft")
    parser.add_argument("--frames", type=int, default=8)
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    found = candidates(options.interpreters)
    if not found:
        sys.exit("none of these interpreters has a compiler")
    for scene in options.scenes:
        with tempfile.TemporaryDirectory() as name:
            out = {one: Path(name) / one.module / one.version for one in found}
            told: dict[Candidate, list[dict[str, float]]] = {one: [] for one in found}
            for number in range(options.turns):
                for one in found[:: -1 if number % 2 else 1]:
                    told[one].append(turn(one, scene.resolve(), out[one], options))
            print(f"\n{scene.stem}, {options.quality}, frames 0 to {options.frames}, {options.threads} threads\n")
            print(f"| compiler | {' | '.join(COLUMNS.values())} | files that are the same | apart by [m] |")
            print("| --- " * (len(COLUMNS) + 3) + "|")
            for one in found:
                pairs = list(differences(out[found[0]], out[one], options.frames))
                agreement = f"{sum(same for same, _ in pairs)} of {len(pairs)} | {max(apart for _, apart in pairs):.2g}"
                print(row(one, told[one], agreement), flush=True)


if __name__ == "__main__":
    main()
