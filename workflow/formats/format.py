"""What a format is: settings, and a function that writes what was made of a scene."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from scene.settings import Settings

if TYPE_CHECKING:
    from common.frames import Frames
    from scene.load import Scene


class FormatSettings(Settings):
    """What every format has: given by --spec, nothing of it is a scene's."""

    IMPLEMENTATION: ClassVar[str]
    """`module:function`: called with the settings, a Made, and the path of the file to write; returns None, or the exit
    status where it failed and has said why. Raises Refused for what it cannot write."""
    SURFACE: ClassVar[bool] = False
    """Whether it needs the surface of the water: then what is only simulated is refused."""

    def needs_surface(self) -> bool:
        """SURFACE, unless it depends on the settings."""
        return self.SURFACE


@dataclass(frozen=True)
class Made:
    """What the stages have left of a scene: in one folder each, the files of all frames, and whole tables."""

    scene: Scene
    frames: Frames
    """Which are asked for."""
    simulation: Path
    """With `fluid_00042.ply`, `cloth_NAME_00042.ply`, `body_NAME.ply`, `bodies.csv` and the other tables."""
    surface: Path | None
    """With `surface_00042.ply`; None where there is none."""
    foam: Path | None = None
    """With `foam_00042.ply`; None where there is none."""
