"""A plane wall as jobs after the simulation get to know it."""

from __future__ import annotations

from sim.settings import Settings
from sim.units import Direction, Length


class Wall(Settings):
    """Nothing is where x . normal is below `offset`."""

    normal: Direction
    """Unit vector into the room."""
    offset: Length
