"""How long scenes take to start here and in an earlier version, in turns: until their second frame is written.

python tests/benchmarks/start.py REVISION scenes/tiny/splash.yaml scenes/drape.yaml

In a turn each version runs twice with kernels kept in a folder of its own: empty at first, so that all are compiled,
and then full, so that they are loaded. A first run of each, which measures meshes, does not count. Each version goes
first every other time. Seconds are of the whole command, the start of Python included.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from tests.benchmarks.earlier import compare, parser, simulate  # noqa: E402

UNITS = {"compile": "s with nothing compiled before", "load": "s with all compiled before"}


def main() -> None:
    parse = parser(__doc__)
    parse.add_argument("scenes", nargs="+", type=Path)
    parse.add_argument("--turns", type=int, default=3)
    options = parse.parse_args()

    def measure(tree: Path, scene: Path) -> dict[str, float]:
        with tempfile.TemporaryDirectory() as name:
            kept = {"TI_OFFLINE_CACHE_FILE_PATH": f"{name}/kernels"}
            with mock.patch.dict("os.environ", kept):
                return {kind: simulate(tree, scene, Path(name) / kind, options, "--frames", "0:1") for kind in UNITS}

    compare(options, measure, UNITS)


if __name__ == "__main__":
    main()
