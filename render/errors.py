"""What ends a rendering early, with the exit code it leads to."""

from __future__ import annotations


class RenderError(Exception):
    """Something failed while rendering."""

    exit_code = 1


class Unusable(RenderError):
    """Settings, files or a machine that cannot be rendered with as they are."""

    exit_code = 2
