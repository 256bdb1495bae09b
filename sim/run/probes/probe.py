"""What a probe is: settings, and a function that reads what they ask for."""

from __future__ import annotations

from typing import ClassVar

from scene.settings import Settings
from scene.units import Frequency

Row = tuple[str, float, str]
"""Quantity, value and unit."""


class ProbeSettings(Settings):
    """What every probe has, beside its `type`.

    A field `body` or `sheet` names one of the scene; with a field `mean` that is true, rows are means over time of what
    is read in every step.
    """

    IMPLEMENTATION: ClassVar[str]
    """`module:function`: called with the settings and a `sim.run.probes.view.View`, it yields Rows, always the same
    ones; none while there is nothing to measure."""
    MATERIAL: ClassVar[str | None] = None
    """Of fluid, cloth and rigid what it measures: refused in a scene without, and not read while there is none."""
    PRESSURES: ClassVar[bool] = False
    """Whether it asks for pressures of the last step beside solids, which are not always kept."""

    rate: Frequency | None = None
    """Rows per simulated second; without it, one a frame."""
