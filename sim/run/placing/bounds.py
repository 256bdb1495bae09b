"""The box around all that is placed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from sim.bodies.obstacles import Obstacles

if TYPE_CHECKING:
    from sim.cloth.model import PlacedSheet
    from sim.fluid.inflow.emitters import Outlet
    from sim.fluid.seeding.sources import Source


def action_bounds(sources: Sequence[Source | Outlet | PlacedSheet], obstacles: Obstacles) -> np.ndarray:
    """Box around all that is placed [m], shape [2, 3]: fluid, cloth, bodies, and containers as high as those."""
    boxes = [np.array(box) for box in obstacles.box_bounds()]
    inner = [np.asarray(source.bounds) for source in sources]
    inner += [item.bounds for item in obstacles.placed]
    inner = inner or boxes or [np.array([[-1.0, 0.0, -1.0], [1.0, 1.0, 1.0]])]
    top = max(box[1][1] for box in inner)
    for box in boxes:
        box[1][1] = min(box[1][1], max(top, box[0][1]))
    everything = np.array(inner + boxes)
    return np.array([everything[:, 0].min(axis=0), everything[:, 1].max(axis=0)])
