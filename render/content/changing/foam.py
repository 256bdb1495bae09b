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

    def __init__(self, material: Any, meshes: bool, name: str = "foam"):
        self._name = name
        self._balls = _balls(material, meshes)
        self.thing = self.add(name, bpy.data.meshes.new(name))

    def show(self, source: TriangleMesh) -> None:
        """Have these points: x, y, z [m], radius [m] and vx, vy, vz [m/s], which Cycles takes for motion blur."""
        old = self.thing.data
        self.thing.data = build_points(self._name, source)
        self.thing.hide_render = source.vertex_count() == 0
        bpy.data.meshes.remove(old)

    def add(self, name: str, points: Any) -> Any:
        """Put another object into the scene that shows points as balls."""
        thing = bpy.data.objects.new(name, points)
        bpy.context.scene.collection.objects.link(thing)
        thing.modifiers.new("balls", "NODES").node_group = self._balls
        return thing


def build_points(name: str, source: TriangleMesh) -> Any:
    """A bpy mesh of points alone, z up, with the attributes `velocity` [m/s] and RADIUS [m]."""
    columns, mesh = source.columns, bpy.data.meshes.new(name)
    mesh.vertices.add(source.vertex_count())
    mesh.vertices.foreach_set("co", z_up_columns(columns["x"], columns["y"], columns["z"]))
    velocity = mesh.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
    velocity.data.foreach_set("vector", z_up_columns(columns["vx"], columns["vy"], columns["vz"]))
    mesh.attributes.new(RADIUS, "FLOAT", "POINT").data.foreach_set("value", columns["radius"])
    mesh.update()
    return mesh


def _balls(material: Any, meshes: bool) -> Any:
    """The geometry nodes that make a ball of every vertex; of `meshes`, each vertex has the velocity of its middle."""
    tree = bpy.data.node_groups.new("balls", "GeometryNodeTree")
    versions.pass_geometry(tree)
    start, end = (tree.nodes.new(name) for name in ("NodeGroupInput", "NodeGroupOutput"))
    points, dressed, radius = (
        tree.nodes.new(f"GeometryNode{name}") for name in ("MeshToPoints", "SetMaterial", "InputNamedAttribute")
    )
    radius.data_type = "FLOAT"
    radius.inputs["Name"].default_value = RADIUS
    dressed.inputs["Material"].default_value = material
    tree.links.new(start.outputs[0], points.inputs[0])
    balls, size = points, points.inputs["Radius"]
    if meshes:
        copies, balls, ball = (
            tree.nodes.new(f"GeometryNode{name}") for name in ("InstanceOnPoints", "RealizeInstances", "MeshIcoSphere")
        )
        ball.inputs["Radius"].default_value, ball.inputs["Subdivisions"].default_value = 1.0, ROUND
        tree.links.new(ball.outputs["Mesh"], copies.inputs["Instance"])
        tree.links.new(points.outputs[0], copies.inputs["Points"])
        tree.links.new(copies.outputs[0], balls.inputs["Geometry"])
        size = copies.inputs["Scale"]
    tree.links.new(versions.only_output(radius), size)
    tree.links.new(balls.outputs[0], dressed.inputs["Geometry"])
    tree.links.new(dressed.outputs[0], end.inputs[0])
    return tree
