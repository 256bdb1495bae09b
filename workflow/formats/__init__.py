"""Kinds of files that `workflow.export` writes of a film that was made: one file each, and this registry."""

from __future__ import annotations

from common.registry import added
from workflow.formats.format import FormatSettings
from workflow.formats.spec import Animation, Volume

FORMATS: dict[str, type[FormatSettings]] = {
    **dict.fromkeys(("usd", "usda", "usdc", "abc", "glb", "blend"), Animation),
    "vdb": Volume,
}
"""By the end of the names of their files, beside those of installed packages."""


def formats() -> dict[str, type[FormatSettings]]:
    """The settings of all formats, by the end of the names of their files."""
    return FORMATS | added("formats", *FORMATS)
