"""Settings of the formats that come with Tidemill."""

from __future__ import annotations

from typing import ClassVar

from workflow.formats.format import FormatSettings


class Animation(FormatSettings):
    """An animation for other programs: USD, Alembic, or a .blend; what is seen is in the scene's `render:`."""

    IMPLEMENTATION: ClassVar[str] = "workflow.formats.animation:write"
    SURFACE: ClassVar[bool] = True
