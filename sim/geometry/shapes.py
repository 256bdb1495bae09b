"""From the settings of a shape to a placed solid."""

from __future__ import annotations

import functools
import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from scene import assets
from scene.settings import Refused
from sim.geometry.analytic_solids import BoxSolid, CapsuleSolid, CylinderSolid, SphereSolid, TorusSolid
from sim.geometry.pose import Pose
from sim.geometry.solids import MeshSolid, PlaneSolid, SheetSolid, Solid
from sim.geometry.spec import (
    Box,
    Capsule,
    ClosedMesh,
    Cylinder,
    MeshFile,
    MeshSurface,
    Placement,
    Plane,
    Sheet,
    Sphere,
    Torus,
)
from sim.geometry.tessellation import tessellate
from sim.geometry.triangles import vertex_colors

if TYPE_CHECKING:
    import trimesh

    from sim.geometry.meshes.repair_report import RepairReport

__all__ = ["Solid", "load_mesh", "place"]

# Proper rotations that bring an axis of the file to y.
_TO_Y_UP = {
    "x": np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
    "y": np.eye(3),
    "z": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
}


def place(shape, placement: Placement, folder: Path) -> Solid:
    """The solid of any shape of `sim.geometry.spec`, scaled, turned and moved as `placement` says.

    `folder` is the scene's, from which mesh files are looked up. Raises `Refused`, located at `shape.file`, for a
    mesh that is missing or cannot be made a solid.
    """
    pose = Pose.of(placement)
    match shape:
        case Plane():
            return PlaneSolid(pose, shape.normal)
        case ClosedMesh():
            try:
                mesh, report = load_mesh(shape, assets.resolve(shape.file, folder))
            except Refused as refused:
                raise refused.at("shape", "file") from refused
            return MeshSolid(pose, mesh, report)
    triangles = functools.partial(tessellate, shape)
    match shape:
        case Box():
            return BoxSolid(pose, triangles, shape.size)
        case Sphere():
            return SphereSolid(pose, triangles, shape.radius)
        case Cylinder():
            return CylinderSolid(pose, triangles, shape.radius, shape.height)
        case Capsule():
            return CapsuleSolid(pose, triangles, shape.radius, shape.height)
        case Torus():
            return TorusSolid(pose, triangles, shape.radius, shape.tube_radius)
        case Sheet():
            return SheetSolid(pose, triangles, shape.size)
    return MeshSolid(pose, triangles().mesh(), None)


def load_mesh(shape: MeshSurface, path: Path, *, closed: bool = True) -> tuple[trimesh.Trimesh, RepairReport | None]:
    """The mesh of a file, y up, at its size [m] and with its anchor at the origin, and what was mended.

    With `closed` it is the shell of the shape's thickness, if it has one; else it is made watertight, or refused unless
    it already is where `repair` is off. Without, as for cloth, it is only cleaned of equal vertices and faces without
    area.

    Raises `Refused` for a file that cannot be read as triangles or whose mesh cannot be used.
    """
    from sim.geometry.meshes.formats import read
    from sim.geometry.meshes.topology import Topology, cleaned, signed_volume

    file, report = read(path), None
    thickness = shape.thickness if closed and isinstance(shape, MeshFile) else None
    if closed and shape.repair and thickness is None:
        mesh, report = _repaired(file, path.name, shape.close if isinstance(shape, ClosedMesh) else "holes")
    else:
        mesh, _ = cleaned(file, name=path.name)
    if closed and not shape.repair and thickness is None:
        topology = Topology.of(mesh)
        if not (topology.watertight and topology.consistent and signed_volume(mesh) > 0):
            raise Refused(
                f"mesh {path.name!r} is not a closed surface that faces outward ({topology.boundary_edges} open edges, "
                f"{topology.non_manifold_edges} non-manifold edges)",
                remedy="Set repair: true",
            )
    extent = float(np.ptp(mesh.vertices, axis=0).max())
    mesh = _scaled(mesh, shape, extent)
    if thickness is not None:
        mesh = _shell(mesh, thickness, path.name)
    return _painted(_anchored(mesh, shape.anchor), mesh, _scaled(file, shape, extent)), report


