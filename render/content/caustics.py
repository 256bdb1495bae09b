"""Caustics: light that clear bodies focus, found by manifold walks from what it falls on.

Cycles goes from a receiver to a lamp through a few surfaces of casters, by their smooth normals. It does so for what is
seen directly, or through what is clear. Light that is thrown back by mirrors is not looked for.
"""

from __future__ import annotations

import math
from typing import Any

from render.blender.session import bpy
from render.content.framing import direction
from render.content.meshes import add_object, replace_mesh
from render.content.nodes import Caustics

CLEAR = frozenset({"BSDF_GLASS", "BSDF_REFRACTION"})
"""Nodes of the shaders that refract."""
SLACK = math.radians(0.05)
"""By how much the sun is taken for larger than it is: of rounding."""
OUTSIDE = 2e-4
"""How far a volume reaches beyond the surface that refracts, over the diagonal of the action's box."""


def past_the_sun(sun: Any) -> Caustics:
    """Of what lets the light of `lights.sun` straight through where no way is found: water, and walls of containers,
    of which a way may cross more than Cycles follows. What stands for itself has a shadow there."""
    return Caustics(direction(sun.azimuth, sun.elevation), math.cos(math.radians(sun.angle) / 2 + SLACK))


class CausticsOfLamps:
    """All lamps that there are send light through what is clear, onto all else; `size` of the action [m].

    Of a path that Cycles finds through a surface, it takes all that is beyond for within the volume that it leaves. So
    volumes are objects of their own, and end a little outside: there the path leaves them.
    """

    def __init__(self, size: float):
        self._volumes: list[tuple[Any, Any, Any]] = []
        for lamp in bpy.data.lights:
            lamp.cycles.is_caustics_light = True
        for thing in [thing for thing in bpy.data.objects if thing.type == "MESH"]:
            materials = [slot.material for slot in thing.material_slots if slot.material is not None]
            clear = any(node.type in CLEAR for material in materials for node in material.node_tree.nodes)
            thing.cycles.is_caustics_caster, thing.cycles.is_caustics_receiver = clear, not clear
            if clear:
                self._part(thing, materials[0], size)

    def _part(self, thing: Any, material: Any, size: float) -> None:
        """Make an object of a thing's volume, if it has one."""
        inside = material.copy()
        if not _cut(material, "Volume"):
            bpy.data.materials.remove(inside)
            return
        _cut(inside, "Surface")
        volume = add_object(f"{thing.name}_volume", bpy.data.meshes.new("volume"), inside)
        volume.parent = thing
        reach = volume.modifiers.new("outside", "DISPLACE")
        reach.strength, reach.mid_level = OUTSIDE * size, 0.0
        self._volumes.append((thing, volume, inside))

    def show(self) -> None:
        """Have volumes the shapes of their surfaces."""
        graph = bpy.context.evaluated_depsgraph_get()
        for thing, volume, inside in self._volumes:
            volume.hide_render = thing.hide_render
            replace_mesh(volume, bpy.data.meshes.new_from_object(thing.evaluated_get(graph), depsgraph=graph), inside)


def _cut(material: Any, name: str) -> bool:
    """Take from a material what is linked to an input of its output; returns whether anything was."""
    output = next(node for node in material.node_tree.nodes if node.type == "OUTPUT_MATERIAL")
    links = list(output.inputs[name].links)
    for link in links:
        material.node_tree.links.remove(link)
    return bool(links)
