"""How fast films with bodies are beside SPlisHSPlasH: the duck that falls into a pool, and the bowl that is tipped.

Set-up of the peer, once, in an environment of its own:

    python3.11 -m venv peers && peers/bin/pip install pySPlisHSPlasH==2.19.0 trimesh scipy networkx rtree

    python tests/benchmarks/films_beside_peer.py --peer peers/bin/python --film duck

Where the peer's bundled GL library crashes, `--preload libGLdispatch.so.0` helps. Use a machine that is idle.

Ours are the scenes of the gallery, with the tolerances of the peer; it gets their meshes, where our bodies are led, and
the hull of our water. Compared is stepping alone, in turns, and what each comes to: where the middle of the water and
the body are at the end. Particles of both hold as much water. The peer's start looser, and the bowl holds fewer of them
(`splishsplash_films.py`), so particle-steps per second are told as well.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import trimesh

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from common.ply import read_mesh  # noqa: E402
from scene.load import load  # noqa: E402
from tests.benchmarks.dam_break import of_a_run, report  # noqa: E402
from tidemill.frame import Frame, frames  # noqa: E402

FILMS = {"duck": 1.0, "bowl": 2.0}
"""Seconds of each."""
TANK = 1.0
"""How high the peer's pool is [m]: nothing splashes out of it."""
TOLERANCES = ("fluid.dfsph.density_error=0.0005", "fluid.dfsph.divergence_error=0.001")
"""Those of the peer."""
DENSITY = {"duck": 250.0}
"""[kg/m^3]"""


def scene(film: str) -> Path:
    return ROOT / f"scenes/{film}.yaml"


def ours(film: str, seconds: float, radius: float | None, threads: int, out: Path) -> dict[str, float]:
    settings = [f"duration={seconds}", *TOLERANCES] + ([f"fluid.particle_radius={radius}"] if radius else [])
    options = [word for setting in settings for word in ("--set", setting)]
    command = [sys.executable, "-m", "sim", "run", scene(film), "--out", out, "--quiet", *options]
    command += ["--arch", "cpu", "--threads", threads]
    subprocess.run(list(map(str, command)), cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    return of_a_run(out)


def body(out: Path, name: str, seen: list[Frame]) -> dict:
    points, triangles = read_mesh(next(out.glob(f"*_{name}.ply")))
    states = [frame.bodies[name] for frame in seen]
    turns = np.roll([state.rotation for state in states], -1, axis=1)
    found = {
        "points": np.stack([points[axis] for axis in "xyz"], axis=1).tolist(),
        "triangles": triangles.tolist(),
        "position": states[0].position.tolist(),
        "rotation": turns[0].tolist(),
        "resolution": [60, 60, 60],
        "holds": name not in DENSITY,
    }
    if name in DENSITY:
        return found | {"density": DENSITY[name]}
    if np.ptp([state.position for state in states], axis=0).any():
        found["keys"] = {
            "times": [frame.time for frame in seen],
            "positions": [state.position.tolist() for state in states],
            "rotations": turns.tolist(),
            "velocities": [state.velocity.tolist() for state in states],
            "spins": [state.angular_velocity.tolist() for state in states],
        }
    return found


def pool(size: list[float]) -> dict:
    box = trimesh.creation.box(size)
    return {
        "points": box.vertices.tolist(),
        "triangles": box.faces.tolist(),
        "position": [0, size[1] / 2, 0],
        "resolution": [40, 40, 32],
        "hollow": True,
    }


def peer(options: argparse.Namespace, out: Path) -> dict:
    seen = list(frames(out))
    bodies = [body(out, name, seen) for name in seen[0].bodies if next(out.glob(f"*_{name}.ply"), None)]
    case = {
        "seconds": options.seconds,
        "spacing": 2 * (options.radius or load(scene(options.film)).simulation.fluid.particle_radius),
        "water": seen[0].positions.tolist(),
        "bodies": [*bodies, pool([1.0, TANK, 0.8])] if options.film == "duck" else bodies,
    }
    environment = dict(os.environ, OMP_NUM_THREADS=str(options.threads))
    if options.preload:
        environment["LD_PRELOAD"] = options.preload
    command = [options.peer, Path(__file__).with_name("splishsplash_films.py")]
    done = subprocess.run(command, env=environment, input=json.dumps(case), capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"the peer ended with {done.returncode}\n{done.stdout[-2000:]}{done.stderr}")
    return json.loads(
        next(line for line in done.stdout.splitlines() if line.startswith("RESULT")).removeprefix("RESULT")
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--peer", type=Path, required=True, help="Python of the peer's environment")
    parser.add_argument("--preload", metavar="LIBRARY", help="library to load before the peer's own")
    parser.add_argument("--film", choices=FILMS, required=True)
    parser.add_argument("--radius", type=float, help="of particles [m] (default: that of the scene)")
    parser.add_argument("--seconds", type=float, help="simulated time [s] (default: 1 for the duck, 2 for the bowl)")
    parser.add_argument("--repeats", type=int, default=2, help="runs of each, in turns (default: 2)")
    parser.add_argument("--threads", type=int, default=2, help="for both (default: 2)")
    options = parser.parse_args()
    options.seconds = options.seconds or FILMS[options.film]

    own, theirs = [], []
    for turn in range(options.repeats):
        with tempfile.TemporaryDirectory() as name:
            out = Path(name)
            own.append(ours(options.film, options.seconds, options.radius, options.threads, out))
            theirs.append(peer(options, out))
            if turn == 0:
                last = list(frames(out))[-1]
                print("ours at the end: the middle of the water at", last.positions.mean(axis=0).round(4).tolist())
                print({name: state.position.round(4).tolist() for name, state in last.bodies.items()})
                print("the peer's:", np.round(theirs[0].pop("middle"), 4).tolist())
                print(np.round(theirs[0].pop("places"), 4).tolist())
    mine = report("Tidemill dfsph", own)
    other = report("SPlisHSPlasH dfsph, volume-map", [{key: run[key] for key in own[0]} for run in theirs])
    longer, faster = other["wall"] / mine["wall"], mine["rate"] / other["rate"]
    print(f"the peer takes {longer:.2f} times as long; we do {faster:.2f} times its particle-steps per second")


if __name__ == "__main__":
    main()
