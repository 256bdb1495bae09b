"""How much water films show: volume of the surface over that of the particles, frame by frame, of runs that are there.

python tests/benchmarks/surface_volume.py --every 4 --plot volume.png dam_break=out/dam_break honey:draft=out/honey

Each argument is a scene, the quality that it was run at where that is another than its own, and the folder of the run
(`python -m sim run SCENE --quality QUALITY --out FOLDER`). Every frame is
reconstructed twice: as films are (`with`), and as they were without `surface.volume` and `surface.walls` (`without`).
Frames without fluid are left out.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import tidemill
from tidemill.interface import Scene

WITHOUT = {"surface.volume": False, "surface.walls": False}


def ratios(scene: Scene, folder: Path, every: int) -> np.ndarray:
    """Times [s] and the volume of the surface over that of the particles, shape [frames, 2]."""
    fluid = scene.simulation.fluid
    assert fluid is not None, f"{scene.name} has no fluid"
    found = []
    for frame in tidemill.frames(folder):
        if frame.number % every == 0 and len(frame.positions):
            water = len(frame.positions) * (2 * fluid.particle_radius) ** 3
            found.append((frame.time, tidemill.reconstruct(scene, frame).volume / water))
    return np.array(found)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", nargs="+", metavar="SCENE[:QUALITY]=FOLDER")
    parser.add_argument("--every", type=int, default=4, metavar="N", help="of the frames (default: 4)")
    parser.add_argument("--plot", type=Path, metavar="PNG", help="volume over time")
    options = parser.parse_args()
    fig, axes = plt.subplots(2, -(-len(options.runs) // 2), figsize=(12, 5), sharey=True, squeeze=False)
    for axis, run in zip(axes.flat, options.runs, strict=False):
        scene, folder = run.split("=", 1)
        name, _, quality = scene.partition(":")
        for settings, label, color in ((WITHOUT, "without", "0.6"), ({}, "with", "tab:blue")):
            curve = ratios(tidemill.load(name, quality=quality or None, settings=settings), Path(folder), options.every)
            print(f"{name:16} {label:8} {curve[:, 1].min():.3f} to {curve[:, 1].max():.3f}", flush=True)
            axis.plot(*curve.T, color=color, label=f"{label} surface.volume and surface.walls")
        axis.set_title(Path(name).stem)
        axis.axhspan(0.97, 1.03, color="tab:blue", alpha=0.1, lw=0)
        axis.set_xlabel("time / s")
    axes[0, 0].set_ylabel("volume of surface\nover that of particles")
    axes[1, 0].set_ylabel("volume of surface\nover that of particles")
    axes[0, 0].legend(fontsize=7)
    fig.tight_layout()
    if options.plot:
        fig.savefig(options.plot, dpi=90)


if __name__ == "__main__":
    main()
