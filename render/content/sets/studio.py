"""A sweep: the floor rises to a wall without an edge, on all sides, so that a camera may go round the action."""

from __future__ import annotations

import math

from render.content.sets.site import Site, add_mesh

NEAREST = 2.0
"""Radius of the floor over the size of the action, at least."""
CLEAR = 1.1
"""Radius over the distance of the farthest camera, at least: cameras stand inside."""
BEND = 0.5
"""Radius of the bend over that of the floor."""
WALL = 1.0
"""Height over the radius of the floor."""
AROUND, BENT = 96, 16
"""Faces of a circle, and of the bend."""


def build(site: Site) -> None:
    floor = max(NEAREST * site.size, CLEAR * site.reach)
    bend = BEND * floor
    angles = [math.pi / 2 * k / BENT for k in range(BENT + 1)]
    profile = [(floor + bend * math.sin(a), bend * (1 - math.cos(a))) for a in angles]
    profile.append((floor + bend, max(WALL * floor, 1.5 * bend)))
    turns = [2 * math.pi * k / AROUND for k in range(AROUND)]
    corners = [(r * math.cos(t), r * math.sin(t), z) for r, z in profile for t in turns]
    rings = [(ring * AROUND, ring * AROUND + AROUND) for ring in range(len(profile) - 1)]
    faces: list[tuple[int, ...]] = [tuple(range(AROUND))]
    for low, high in rings:
        faces += [(low + k, low + (k + 1) % AROUND, high + (k + 1) % AROUND, high + k) for k in range(AROUND)]
    faces = [face[::-1] for face in faces[1:]] + faces[:1]
    material = site.material("ground")
    site.lay(add_mesh("ground", corners, faces, material, site.middle, smooth=True))
