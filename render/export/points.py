"""What Blender's exporters write as points: point clouds in USD, and in Alembic only particles of the old kind."""

from __future__ import annotations

from array import array
from typing import Any, Protocol

from render.blender import versions
from render.blender.session import bpy
from render.content.axes import z_up_columns
from render.content.changing.foam import RADIUS
from render.content.ply import TriangleMesh
from render.export.clouds import Cloud

FOREVER = 1e5
"""Frames that particles live."""


class Points(Protocol):
    """What an exporter takes for points."""

    def bring(self, frame: int) -> None:
        """Read those of a frame, before Blender evaluates it."""

    def settle(self, graph: Any) -> None:
        """Put them in their places, after Blender has evaluated it."""


class PointClouds:
    """Points for USD: a point cloud that is made of a mesh, which is not in the scene itself."""

    def __init__(self, cloud: Cloud):
        self._cloud = cloud
        self._source = bpy.data.objects.new(f"{cloud.name} source", bpy.data.meshes.new(cloud.name))
        thing = bpy.data.objects.new(cloud.name, bpy.data.pointclouds.new(cloud.name))
        bpy.context.scene.collection.objects.link(thing)
        thing.modifiers.new("points", "NODES").node_group = _points_of(self._source)

    def bring(self, frame: int) -> None:
        """Read the points; one without size where there is none, since exporters go on with the last ones."""
        source = self._cloud.read(frame)
        if source.vertex_count() == 0:
            source = TriangleMesh({name: array("f", [0.0]) for name in source.columns}, source.triangles)
        old = self._source.data
        self._source.data = self._cloud.build(self._cloud.name, source)
        bpy.data.meshes.remove(old)

    def settle(self, graph: Any) -> None:
        """Nothing is left to do."""


def _points_of(source: Any) -> Any:
    """The geometry nodes that give a point cloud the vertices of another object, with their radius."""
    tree = bpy.data.node_groups.new("points", "GeometryNodeTree")
    versions.pass_geometry(tree)
    info, points, radius, bare, end = (
        tree.nodes.new(kind)
        for kind in (
            "GeometryNodeObjectInfo",
            "GeometryNodeMeshToPoints",
            "GeometryNodeInputNamedAttribute",
            "GeometryNodeRemoveAttribute",
            "NodeGroupOutput",
        )
    )
    info.inputs["Object"].default_value = source
    radius.data_type = "FLOAT"
    radius.inputs["Name"].default_value = bare.inputs["Name"].default_value = RADIUS
    tree.links.new(info.outputs["Geometry"], points.inputs[0])
    tree.links.new(versions.only_output(radius), points.inputs["Radius"])
    tree.links.new(points.outputs[0], bare.inputs["Geometry"])
    tree.links.new(bare.outputs[0], end.inputs[0])
    return tree


class Particles:
    """Points for Alembic: particles of Blender's old kind, which hang on a mesh of one vertex."""

    def __init__(self, cloud: Cloud):
        self._cloud = cloud
        # of the name of the particles, Blender's exporter would crash
        mesh = bpy.data.meshes.new(f"{cloud.name} source")
        mesh.vertices.add(1)
        self._thing = bpy.data.objects.new(cloud.name, mesh)
        bpy.context.scene.collection.objects.link(self._thing)
        self._thing.modifiers.new(cloud.name, "PARTICLE_SYSTEM")
        self._settings = self._thing.particle_systems[0].settings
        self._settings.emit_from, self._settings.physics_type = "VERT", "NO"
        self._settings.frame_start = self._settings.frame_end = -FOREVER / 2
        self._settings.lifetime = FOREVER

    def bring(self, frame: int) -> None:
        """Have as many particles as there are points."""
        self._source = self._cloud.read(frame)
        self._settings.count = self._source.vertex_count()

    def settle(self, graph: Any) -> None:
        """Put the particles in their places: the exporter takes the way from their last ones for velocity."""
        if self._source.vertex_count() == 0:
            return
        columns = self._source.columns
        particles = self._thing.evaluated_get(graph).particle_systems[0].particles
        place, velocity = (z_up_columns(*(columns[name] for name in names)) for names in ("xyz", ("vx", "vy", "vz")))
        particles.foreach_set("location", place)
        particles.foreach_set("prev_location", array("f", map(float.__sub__, map(float, place), map(float, velocity))))
        particles.foreach_set("size", array("f", (2 * float(radius) for radius in columns["radius"])))