def _scaled(mesh: trimesh.Trimesh, shape: MeshSurface, extent: float) -> trimesh.Trimesh:
    """A mesh of a file, `extent` long, y up and at its size [m]."""
    import trimesh

    vertices = mesh.vertices @ _TO_Y_UP[shape.up].T
    if shape.size is not None:
        vertices = vertices * (shape.size / extent)
    scaled = trimesh.Trimesh(vertices, mesh.faces, vertex_colors=vertex_colors(mesh), process=False, validate=False)
    scaled.face_attributes.update(mesh.face_attributes)
    return scaled


def _anchored(mesh: trimesh.Trimesh, anchor: str) -> trimesh.Trimesh:
    import trimesh

    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    at = {
        "origin": np.zeros(3),
        "center": (low + high) / 2,
        "base": np.array([(low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2]),
    }[anchor]
    return trimesh.Trimesh(mesh.vertices - at, mesh.faces, process=False)


def _painted(result: trimesh.Trimesh, mesh: trimesh.Trimesh, file: trimesh.Trimesh) -> trimesh.Trimesh:
    """The result, which is `mesh` moved, in the colours that the nearest vertices have in the file, and with the
    texture and materials of its faces, if it has any."""
    colors = vertex_colors(file)
    if colors is not None:
        from scipy.spatial import cKDTree
        from trimesh.visual import ColorVisuals

        used = np.unique(file.faces)
        nearest = used[cKDTree(file.vertices[used]).query(mesh.vertices)[1]]
        result.visual = ColorVisuals(result, vertex_colors=colors[nearest])
    if file.face_attributes:
        from sim.geometry.meshes.texturing import of_faces

        result.face_attributes.update(of_faces(mesh, file))
    return result


def _repaired(mesh: trimesh.Trimesh, name: str, close: str) -> tuple[trimesh.Trimesh, RepairReport]:
    import trimesh

    from sim.geometry import cache
    from sim.geometry.meshes.repair import repair
    from sim.geometry.meshes.repair_report import RepairReport

    def compute() -> cache.Arrays:
        mended, report = repair(mesh, name=name, close=close)
        text = np.frombuffer(json.dumps(report.as_dict()).encode(), dtype=np.uint8)
        return {"vertices": np.asarray(mended.vertices), "faces": np.asarray(mended.faces), "report": text}

    stored = cache.cached(
        "repair",
        compute,
        arguments={"name": name, "close": close},
        arrays=[np.asarray(mesh.vertices), np.asarray(mesh.faces)],
        sources=_mending_sources(),
        packages=("libigl", "manifold3d", "numpy", "pymeshfix", "scipy"),
    )
    fields = json.loads(stored["report"].tobytes())
    fields["bounds"] = tuple(map(tuple, fields["bounds"]))
    return trimesh.Trimesh(stored["vertices"], stored["faces"], process=False), RepairReport(**fields)


def _shell(mesh: trimesh.Trimesh, thickness: float, name: str) -> trimesh.Trimesh:
    import trimesh

    from sim.geometry import cache
    from sim.geometry.meshes.shell import thickened
    from sim.geometry.meshes.topology import Topology, signed_volume
    from sim.geometry.meshes.union import united

    def compute() -> cache.Arrays:
        shell = thickened(mesh, thickness)
        topology = Topology.of(shell)
        least = 1e-9 * thickness * float(np.ptp(mesh.vertices, axis=0).max()) ** 2
        if not (topology.watertight and topology.consistent and least < signed_volume(shell) < np.inf):
            raise Refused(
                f"no shell can be made of mesh {name!r}: its faces have no area, or lie in one another",
                remedy="Delete such faces in a modelling program",
            )
        shell = united(shell)
        return {"vertices": np.asarray(shell.vertices), "faces": np.asarray(shell.faces)}

    stored = cache.cached(
        "shell",
        compute,
        arguments={"thickness": thickness},
        arrays=[np.asarray(mesh.vertices), np.asarray(mesh.faces)],
        sources=_mending_sources(),
        packages=("libigl", "manifold3d", "numpy", "pymeshfix", "scipy"),
    )
    return trimesh.Trimesh(stored["vertices"], stored["faces"], process=False)


def _mending_sources() -> list[str]:
    """The files on which a mended mesh depends."""
    from sim.geometry.distance import closest_points
    from sim.geometry.meshes import (
        changes,
        closing,
        nesting,
        openings,
        overlap,
        repair,
        repair_report,
        shell,
        topology,
        union,
        winding,
    )

    preparing = (changes, closing, closest_points, openings, overlap, nesting, topology, union, winding)
    return [str(module.__file__) for module in (*preparing, repair, repair_report, shell)]
