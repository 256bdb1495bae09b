"""Foam, spray and bubbles: each particle a ball, which Cycles draws without a mesh, or, where the pass of motion is
wanted, with one: of points it takes the origin for where they were and will be."""

from __future__ import annotations

from typing import Any

from render.blender import versions
from render.blender.session import bpy
from render.content.axes import z_up_columns
from render.content.ply import TriangleMesh

ROUND = 2
"""Subdivisions of the icosahedron that stands for a ball: its faces are within 7 % of it."""
RADIUS = "foam_radius"
"""Name of the points' attribute; Blender keeps `radius` for itself."""


class Foam:
    """One object whose points change from frame to frame."""

    def __init__(self, material: Any, meshes: bool):
        self._thing = bpy.data.objects.new("foam", bpy.data.meshes.new("foam"))
        bpy.context.scene.collection.objects.link(self._thing)
        modifier = self._thing.modifiers.new("balls", "NODES")
        modifier.node_group = _meshes(material) if meshes else _balls(material)

    def show(self, source: TriangleMesh) -> None:
        """Have these points: x, y, z [m], radius [m] and vx, vy, vz [m/s], which Cycles takes for motion blur."""
        columns = source.columns
        old, mesh = self._thing.data, bpy.data.meshes.new("foam")
        mesh.vertices.add(source.vertex_count())
        mesh.vertices.foreach_set("co", z_up_columns(columns["x"], columns["y"], columns["z"]))
        velocity = mesh.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
        velocity.data.foreach_set("vector", z_up_columns(columns["vx"], columns["vy"], columns["vz"]))
        mesh.attributes.new(RADIUS, "FLOAT", "POINT").data.foreach_set("value", columns["radius"])
        mesh.update()
        self._thing.data = mesh
        self._thing.hide_render = source.vertex_count() == 0
        bpy.data.meshes.remove(old)


def _balls(material: Any) -> Any:
    """The geometry nodes that make a ball of every vertex."""
    tree = bpy.data.node_groups.new("balls", "GeometryNodeTree")
    versions.pass_geometry(tree)
    names = ("NodeGroupInput", "GeometryNodeMeshToPoints", "GeometryNodeSetMaterial", "NodeGroupOutput")
    start, points, dressed, end = (tree.nodes.new(name) for name in names)
    radius = tree.nodes.new("GeometryNodeInputNamedAttribute")
    radius.data_type = "FLOAT"
    radius.inputs["Name"].default_value = RADIUS
    dressed.inputs["Material"].default_value = material
    tree.links.new(versions.only_output(radius), points.inputs["Radius"])
    for source, target, key in ((start, points, 0), (points, dressed, "Geometry"), (dressed, end, 0)):
        tree.links.new(source.outputs[0], target.inputs[key])
    return tree


def _meshes(material: Any) -> Any:
    """The same with a mesh for each ball, whose vertices have the velocity of its middle."""
    tree = bpy.data.node_groups.new("meshes", "GeometryNodeTree")
    versions.pass_geometry(tree)
    names = ("MeshToPoints", "InstanceOnPoints", "RealizeInstances", "SetMaterial")
    start, end = (tree.nodes.new(name) for name in ("NodeGroupInput", "NodeGroupOutput"))
    points, copies, whole, dressed = (tree.nodes.new(f"GeometryNode{name}") for name in names)
    ball, radius = (tree.nodes.new(f"GeometryNode{name}") for name in ("MeshIcoSphere", "InputNamedAttribute"))
    ball.inputs["Radius"].default_value, ball.inputs["Subdivisions"].default_value = 1.0, ROUND
    radius.data_type = "FLOAT"
    radius.inputs["Name"].default_value = RADIUS
    dressed.inputs["Material"].default_value = material
    tree.links.new(versions.only_output(radius), copies.inputs["Scale"])
    tree.links.new(ball.outputs["Mesh"], copies.inputs["Instance"])
    for source, target, key in ((start, points, 0), (points, copies, "Points"), (copies, whole, "Geometry"),
                                (whole, dressed, "Geometry"), (dressed, end, 0)):  # fmt: skip
        tree.links.new(source.outputs[0], target.inputs[key])
    return tree
