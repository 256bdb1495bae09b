"""Whether scenes give the same results here and in an earlier version, to the byte.

python tests/benchmarks/same_bytes.py REVISION [scenes/tiny/splash.yaml ...]

Without scenes it takes those of scenes/tiny, and of each the first --frames. The earlier version is checked out beside
this one, and runs with the same packages. Compared are particles, meshes and tables, and the arrays of states; what
tells how long something took is left out. Exit 1 where something differs.

LLVM chooses in which order sums of fluids are added, and chooses another where a kernel is written in another way. With
--exact-math both versions add in the order that is written: what then is the same was the same but for that.
"""

from __future__ import annotations

import argparse
import csv
import hashlib
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from tests.benchmarks.earlier import earlier, parser, simulate  # noqa: E402

EXACT = """
import runpy
from sim.device import summation
summation.AS_WRITTEN = ("sim.",)
runpy.run_module("sim", run_name="__main__", alter_sys=True)
"""
"""The program `sim`, which adds everywhere as written."""
LEFT_OUT = {"summary.json"}
TIMES = "wall_s"


def results(tree: Path, scene: Path, options: argparse.Namespace) -> dict[str, str]:
    """Digests of what a scene gives by the sources in `tree`, by file, and by array of a state."""
    with tempfile.TemporaryDirectory() as name:
        out = Path(name)
        program = ["-c", EXACT] if options.exact_math else ["-m", "sim"]
        frames = ["--frames", f"0:{options.frames}"] if options.frames else []
        simulate(tree, scene, out, options, *frames, program=program)
        found = {}
        for path in sorted(out.iterdir()):
            if path.name not in LEFT_OUT:
                found |= {f"{path.name}{part}": digest(content) for part, content in contents(path)}
        return found


def contents(path: Path) -> list[tuple[str, bytes]]:
    """What counts in a file: name of the part, or nothing for the whole, and its bytes."""
    if path.suffix == ".npz":
        with np.load(path) as arrays:
            return [(f":{name}", arrays[name].tobytes()) for name in arrays.files if arrays[name].dtype.kind in "fiub"]
    if path.suffix == ".csv":
        with path.open(newline="") as file:
            rows = [{key: value for key, value in row.items() if key != TIMES} for row in csv.DictReader(file)]
        return [("", repr(rows).encode())]
    return [("", path.read_bytes())]


def digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def main() -> int:
    parse = parser(__doc__)
    parse.add_argument("scenes", nargs="*", type=Path, default=sorted((ROOT / "scenes" / "tiny").glob("*.yaml")))
    parse.add_argument("--frames", type=int, help="the last one (default: all)")
    parse.add_argument("--exact-math", action="store_true", help="add in the order in which sums are written")
    options = parse.parse_args()
    differing = 0
    with earlier(options.revision) as before:
        for scene in options.scenes:
            scene = scene.resolve().relative_to(ROOT)
            old, new = results(before, scene, options), results(ROOT, scene, options)
            wrong = sorted(key for key in old.keys() | new.keys() if old.get(key) != new.get(key))
            differing += bool(wrong)
            print(f"{scene}: {f'differs in {wrong}' if wrong else f'{len(new)} the same'}", flush=True)
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
