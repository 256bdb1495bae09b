"""Volume of the fluid."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sim.run.probes.probe import Row
from sim.run.probes.spec import Volume
from sim.run.probes.view import View

MATERIALS = ("fluid",)


def read(probe: Volume, view: View) -> Iterator[Row]:
    """Sum of m / rho [m^3]; a density below rest, as at the free surface, is the kernel's lack, not the fluid's."""
    fluid = view.fluid
    yield "volume", float((fluid.mass / np.maximum(fluid.density, fluid.spec.rest_density)).sum()), "m^3"
