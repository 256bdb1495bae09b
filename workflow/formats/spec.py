"""Settings of the formats that come with Tidemill."""

from __future__ import annotations

from typing import ClassVar

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
