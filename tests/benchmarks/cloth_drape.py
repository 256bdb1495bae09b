"""A square of cloth falls on a ball: what each integrator costs and what it leaves undone, beside Blender's own cloth.

    python tests/benchmarks/cloth_drape.py --cells 100

All runs take turns, each in a process of its own. Told of each: seconds on the wall per simulated second (the median of
its turns), without the first call of each kernel, which loads or compiles it; how much of the weight is out of balance
at its end: m (v1 - v0) / h - m g - springs(x1) - contacts, by its root mean square over the points, for one more step
of the length h with which it steps; how far the cloth is in the ball; how far its threads are stretched, root mean
square and most; and how far its points are from those of the first in the table, root mean square.

Blender's springs are as stiff as ours along threads (its stiffness is a force per strain), do not damp and do not bend;
its contacts push apart what is nearer than the same thickness. "blender 5" takes 5 steps in a frame. "implicit_euler
loose" takes 120 steps a second, and leaves up to a third of the forces unbalanced; "implicit_euler rough", as Blender's
cloth, makes do with one linear solution or two a step. `--against` a checkout of an earlier version, that takes turns
too.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
SIZE, RADIUS, GAP = 1.0, 0.25, 0.01
MASS_PER_AREA, STRETCH_STIFFNESS = 0.2, 1000.0
LOOSE = {"max_step": 1 / 120, "implicit_euler": {"velocity_error": 0.3, "force_error": 0.3, "linear_error": 0.3}}
ROUGH = {"max_step": 1 / 120, "implicit_euler": {"velocity_error": 5, "force_error": 20, "linear_error": 0.3}}
OURS = {
    "implicit_euler": {"integrator": "implicit_euler"},
    "implicit_euler loose": {"integrator": "implicit_euler"} | LOOSE,
    "implicit_euler rough": {"integrator": "implicit_euler"} | ROUGH,
    "symplectic_euler": {"integrator": "symplectic_euler"},
    "xpbd": {"integrator": "xpbd"},
}


BEFORE = "before: "


@dataclass(frozen=True)
class Drape:
    """What a run came to; `points` [m], shape [n, 3], with the ball's middle at the origin."""

    wall: float
    points: np.ndarray
    imbalance: float = np.nan


def thickness(cells: int) -> float:
    return min(0.4 * SIZE / cells, 0.004)


def ours(name: str, cells: int, seconds: float, threads: int) -> Drape:
    from sim.device import compilation, runtime
    from sim.run.one_thread import POINTS
    from sim.run.reporting.counts import Counts
    from sim.run.world import World
    from sim.spec import SimulationSpec

    runtime.start(threads=threads, arch="cpu", serial=(cells + 1) ** 2 < POINTS)
    sheet = {"shape": {"type": "sheet", "size": [SIZE, SIZE]}, "spacing": SIZE / cells, "thickness": thickness(cells),
             "position": [0, RADIUS + GAP, 0], "mass_per_area": MASS_PER_AREA, "stretch_stiffness": STRETCH_STIFFNESS,
             "damping": 0, "bend_damping": 0, "bend_stiffness": 0}  # fmt: skip
    ball = {"shape": {"type": "sphere", "radius": RADIUS}, "friction": 0.3}
    spec = {"fps": 24, "rigid": {"bodies": {"ball": ball}}, "cloth": OURS[name] | {"sheets": {"sheet": sheet}}}
    world = World(SimulationSpec.model_validate(spec), Path())
    world.build(None, {}, Counts(), print, 0.0, going_on=False)
    dt = world.cloth.settings.max_step
    begun, compiled = time.perf_counter(), compilation.seconds()
    steps = round(seconds / dt)
    for step in range(1, steps + 1):
        world.advance(dt, step * dt)
    wall = time.perf_counter() - begun - (compilation.seconds() - compiled)
    return Drape(wall / seconds, world.cloth.vertices("sheet")[0], imbalance(world, dt, steps * dt))


def imbalance(world, dt: float, now: float) -> float:
    """Root mean square of what is out of balance in one more step, over that of the weights."""
    from sim.cloth.contact.applied_forces import pulls

    cloth = world.cloth
    mesh, h = cloth.mesh, dt
    if hasattr(cloth.integrator, "substeps"):
        h = dt / cloth.integrator.substeps(dt)
        cloth.integrator.substeps = lambda dt: 1
    before = mesh.points.velocity.to_numpy()[: mesh.count]
    cloth.advance(h, now + h)
    change = (mesh.points.velocity.to_numpy()[: mesh.count] - before) / h
    contacts, force = cloth.collisions.contacts, np.zeros((mesh.count, 3))
    if len(contacts.key):
        each = cloth.collisions.tables.contact_force.to_numpy()[: len(contacts.key)]
        for corner in range(4):
            rows = contacts.key[:, 1 + corner]
            own = (rows >= 0) & (rows < mesh.count)
            np.add.at(force, rows[own], contacts.weight[own, corner, None] * each[own])
    weight = mesh.mass[:, None] * np.array([0, -9.81, 0])
    left = mesh.mass[:, None] * change - weight - pulls(mesh) - force
    return float(np.sqrt((left**2).sum() / (weight**2).sum()))


