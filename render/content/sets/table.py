"""The top of a table, with its edge; the room behind is the background."""

from __future__ import annotations

from render.content.sets.site import Site, add_slab

MARGIN = 0.4
"""Around the action, over its size."""
THICKNESS = 0.05
"""Of the top, over the size of the action."""


def build(site: Site) -> None:
    material = site.material("ground")
    site.lay(add_slab("ground", site.beside(MARGIN * site.size), THICKNESS * site.size, material, site.middle))
