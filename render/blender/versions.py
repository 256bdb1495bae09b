"""Where versions of Blender differ; all else in `render` is the same for each of them.

The package bpy is 4.5 for Python 3.11 and 5.2 for Python 3.13, and an installed Blender may be as old as 3.4. Where it
can be, this asks whether Blender has a thing, not for its number.
"""

from __future__ import annotations

import importlib
import math
import sys
from array import array
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

from render.blender.session import bpy

OLD_NAMES = {
    "Transmission Weight": "Transmission",
    "Coat Weight": "Clearcoat",
    "Coat Roughness": "Clearcoat Roughness",
    "Coat Normal": "Clearcoat Normal",
    "Subsurface Weight": "Subsurface",
    "Sheen Weight": "Sheen",
    "Specular IOR Level": "Specular",
    "Factor": "Fac",
}
"""Inputs of nodes, and what they were called before: those of the Principled BSDF until 3.6, the last until 4.5."""


def openvdb() -> Any:
    """Python's module of OpenVDB, which was called pyopenvdb until 4.3; None without it, or without its NumPy.

    The package bpy keeps it where only Blender's own Python would find it.
    """
    for name in ("openvdb", "pyopenvdb"):
        try:
            importlib.import_module("numpy")
            return importlib.import_module(name)
        except ImportError:
            pass
    for file in Path(bpy.utils.resource_path("LOCAL")).glob("python/lib/python*/site-packages/openvdb.*.so"):
        spec = spec_from_file_location("openvdb", file)
        if spec is not None and spec.loader is not None:
            module = module_from_spec(spec)
            spec.loader.exec_module(module)
            sys.modules["openvdb"] = module
            return module
    return None


def input_named(node: Any, name: str) -> Any:
    """A node's input by its present name, or by an old one that it has kept as identifier; None where it has none."""
    found = node.inputs.get(name) or node.inputs.get(OLD_NAMES.get(name, name))
    return found or next((socket for socket in node.inputs if socket.identifier == name), None)


def only_output(node: Any) -> Any:
    """What a node gives that has one output: Blender 3 keeps one of each type, and shows one."""
    return next(output for output in node.outputs if output.enabled)


def empty_nodes(owner: Any) -> Any:
    """The node tree of a new material or world, without nodes; since 5.0 there always is one."""
    if owner.node_tree is None:
        owner.use_nodes = True
    owner.node_tree.nodes.clear()
    return owner.node_tree


def pass_geometry(tree: Any) -> None:
    """Give a new tree of geometry nodes an input and an output of geometry; `interface` came with 4.0."""
    if hasattr(tree, "interface"):
        for direction in ("INPUT", "OUTPUT"):
            tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    else:
        tree.inputs.new("NodeSocketGeometry", "Geometry")
        tree.outputs.new("NodeSocketGeometry", "Geometry")


def known_options(operator: Any, options: dict[str, Any]) -> dict[str, Any]:
    """Of options of an operator, those that it has: USD with y up came with 4.2."""
    known = operator.get_rna_type().properties.keys()
    return {name: value for name, value in options.items() if name in known}


def absorb_evenly(material: Any) -> None:
    """Let light cross a volume that is the same everywhere in one step; since 5.0, Cycles sees that by itself."""
    if hasattr(material.cycles, "homogeneous_volume"):
        material.cycles.homogeneous_volume = True


def color_below_surface(tree: Any, shader: Any) -> None:
    """Let light that wanders below a surface take on its colour; until 3.6 it had one of its own."""
    below = shader.inputs.get("Subsurface Color")
    if below is not None:
        tree.links.new(shader.inputs["Base Color"].links[0].from_socket, below)


def count_corners(mesh: Any, faces: int) -> None:
    """Say of a new mesh that its faces are triangles; since 4.1 their first corners say so."""
    if bpy.app.version < (4, 1, 0):
        mesh.polygons.foreach_set("loop_total", array("i", [3]) * faces)


def set_uv(layer: Any, uv: Any) -> None:
    """Set all of a layer of places in images, flat; until 3.4 they had another name."""
    if hasattr(layer, "uv"):
        layer.uv.foreach_set("vector", uv)
    else:
        layer.data.foreach_set("uv", uv)


def show_edges(mesh: Any, angle: float) -> None:
    """Show an edge where smooth faces meet at more than an angle [rad]; until 4.0 the mesh had a setting for it."""
    if hasattr(mesh, "set_sharp_from_angle"):
        mesh.set_sharp_from_angle(angle=angle)
    else:
        mesh.use_auto_smooth = True
        mesh.auto_smooth_angle = angle


def keep_sharp_edges(mesh: Any) -> None:
    """Shade edges as sharp that are marked so; until 4.0 that was part of the setting of `show_edges`."""
    if not hasattr(mesh, "set_sharp_from_angle"):
        mesh.use_auto_smooth = True
        mesh.auto_smooth_angle = math.pi


def set_normals(mesh: Any, normals: Any) -> None:
    """Shade a mesh by one direction a vertex; until 4.0 that counted with the setting of `show_edges` alone."""
    if not hasattr(mesh, "set_sharp_from_angle"):
        mesh.use_auto_smooth = True
    mesh.normals_split_custom_set_from_vertices(normals)


def curves(thing: Any) -> Any:
    """The curves of a thing that has keyframes. Since 5.0 they are in its slot of the action, which it may share."""
    data = thing.animation_data
    if hasattr(data.action, "fcurves"):
        return data.action.fcurves
    return data.action.layers[0].strips[0].channelbag(data.action_slot).fcurves


def take_format(settings: Any, file_format: str, color_mode: str, color_depth: str) -> None:
    """Choose the format of pictures. Since 5.0 one with layers is another medium, and each layer a part of its file,
    unless they are to stand side by side as before: not all programs read parts."""
    layers = file_format == "OPEN_EXR_MULTILAYER"
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE" if layers else "IMAGE"
    settings.file_format = file_format
    if layers and hasattr(settings, "use_exr_interleave"):
        settings.use_exr_interleave = True
    settings.color_mode = color_mode
    settings.color_depth = color_depth


def denoise_on_gpu(cycles: Any) -> None:
    """Denoise where the picture was rendered; before 4.1, that was the CPU alone."""
    if hasattr(cycles, "denoising_use_gpu"):
        cycles.denoising_use_gpu = True


def denoise_with(cycles: Any, quality: str) -> None:
    """Take more or less time for denoising: `high`, `balanced` or `fast`; before 4.2, there is one network."""
    if hasattr(cycles, "denoising_quality"):
        cycles.denoising_quality = quality.upper()
        cycles.denoising_prefilter = "FAST" if quality == "fast" else "ACCURATE"
