"""A tiled room: level ground, and walls on all sides."""

from __future__ import annotations

import math

from render.content.sets.ground import add_plain
from render.content.sets.site import Site
from render.content.sets.walls import add_strip, seen_from_inside, sides
from render.looks.patterned import tiles

MARGIN = 0.45
"""Between the action and a wall, over the size of the action."""
HEIGHT = 3.0
"""Of the walls, likewise."""


def build(site: Site) -> None:
    site.lay(add_plain(site.material("ground"), site.middle, site.reach, site.known))
    if site.known != "all":
        return  # a wall that is seen from behind, too, would hide the action
    half = site.beside(MARGIN * site.size)
    if site.look.type == "tiles":
        edge = tiles.edge(site.look, site.size)
        half = (edge * math.ceil(half[0] / edge), edge * math.ceil(half[1] / edge))
    for side in sides(half):
        material = seen_from_inside(site.material("wall"), side, site)
        site.lay(add_strip("wall", side, site, [(0.0, 0.0), (0.0, HEIGHT * site.size)], material))
