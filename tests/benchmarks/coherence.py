"""How still water is that rests, and how much of it there is: coherence of a film's frames, volume of its surface.

python tests/benchmarks/coherence.py renders/bunny --region 0.1 0.6 0.9 1.0 --from 1.5
python tests/benchmarks/coherence.py --volume 0.044 results/bunny/standard

Of the brightness (BT.709 luma, 0 to 255) in a region of the pictures, given in shares of their width and height (left,
top, right, bottom, from the upper left corner): the root mean square of what changes from frame to frame and of the
second differences, over the first 1.73 (the root of 3) where frames are independent, as in noise, and less the more one
leads to the next; the contrast within a frame, its standard deviation; and the median change over that.

With --volume, of each frame the volume of the surface over that of its particles.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np
from PIL import Image

LUMA = np.array([0.2126, 0.7152, 0.0722])


def brightness(folder: Path, region: list[float], first: int) -> np.ndarray:
    """Of the region in all frames from the first on, shape [frames, height, width]."""
    found = []
    for path in sorted((folder / "frames").glob("*.png"))[first:]:
        with Image.open(path) as picture:
            width, height = picture.size
            box = [round(share * size) for share, size in zip(region, (width, height) * 2, strict=True)]
            found.append(np.asarray(picture.convert("RGB").crop(box)) @ LUMA)
    return np.array(found)


def coherence(frames: np.ndarray) -> dict[str, float]:
    first, second = np.diff(frames, axis=0), np.diff(frames, n=2, axis=0)
    contrast = float(np.mean(frames.std(axis=(1, 2))))
    return {
        "change": _rms(first),
        "second over first": _rms(second) / _rms(first),
        "contrast": contrast,
        "median change over contrast": float(np.median(np.abs(first))) / contrast,
    }


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt((values**2).mean()))


def volumes(results: Path, spacing: float) -> list[float]:
    """Of the surface over that of the particles, which hold spacing^3 each, in frames with water."""
    told = [json.loads(path.read_text()) for path in sorted(results.glob("surface/*/summary.json"))]
    frames = sorted((frame for one in told for frame in one["frames"]), key=lambda frame: frame["frame"])
    return [frame["volume"] / (frame["particles"] * spacing**3) for frame in frames if frame["particles"]]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="of a film, or with --volume of its results at one quality")
    parser.add_argument("--region", type=float, nargs=4, default=[0.0, 0.0, 1.0, 1.0], metavar="SHARE")
    parser.add_argument("--from", type=float, default=0.0, dest="begin", metavar="TIME", help="[s] (default: 0)")
    parser.add_argument("--volume", type=float, metavar="SPACING", help="of the particles [m]")
    options = parser.parse_args()
    if options.volume:
        ratios = volumes(options.folder, options.volume)
        print(" ".join(f"{ratio:.3f}" for ratio in ratios))
        print(f"{min(ratios):.3f} to {max(ratios):.3f}")
        return
    fps = json.loads((options.folder / "summary.json").read_text())["fps"]
    frames = brightness(options.folder, options.region, round(options.begin * fps))
    print(", ".join(f"{name} {value:.3g}" for name, value in coherence(frames).items()), f"({len(frames)} frames)")


if __name__ == "__main__":
    main()
