"""Points that stages read from the folders of earlier ones."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from common.ply import BadPly, columns, read_points
from scene.settings import Refused

REMEDY = "delete it, and make this frame again"


def read(folders: Sequence[Path], name: str, finite: Sequence[str], others: Sequence[str] = ()) -> np.ndarray:
    """The records of a file in the first of the folders that has it, shape [n]. Raises Refused unless it has these
    columns, and numbers in the first of them are finite."""
    path = next((folder / name for folder in folders if (folder / name).exists()), None)
    if path is None:
        raise Refused(f"{name} is in none of {', '.join(map(str, folders))}", remedy="make the frames before it first")
    try:
        points = read_points(path)
        numbers = columns(points, finite)
        columns(points[:0], others)
    except BadPly as error:
        raise Refused(str(error), remedy=REMEDY) from None
    if not np.isfinite(numbers).all():
        raise Refused(f"{path} holds numbers that are not finite", remedy=REMEDY)
    return points
