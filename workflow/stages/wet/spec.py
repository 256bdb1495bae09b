"""Typed settings of the job that finds what is wet."""

from __future__ import annotations

from typing import Annotated

from annotated_types import Gt
from pydantic import Field

from scene.settings import Settings
from scene.units import PositiveDuration, PositiveLength, Unit
from sim.bodies.wall import Wall


class WetJobSpec(Settings):
    """What `python -m workflow.wet --spec` takes."""

    drying_time: PositiveDuration
    """In which what is wet dries [s]."""
    particle_radius: PositiveLength
    """Of the fluid: half the spacing of its particles [m]."""
    fps: Annotated[float, Gt(0), Unit("Hz")]
    """Frames per simulated second."""
    walls: Annotated[tuple[Wall, ...], Field(default_factory=tuple)]
    """Planes; those that are level are floors."""
    vessels: Annotated[tuple[str, ...], Field(default_factory=tuple)]
    """Names of the containers that can be seen to be wet, by their files."""
