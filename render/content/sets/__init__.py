"""What a scene stands in, beyond bare ground: one file a set, and this registry.

A set is a function `build(site)` that puts its objects into the scene. It hides no part of the action: all of it is
below the ground's height, or behind the action, or of walls that are not seen from behind.
"""

from __future__ import annotations

from common.registry import load
from render.content.sets.site import Site

SETS = {
    "studio": "render.content.sets.studio:build",
    "table": "render.content.sets.table:build",
    "tiles": "render.content.sets.tiles:build",
    "pool": "render.content.sets.pool:build",
    "garden": "render.content.sets.garden:build",
}
"""By the name that they have in a scene."""


def add_set(name: str, site: Site) -> None:
    """Put up a set around a site."""
    load(SETS[name])(site)
