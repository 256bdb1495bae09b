"""How far one picture is from another."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

from workflow.stages.film.contact_sheet import flat


def read(folder: Path) -> np.ndarray:
    """The one picture in a folder as it is displayed, on paper if it is transparent, 0 to 1; shape [height, width,
    3]."""
    path = next(iter(sorted(folder.glob("[0-9]*.png"))))
    with Image.open(path) as picture:
        return np.asarray(flat(picture), dtype=np.float64) / 255


def difference(picture: np.ndarray, truth: np.ndarray) -> float:
    """RMS over all pixels and colours, where the smaller picture is shown as large as the other (bicubic)."""
    height, width = truth.shape[:2]
    if picture.shape != truth.shape:
        whole = Image.fromarray(np.round(255 * picture).astype(np.uint8))
        picture = np.asarray(whole.resize((width, height), Image.Resampling.BICUBIC), dtype=np.float64) / 255
    return float(np.sqrt(np.mean((picture - truth) ** 2)))
