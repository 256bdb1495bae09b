"""Where the time of a picture goes, and how far it is from one with many samples, of a run that is there.

python tests/benchmarks/picture.py dam_break=out/dam_break --frame 20 --size 480 270 --reference 256

The argument is a scene and the folder of its run (`python -m sim run SCENE --out FOLDER`). One thread, seconds of the
processor: `surface` from particles to a mesh; `build`, the mesh and the scene within Blender; `prepare`, what Cycles
does before it traces light, the search tree of triangles first; `trace`; `denoise`; `write`. Each phase is a difference
of two renderings: of a picture of 16 by 16 pixels, or without denoising. The error is the mean of the absolute
differences of colours over their range, from a picture without denoising of the given number of samples.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from PIL import Image

import tidemill
from common.ply import write_surface
from render.blender.engine import configure
from render.blender.pictures import save_picture
from render.blender.session import bpy, release, silenced
from render.content.scene import Scene, plain
from render.inputs import Inputs
from workflow.stages.surface.mesh import Surface

WAYS: dict[str, dict[str, Any]] = {
    "8 samples, high": {"samples": 8},
    "8 samples, balanced": {"samples": 8, "denoise_quality": "balanced"},
    "8 samples, fast": {"samples": 8, "denoise_quality": "fast"},
    "4 samples, high": {"samples": 4},
    "4 samples, balanced": {"samples": 4, "denoise_quality": "balanced"},
    "4 samples, fast": {"samples": 4, "denoise_quality": "fast"},
    "16 samples, high": {"samples": 16},
}
TINY = {"resolution": (16, 16), "samples": 1, "denoise": False}


class Bench:
    """One frame of a run, with its surface in a folder."""

    def __init__(self, scene: str, run: Path, frame: int, size: tuple[int, int], folder: Path):
        self.scene = tidemill.load(scene, settings={"render.noise_threshold": 0, "render.resolution": list(size)})
        self.folder, self.frame = folder, frame
        self.surface: Path | None = None
        state = next(state for state in tidemill.frames(run) if state.number == frame)
        if state.fluid is not None:
            start = time.process_time()
            found: Surface = tidemill.reconstruct(self.scene, state)
            print(f"surface {time.process_time() - start:.2f} s, {len(found.triangles):,} triangles")
            write_surface(folder / f"surface_{frame:05d}.ply", **vars(found))
            self.surface = folder
        self.inputs = Inputs(run, self.surface, None)

    def picture(self, **changes: Any) -> tuple[dict[str, float], np.ndarray]:
        """Seconds of `build`, `render` and `write`, and the colours from 0 to 1."""
        settings = plain(self.scene.render.model_copy(update=changes).model_dump(mode="json"))
        out, seconds = self.folder / "picture.png", {}
        with silenced(self.folder / "log"):
            start = time.process_time()
            bpy.ops.wm.read_factory_settings(use_empty=True)
            configure(settings, 1, self.scene.simulation.fps)
            drawn = Scene(settings, self.inputs, self.scene.simulation.fps)
            poses = self.inputs.poses(range(self.frame, self.frame + 1))
            drawn.show(self.frame, poses[self.frame], drawn.read(self.frame))
            seconds["build"] = time.process_time() - start
            start = time.process_time()
            bpy.ops.render.render()
            seconds["render"] = time.process_time() - start
            start = time.process_time()
            save_picture(out)
            seconds["write"] = time.process_time() - start
            release()
        with Image.open(out) as picture:
            return seconds, np.asarray(picture.convert("RGB"), float) / 255


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", metavar="SCENE=FOLDER")
    parser.add_argument("--frame", type=int, required=True, metavar="N")
    parser.add_argument("--size", type=int, nargs=2, default=(480, 270), metavar="N", help="pixels (default: 480 270)")
    parser.add_argument("--reference", type=int, default=256, metavar="N", help="samples of the other (default: 256)")
    options = parser.parse_args()
    scene, run = options.run.split("=", 1)
    with TemporaryDirectory() as folder:
        bench = Bench(scene, Path(run), options.frame, tuple(options.size), Path(folder))
        prepare = min(bench.picture(**TINY)[0]["render"] for _ in range(3))
        _, right = bench.picture(samples=options.reference, denoise=False, seed=1)
        for name, way in WAYS.items():
            whole, found = bench.picture(**way)
            traced = bench.picture(**way, denoise=False)[0]["render"]
            parts = {
                "build": whole["build"],
                "prepare": prepare,
                "trace": traced - prepare,
                "denoise": whole["render"] - traced,
                "write": whole["write"],
            }
            told = ", ".join(f"{part} {seconds:.2f}" for part, seconds in parts.items())
            error = 100 * np.abs(found - right).mean()
            print(f"{name:20} {sum(parts.values()):6.2f} s: {told}; error {error:.2f} %", flush=True)


if __name__ == "__main__":
    main()
