"""Settings of the formats that come with Tidemill."""

from __future__ import annotations

from typing import ClassVar

from scene.units import PositiveLength
from workflow.formats.format import FormatSettings


class Animation(FormatSettings):
    """An animation for other programs: USD, Alembic, glTF or a .blend; what is seen is in the scene's `render:`."""

    IMPLEMENTATION: ClassVar[str] = "workflow.formats.animation:write"
    surface: bool = True
    """The surface of the water; without it, none need have been made."""
    particles: bool = False
    """The particles of the fluid, as points."""

    def needs_surface(self) -> bool:
        """Whether the water's surface is in the file."""
        return self.surface


class Volume(FormatSettings):
    """OpenVDB, a file a frame: how full of fluid and foam space is, and how fast, how old and whence the fluid is."""

    IMPLEMENTATION: ClassVar[str] = "workflow.formats.animation:write_volumes"
    voxel: PositiveLength | None = None
    """Edge of a cell [m]; without it, the spacing of the particles."""
