"""A tiled basin with a stone rim. Where water stands in a container of which no wall is drawn, its walls are those."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

from render.content.sets.ground import add_plain, fade
from render.content.sets.site import Site
from render.content.sets.walls import WIDE, add_strip, seen_from_inside, sides
from render.inputs import Box

MARGIN = 0.6
"""Between the action and a wall, over the size of the action, where no container has one."""
DEPTH = 0.4
"""Of the basin, likewise."""
OVERLAP = 0.002
"""How far the walls reach into the water, likewise: they then meet without a film of air, which would mirror."""
RIM = 0.12
"""Width of the rim, likewise."""
ROUND = 0.15
"""Height of its edge over its width."""
STONE = SimpleNamespace(type="stone", color=(0.83, 0.80, 0.74), roughness=0.7, grain=None)
SLAB = 0.3
"""Edge of a slab of the deck, likewise."""


def build(site: Site) -> None:
    site.lay(add_plain(site.material("ground"), site.middle, site.reach, site.known))
    if site.known != "all":
        return  # a wall that is seen from behind, too, would hide the action
    half, depth = site.beside(MARGIN * site.size), DEPTH * site.size
    basin = site
    if site.basin is not None and _holds(site.basin, site.box, OVERLAP * site.size):
        basin = replace(site, box=site.basin, basin=None)
        half, depth = basin.beside(-OVERLAP * site.size), site.basin.high[2] - site.height
    width = RIM * site.size
    lip = ROUND * width
    for side in sides(half):
        wall = seen_from_inside(site.material("wall"), side, basin)
        site.lay(add_strip("wall", side, basin, [(0.0, 0.0), (0.0, depth)], wall))
        rim = seen_from_inside(site.material("rim", STONE), side, basin)
        edge = [(0.0, depth), (-lip, depth), (-lip, depth + lip), (width, depth + lip)]
        add_strip("rim", side, basin, edge, rim)
        deck = seen_from_inside(site.material("deck", _slabs(site.size)), side, basin)
        fade(deck, 1.5 * site.reach, WIDE * site.reach)
        add_strip("deck", side, basin, [(width, depth + 0.9 * lip), (WIDE * site.reach, depth + 0.9 * lip)], deck)


def _slabs(size: float) -> SimpleNamespace:
    """The look of the deck: slabs of sandstone, of tones that differ."""
    color, joint = (0.70, 0.62, 0.52), (0.42, 0.38, 0.33)
    return SimpleNamespace(type="tiles", color=color, joint=joint, roughness=0.8, edge=SLAB * size, tone_variation=0.5)


def _holds(basin: Box, action: Box, slack: float) -> bool:
    """Whether nothing reaches beyond the walls of a basin, up to a slack [m]: they would cut through it."""
    return all(
        basin.low[axis] - slack <= action.low[axis] and action.high[axis] <= basin.high[axis] + slack for axis in (0, 1)
    )
