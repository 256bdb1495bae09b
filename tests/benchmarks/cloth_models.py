"""How far masses and springs, and a shell of finite elements, depend on the mesh, and what each costs.

    python tests/benchmarks/cloth_models.py

A strip of 1 m, clamped at one end, bends under its weight, w L^3 / B = 5, on meshes of six kinds: told of each are
the error of the drop of its end against the elastica, and the time that 30 steps to equilibrium take, without the first
call of each kernel. Then a disc of 30 cm drapes over a table of 18 cm (Cusick's drapemeter), on meshes of five kinds:
the share of the ring beyond the table that its shadow covers. Then scenes of the project at `draft` with either model:
seconds per simulated second, in turns.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from pathlib import Path

import numpy as np

from tests.support.cantilevers import cantilever
from tests.support.cloths import scene
from tests.support.stepping import advance
from tests.support.triangulations import MESHES, disc, write

ROOT = Path(__file__).parents[2]
MODELS = ("springs", "fem")
RADIUS, TABLE = 0.15, 0.09
"""Of the disc and of what it drapes over [m]."""
SCENES = ("drape", "flag", "fold")


def main() -> None:
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("--cells", type=int, nargs="+", default=[10, 20, 40], help="along the strip")
    asked.add_argument("--turns", type=int, default=3, help="of the scenes; 0 leaves them out")
    options = asked.parse_args()
    print("| mesh | cells | " + " | ".join(f"{model}: drop | seconds" for model in MODELS) + " |")
    print("| --- " * (2 + 2 * len(MODELS)) + "|")
    with tempfile.TemporaryDirectory() as folder:
        for model in MODELS:
            cantilever(MESHES[0], Path(folder), 5, 10, model=model)
        for kind in MESHES:
            for cells in options.cells:
                row = [kind, str(cells)]
                for model in MODELS:
                    begin = time.perf_counter()
                    drop, _ = cantilever(kind, Path(folder), 5, cells, model=model)
                    row += [f"{100 * (drop - 1):+.1f} %", f"{time.perf_counter() - begin:.2f}"]
                print("| " + " | ".join(row) + " |", flush=True)
        _drapes(Path(folder))
    if options.turns:
        _scenes(options.turns)


def _drapes(folder: Path) -> None:
    print("\n| mesh | " + " | ".join(MODELS) + " |\n| --- " + "| --- " * len(MODELS) + "|")
    for kind in MESHES[1:]:
        file = write(*disc(kind, RADIUS, 0.008), folder / "disc.ply")
        print(f"| {kind} | " + " | ".join(f"{_shadow(file, model):.3f}" for model in MODELS) + " |", flush=True)


def _shadow(file: Path, model: str) -> float:
    """After two seconds in thick air."""
    from PIL import Image, ImageDraw

    cloth = {"shape": {"type": "mesh", "file": str(file)}, "position": [0, 0.3035, 0], "stretch_stiffness": 800,
             "bend_stiffness": 1.5e-5, "thickness": 0.004}  # fmt: skip
    table = {"shape": {"type": "cylinder", "radius": TABLE, "height": 0.02}, "position": [0, 0.29, 0], "friction": 0.5}
    settings = {"model": model, "max_step": 0.008, "air": {"density": 20}}
    world = scene({"disc": cloth}, {"table": table}, cloth=settings)
    for step in range(1, 251):
        advance(world, 0.008, 0.008 * step)
    places, size, wide = world.cloth.vertices("disc")[0], 600, 1.1 * RADIUS
    seen = Image.new("1", (size, size))
    for corners in world.cloth.mesh.triangles:
        shadow = (places[corners][:, [0, 2]] / wide + 1) / 2 * size
        ImageDraw.Draw(seen).polygon([tuple(point) for point in shadow], fill=1)
    area = np.asarray(seen).sum() * (2 * wide / size) ** 2
    return (area - np.pi * TABLE**2) / (np.pi * (RADIUS**2 - TABLE**2))


def _scenes(turns: int) -> None:
    print("\n| scene | springs | fem | ratio |\n| --- | --- | --- | --- |")
    for name in SCENES:
        times: dict[str, list[float]] = {model: [] for model in MODELS}
        for _ in range(turns):
            for model in MODELS:
                times[model].append(_stepping(name, model))
        springs, fem = (statistics.median(times[model]) for model in MODELS)
        ratios = sorted(b / a for a, b in zip(times["springs"], times["fem"], strict=True))
        print(f"| {name} | {springs:.2f} | {fem:.2f} | {fem / springs:.2f} ({ratios[0]:.2f} to {ratios[-1]:.2f}) |")


def _stepping(name: str, model: str) -> float:
    """Seconds of all steps but the first, per simulated second."""
    import csv
    import subprocess
    import sys

    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "sim", "run", f"scenes/{name}.yaml", "--quality", "draft", "--threads", "1"]
        command += ["--set", f"cloth.model={model}", "--out", folder, "--quiet"]
        subprocess.run(command, cwd=ROOT, check=True)
        with (Path(folder) / "steps.csv").open() as file:
            rows = list(csv.DictReader(file))
    return sum(float(row["wall_s"]) for row in rows[1:]) / float(rows[-1]["time"])


if __name__ == "__main__":
    main()