def blender(cells: int, seconds: float, quality: int) -> Drape:
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=4, radius=RADIUS)
    with tempfile.TemporaryDirectory() as folder:
        case = {"cells": cells, "size": SIZE, "height": RADIUS + GAP, "seconds": seconds, "quality": quality,
                "mass_per_area": MASS_PER_AREA, "stretch_stiffness": STRETCH_STIFFNESS, "thickness": thickness(cells),
                "ball_points": ball.vertices.tolist(), "ball_triangles": ball.faces.tolist(),
                "out": f"{folder}/points.npy"}  # fmt: skip
        command = [sys.executable, str(Path(__file__).with_name("blender_cloth.py"))]
        done = subprocess.run(command, input=json.dumps(case), capture_output=True, text=True)
        if done.returncode:
            sys.exit(done.stderr)
        wall = float(next(line.split()[1] for line in done.stdout.splitlines() if line.startswith("wall ")))
        return Drape(wall, np.load(case["out"]))


def stretches(points: np.ndarray, cells: int) -> tuple[float, float]:
    """Of the threads, over their lengths at rest: root mean square of the strain, and the greatest."""
    grid = points.reshape(cells + 1, cells + 1, 3)
    lengths = [np.linalg.norm(np.diff(grid, axis=axis), axis=2).ravel() for axis in (0, 1)]
    strain = np.concatenate(lengths) / (SIZE / cells) - 1
    return float(np.sqrt((strain**2).mean())), float(strain.max())


def one(name: str, options: argparse.Namespace) -> None:
    if name.startswith("blender"):
        found = blender(options.cells, options.seconds, int(name.removeprefix("blender ")))
    else:
        found = ours(name, options.cells, options.seconds, options.threads)
    depth = max(RADIUS - float(np.linalg.norm(found.points, axis=1).min()), 0.0)
    mean, most = stretches(found.points, options.cells)
    np.save(options.points, found.points)
    print(json.dumps([found.wall, found.imbalance, depth, mean, most]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, default=100, help="of the cloth, along each side (default: 100)")
    parser.add_argument("--seconds", type=float, default=0.25, help="simulated time [s] (default: 0.25)")
    parser.add_argument("--turns", type=int, default=3, help="runs of each (default: 3)")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument(
        "--quality", type=int, nargs="*", default=[5, 10], help="Blender's steps a frame (default: 5 10)"
    )
    parser.add_argument("--integrators", nargs="*", choices=OURS, default=list(OURS))
    parser.add_argument("--against", metavar="CHECKOUT", help="of an earlier version")
    parser.add_argument("--one", help=argparse.SUPPRESS)
    parser.add_argument("--points", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        one(options.one, options)
        return
    names = [*options.integrators, *(f"blender {quality}" for quality in options.quality)]
    if options.against:
        names += [f"{BEFORE}{name}" for name in options.integrators]
    with tempfile.TemporaryDirectory() as folder:
        tell(names, options, Path(folder))


def tell(names: list[str], options: argparse.Namespace, folder: Path) -> None:
    """Run all in turns, and print a table; `folder` for where their points end."""
    found: dict[str, list[list[float]]] = {name: [] for name in names}
    for turn in range(options.turns):
        for number, name in list(enumerate(names))[:: 1 if turn % 2 == 0 else -1]:
            root = options.against if name.startswith(BEFORE) else ROOT
            command = [sys.executable, __file__, "--one", name.removeprefix(BEFORE), "--cells", str(options.cells)]
            command += ["--seconds", str(options.seconds), "--threads", str(options.threads)]
            command += ["--points", str(folder / f"{number}.npy")]
            environment = os.environ | {"PYTHONPATH": str(root)}
            done = subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True)
            if done.returncode:
                sys.exit(f"{name}: exit status {done.returncode}\n{done.stderr}")
            found[name].append(json.loads(done.stdout.splitlines()[-1]))
            print(f"{name}, turn {turn + 1}: {found[name][-1][0]:.1f} s a simulated second", file=sys.stderr)
    print(
        "| integrator | wall [s] per simulated second | out of balance | depth in the ball [mm] | strain, RMS | most "
        "| from the first, RMS [mm] |"
    )
    print("| --- | --- | --- | --- | --- | --- | --- |")
    first = np.load(folder / "0.npy")
    for number, name in enumerate(names):
        wall, out, depth, mean, most = (statistics.median(values) for values in zip(*found[name], strict=True))
        left = "" if np.isnan(out) else f"{out:.2g}"
        away = np.sqrt(((np.load(folder / f"{number}.npy") - first) ** 2).sum(axis=1).mean())
        strains = f"{100 * mean:.2f} % | {100 * most:.1f} %"
        print(f"| {name} | {wall:.1f} | {left} | {1e3 * depth:.2f} | {strains} | {1e3 * away:.1f} |")


if __name__ == "__main__":
    main()
