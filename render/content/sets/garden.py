"""A terrace of slabs, and grass around it, no blade of which is higher than the terrace."""

from __future__ import annotations

import math
import random
from types import SimpleNamespace
from typing import Any

from render.content.axes import Vector
from render.content.nodes import rgba
from render.content.sets.ground import add_plain, surface_of
from render.content.sets.site import Site, add_mesh, add_slab

MARGIN = 0.35
"""Of the terrace around the action, over the size of the action."""
STEP = 0.035
"""Height of the terrace above the soil, likewise."""
LAWN = 3.0
"""How far from the middle blades grow, likewise; farther off the soil alone is green."""
BLADES = 90_000
GREEN = SimpleNamespace(type="matte", color=(0.33, 0.38, 0.2))
DARK, LIGHT, DRY = (0.24, 0.3, 0.14), (0.45, 0.51, 0.27), (0.5, 0.47, 0.31)
"""Colours (sRGB) of grass in the shade of other blades, of blades in the sun, and of dry ones."""
BELOW = 0.85
"""How bright the soil is between blades, and beyond them, over grass: they shade one another."""


def build(site: Site) -> None:
    x, y, top = site.middle
    half, step = site.beside(MARGIN * site.size), STEP * site.size
    material = site.material("ground")
    site.lay(add_slab("ground", half, 1.5 * step, material, site.middle))
    soil = (x, y, top - step)
    add_plain(_green("soil", site, BELOW), soil, site.reach, site.known)
    corners, faces = _blades(half, step, max(LAWN * site.size, 1.2 * max(half)))
    add_mesh("grass", corners, faces, _green("grass", site, 1.0), soil)


def _green(name: str, site: Site, bright: float) -> Any:
    """Grass, in spots of lighter and darker green, and some that is dry."""
    material = site.material(name, GREEN)
    if site.known != "all":
        return material
    graph, output, _ = surface_of(material)
    place = graph.node("TexCoord").outputs["Object"]

    def spots(per_size: float, detail: float) -> Any:
        scale = per_size / site.size
        return graph.node("TexNoise", {"Vector": place, "Scale": scale, "Detail": detail}).outputs[0]

    color = graph.mix_colors(graph.ramp(spots(6.0, 4.0), 0.3, 0.7), rgba(DARK), rgba(LIGHT))
    color = graph.mix_colors(graph.ramp(spots(60.0, 2.0), 0.55, 0.75), color, rgba(DRY))
    color = graph.node("VectorMath", {0: color, 1: (bright,) * 3}, operation="MULTIPLY").outputs[0]
    leaf = graph.node("BsdfDiffuse", {"Color": color}).outputs[0]
    backlit = graph.node("BsdfTranslucent", {"Color": color}).outputs[0]
    graph.feed(output, "Surface", graph.mix(0.3, leaf, backlit))
    return material


def _blades(half: tuple[float, float], height: float, far: float) -> tuple[list[Vector], list[tuple[int, ...]]]:
    """A triangle a blade, outside of the terrace, the denser the nearer: as many at each distance from the middle."""
    chance = random.Random(0)
    near = min(half)
    corners: list[Vector] = []
    while len(corners) < 3 * BLADES:
        distance, around = chance.uniform(near, far), chance.uniform(0, 2 * math.pi)
        x, y = distance * math.cos(around), distance * math.sin(around)
        if abs(x) < half[0] and abs(y) < half[1]:
            continue
        turn, lean = chance.uniform(0, 2 * math.pi), chance.gauss(0, 0.35)
        tall = height * chance.uniform(0.5, 0.98)
        wide = 0.12 * height * (0.6 + distance / far)
        dx, dy = wide * math.cos(turn), wide * math.sin(turn)
        corners += [
            (x - dx, y - dy, 0.0),
            (x + dx, y + dy, 0.0),
            (x - lean * tall * math.sin(turn), y + lean * tall * math.cos(turn), tall),
        ]
    return corners, [(k, k + 1, k + 2) for k in range(0, len(corners), 3)]
