"""One side of a wooden crate, as pictures of its colours (crate.jpg) and its relief (crate_relief.jpg).

Boards stand upright behind a frame and a brace from corner to corner. A height map says what lies above what; its
slopes give the relief, and its steps the dirt beside them.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
from PIL import Image
from scipy.ndimage import gaussian_filter

FOLDER = Path(__file__).parent
PIXELS = 256
BOARDS = 5
FRAME = 0.15
"""Width of the boards of the frame and of the brace, over the crate's."""
GAP = 0.012
"""Between two boards, likewise."""
LIGHT, DARK = np.array([214, 168, 112]), np.array([128, 84, 46])
"""Colours (sRGB) of the wood."""
RELIEF = 7.0
"""Steepness of the relief: pixels per unit of height."""


def grain(chance, along):
    """Streaks along axis `along`, from 0 to 1, shape [n, n]."""
    wide = [3 * PIXELS / 8, 3 * PIXELS / 8]
    wide[1 - along] = 1.3
    fine = gaussian_filter(chance.normal(size=(PIXELS, PIXELS)), wide, mode="wrap")
    wide[1 - along] = 7
    broad = gaussian_filter(chance.normal(size=(PIXELS, PIXELS)), wide, mode="wrap")
    streaks = fine / fine.std() + broad / broad.std()
    return np.clip(0.5 + streaks / 6, 0, 1)


def side():
    """Height, grain and tone of the boards at each pixel, shape [n, n] each; the first row is the top."""
    chance = np.random.default_rng(3)
    down, across = (np.indices((PIXELS, PIXELS)) + 0.5) / PIXELS
    upright, level = grain(chance, 0), grain(chance, 1)
    slot = across * BOARDS
    board = np.minimum(slot, BOARDS - 1e-9).astype(int)
    height = np.where(np.abs(slot - np.round(slot)) < GAP * BOARDS / 2, 0.0, 1.0)
    wood, tone = upright, chance.uniform(-0.12, 0.12, BOARDS)[board]

    def lay(where, streaks, shade):
        nonlocal height, wood, tone
        height = np.where(where, height.max() + 1.0, height)
        wood, tone = np.where(where, streaks, wood), np.where(where, shade, tone)

    lay(np.abs(across - (1 - down)) < FRAME / 2**0.5, (upright + level) / 2, -0.02)
    edge = np.minimum(across, 1 - across)
    lay(edge < FRAME, upright, 0.06)
    lay(np.minimum(down, 1 - down) < FRAME, level, 0.1)
    return height, wood, tone


def nails():
    """Where nail heads are, shape [n, n]."""
    down, across = (np.indices((PIXELS, PIXELS)) + 0.5) / PIXELS
    places = [(y, x) for y in (FRAME / 2, 1 - FRAME / 2) for x in np.linspace(FRAME / 2, 1 - FRAME / 2, 2 * BOARDS - 3)]
    return np.any([np.hypot(down - y, across - x) < 0.011 for y, x in places], axis=0)


def colours(height, wood, tone):
    """Shape [n, n, 3], sRGB."""
    low = gaussian_filter(height, 5) - gaussian_filter(height, 1)
    bright = wood + tone - 0.7 * np.clip(low, 0, None) - 0.7 * (height == 0)
    bright = np.where(nails(), -0.5, bright)
    return np.clip(DARK + (LIGHT - DARK) * bright[..., None], 18, 255)


def relief(height, wood):
    """Directions as colours, with green upwards, shape [n, n, 3]."""
    smooth = gaussian_filter(np.minimum(height, 4) + 0.25 * wood, 1.2)
    down, across = np.gradient(smooth)
    normal = np.stack([-RELIEF * across / 4, RELIEF * down / 4, np.ones_like(smooth)], axis=-1)
    return 127.5 + 127.5 * normal / np.linalg.norm(normal, axis=-1, keepdims=True)


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Paint a side of a crate, and write its colours and relief as JPEG.")
    parser.add_argument("--out", type=Path, default=FOLDER, metavar="FOLDER", help="default: beside the script")
    folder = parser.parse_args(arguments).out
    height, wood, tone = side()
    for name, picture in {"crate.jpg": colours(height, wood, tone), "crate_relief.jpg": relief(height, wood)}.items():
        Image.fromarray(picture.round().astype(np.uint8)).save(folder / name, quality=88)


if __name__ == "__main__":
    sys.exit(main())
