"""From the settings of a shape to a placed solid."""

from __future__ import annotations

import functools
import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from common.registry import load
from scene import assets
from scene.settings import Refused
from sim.geometry.analytic_solids import BoxSolid, CapsuleSolid, CylinderSolid, SphereSolid, TorusSolid
from sim.geometry.pose import Pose
from sim.geometry.solids import MeshSolid, PlaneSolid, SheetSolid, Solid, vertex_colors
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

if TYPE_CHECKING:
    import trimesh

    from sim.geometry.meshes.repair_report import RepairReport

__all__ = ["Solid", "load_mesh", "place", "tessellate"]

# Largest gap between a curved surface and its triangles, over its radius.
_CHORD_ERROR = 1e-3

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
    local_mesh = functools.partial(tessellate, shape)
    match shape:
        case Box():
            return BoxSolid(pose, local_mesh, shape.size)
        case Sphere():
            return SphereSolid(pose, local_mesh, shape.radius)
        case Cylinder():
            return CylinderSolid(pose, local_mesh, shape.radius, shape.height)
        case Capsule():
            return CapsuleSolid(pose, local_mesh, shape.radius, shape.height)
        case Torus():
            return TorusSolid(pose, local_mesh, shape.radius, shape.tube_radius)
        case Sheet():
            return SheetSolid(pose, local_mesh, shape.size)
    return MeshSolid(pose, local_mesh(), None)


def tessellate(shape, *, chord_error: float = _CHORD_ERROR) -> trimesh.Trimesh:
    """Triangles of a shape in its own frame [m]: watertight and outward, or an open rectangle for a sheet; of a shape
    that an installed package adds, what its implementation makes of it.

    All vertices lie on the surface; triangles are within about `chord_error` times the radius of it.
    """
    import trimesh

    match shape:
        case Box():
            return trimesh.creation.box(extents=shape.size)
        case Sheet():
            x, z = np.array(shape.size) / 2
            corners = [[-x, 0, -z], [-x, 0, z], [x, 0, z], [x, 0, -z]]
            return trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]], process=False)
        case Sphere():
            # The longest edge of an icosphere is 1.18 r / 2^n; the gap of a triangle edge^2 / (6 r).
            halvings = np.log2(1.18 / np.sqrt(6 * chord_error))
            return trimesh.creation.icosphere(subdivisions=max(0, int(np.ceil(halvings))), radius=shape.radius)
        case Cylinder():
            half = shape.height / 2
            profile = np.array([[0.0, -half], [shape.radius, -half], [shape.radius, half], [0.0, half]])
            return _revolved(profile, chord_error)
        case Capsule():
            angle = np.linspace(-np.pi / 2, np.pi / 2, 2 * _segments(np.pi / 2, chord_error) + 1)
            end = np.sign(angle) * shape.height / 2
            profile = shape.radius * np.column_stack([np.cos(angle), np.sin(angle)])
            profile[:, 1] += end
            equator = len(angle) // 2
            profile = np.insert(profile, equator, profile[equator], axis=0)
            profile[[equator, equator + 1], 1] = -shape.height / 2, shape.height / 2
            profile[[0, -1], 0] = 0.0
            return _revolved(profile, chord_error)
        case Torus():
            angle = np.linspace(0, 2 * np.pi, _segments(2 * np.pi, chord_error) + 1)[:-1]
            tube = shape.tube_radius * np.column_stack([np.cos(angle), np.sin(angle)])
            tube[:, 0] += shape.radius
            return _revolved(tube, chord_error, ring=True)
    return load(shape.IMPLEMENTATION)(shape)


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
    return trimesh.Trimesh(vertices, mesh.faces, vertex_colors=vertex_colors(mesh), process=False, validate=False)


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
    """The result, which is `mesh` moved, in the colours that the nearest vertices have in the file, if it has any."""
    colors = vertex_colors(file)
    if colors is not None:
        from scipy.spatial import cKDTree
        from trimesh.visual import ColorVisuals

        used = np.unique(file.faces)
        nearest = used[cKDTree(file.vertices[used]).query(mesh.vertices)[1]]
        result.visual = ColorVisuals(result, vertex_colors=colors[nearest])
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
        packages=("numpy", "scipy", "pymeshfix", "manifold3d"),
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
        packages=("numpy", "scipy", "pymeshfix", "manifold3d"),
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


def _segments(angle: float, chord_error: float) -> int:
    """Chords of an arc of `angle` [rad] whose gap is `chord_error` of the radius: r (1 - cos(angle / 2n))."""
    return max(3, int(np.ceil(angle / (2 * np.arccos(1 - chord_error)))))


def _revolved(profile: np.ndarray, chord_error: float, *, ring: bool = False) -> trimesh.Trimesh:
    """The closed surface swept by a profile of (radius, y), upward, about y; both ends on the axis, or a ring."""
    import trimesh

    number, sections = len(profile), _segments(2 * np.pi, chord_error)
    angle = np.arange(sections) * (2 * np.pi / sections)
    vertices = np.empty((sections, number, 3))
    vertices[..., 0] = profile[:, 0] * np.cos(angle)[:, None]
    vertices[..., 1] = profile[:, 1]
    vertices[..., 2] = profile[:, 0] * np.sin(angle)[:, None]
    index = np.arange(sections * number).reshape(sections, number)
    if not ring:
        # All sections share the two poles.
        index[:, [0, -1]] = index[0, [0, -1]]
    ahead = np.roll(index, -1, axis=0)
    above, above_ahead = (np.roll(part, -1, axis=1) for part in (index, ahead))
    quads = np.stack([index, above, above_ahead, ahead], axis=-1)[:, : None if ring else -1].reshape(-1, 4)
    faces = np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    proper = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    used, faces = np.unique(faces[proper], return_inverse=True)
    return trimesh.Trimesh(vertices.reshape(-1, 3)[used], faces.reshape(-1, 3), process=False)
