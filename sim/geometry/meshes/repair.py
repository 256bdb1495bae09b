"""Watertight, outward-facing triangle meshes from whatever a file holds."""

from __future__ import annotations

import functools
import hashlib
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import trimesh

from scene.settings import Refused
from sim.geometry.meshes.closing import closed_pieces, with_lids
from sim.geometry.meshes.openings import mouths, within
from sim.geometry.meshes.topology import (
    Topology,
    cleaned,
    components,
    flipped,
    joined,
    signed_volume,
    surface_area,
)
from sim.geometry.meshes.union import united

# A closed piece below this share of the largest piece's volume is debris of the scan.
_NEGLIGIBLE_VOLUME = 1e-5
# A repair that adds or takes away more than this share of the surface has not understood the mesh.
_MOST_CHANGED = 0.05
# A solid thinner than this share of (area)^(3/2) is a double-sided sheet: its volume is rounding.
_FLAT = 1e-7


@dataclass(frozen=True)
class RepairReport:
    """What a mesh was, and what repair made of it. Lengths in the mesh's own unit."""

    name: str
    vertices_before: int
    vertices_after: int
    faces_before: int
    faces_after: int
    components_before: int
    components_after: int
    holes: int
    """Openings of the kept pieces: connected groups of edges with one face."""
    boundary_edges: int
    """Edges with one face."""
    non_manifold_edges: int
    """Edges with three faces or more."""
    degenerate_faces: int
    """Faces without area, or that repeat another."""
    seams: int
    """Vertices joined with others that are almost where they are."""
    self_intersecting_faces: int
    """Faces that still cut through others afterwards."""
    inconsistent_winding: bool
    """Whether neighbouring faces disagreed on which side is out."""
    inverted_components: int
    """Pieces that were inside out and were turned."""
    components_dropped: int
    faces_dropped: int
    """Faces of the dropped pieces."""
    area_dropped: float
    """Share of the area that the dropped pieces had."""
    cavities: int
    """Kept pieces that are hollows inside another."""
    pieces_united: int
    """Pieces that made one surface because they overlap, or one that cut through itself; 0 where none did."""
    watertight_before: bool
    watertight: bool
    volume_before: float | None
    """None where the mesh was open."""
    volume: float
    area_before: float
    area: float
    bounds: tuple[tuple[float, float, float], tuple[float, float, float]]

    @property
    def changed(self) -> bool:
        """Whether there was anything to mend, or the mesh was not watertight before."""
        return bool(
            self.holes
            or self.non_manifold_edges
            or self.degenerate_faces
            or self.seams
            or self.inconsistent_winding
            or self.inverted_components
            or self.components_dropped
            or self.pieces_united
            or not self.watertight_before
        )

    def as_dict(self) -> dict:
        """The fields, ready for JSON."""
        return asdict(self)

    def lines(self) -> list[str]:
        """Short sentences for the log; none for a mesh that was sound."""
        said = []

        def say(count: int, text: str, *, one: str = "", many: str = "s") -> None:
            if count:
                said.append(text.format(n=count, s=one if count == 1 else many))

        say(self.degenerate_faces, "removed {n} degenerate or repeated face{s}")
        say(self.seams, "joined {n} vert{s} across seams", one="ex", many="ices")
        say(self.non_manifold_edges, "removed {n} non-manifold edge{s}")
        say(self.holes, "closed {n} hole{s}")
        if self.inconsistent_winding:
            said.append("turned faces that disagreed with their neighbours")
        say(self.inverted_components, "turned {n} piece{s} inside out")
        if self.components_dropped:
            said.append(
                f"dropped {self.components_dropped} of {self.components_before} separate pieces, which enclose no "
                f"volume of their own: {self.faces_dropped} of {self.faces_before} faces, "
                f"{100 * self.area_dropped:.2g} % of the area"
            )
        say(self.cavities, "kept {n} cavit{s}", one="y", many="ies")
        if self.pieces_united == 1:
            said.append("cut the surface where it goes through itself, and kept what is outside")
        elif self.pieces_united:
            said.append(f"united {self.pieces_united} pieces, which overlap")
        if self.changed and self.area_before > 0 and abs(self.area / self.area_before - 1) > 0.01:
            said.append(f"the area changed by {100 * (self.area / self.area_before - 1):+.1f} %")
        say(self.self_intersecting_faces, "{n} face{s} still cut through others")
        if said:
            said.append(
                f"{self.faces_before} faces became {self.faces_after}, in {self.components_after} closed "
                f"piece{'s' if self.components_after != 1 else ''} of volume {self.volume:.6g}"
            )
        return said


def repair(mesh: trimesh.Trimesh, *, name: str, close: str = "holes") -> tuple[trimesh.Trimesh, RepairReport]:
    """A watertight mesh with outward faces, and what had to be done.

    A mesh that is closed already keeps its faces; pieces that are inside out are turned. An open one is cut
    into its edge-connected pieces, each is closed by MeshFix (Attene 2010), and every piece that encloses a volume is
    kept. Pieces that overlap are united.

    With `close` "holes" a surface that is open as a bowl is none of a solid; with "all" it is closed over its mouth.

    Raises `Refused` for vertices that are not finite, indices out of range, no faces, a mesh that is open, one without
    volume, or one that cannot be closed without changing more than a twentieth of its surface.
    """
    mesh, removed = cleaned(mesh, name=name)
    before = Topology.of(mesh)
    pieces, number = components(mesh)
    lids = range(len(pieces)) if close == "all" else _buried(mesh, pieces, name)
    kept = [(piece, part) for index, piece in enumerate(pieces) for part in closed_pieces(piece, lids=index in lids)]
    volumes = [abs(signed_volume(closed)) for _, closed in kept]
    largest = max(volumes, default=0.0)
    solid = [
        pair
        for pair, volume in zip(kept, volumes, strict=True)
        if volume > _NEGLIGIBLE_VOLUME * largest and volume > _FLAT * surface_area(pair[1]) ** 1.5
    ]
    if not solid:
        raise Refused(f"mesh {name!r} {_why_not_closed(mesh, before)}", remedy=_REMEDY)
    outward, inverted, cavities, redundant = _oriented(solid)
    apart = joined(outward)
    result = united(apart)
    after = Topology.of(result)
    volume = signed_volume(result)
    if not (after.watertight and after.consistent and 0 < volume < np.inf):
        raise Refused(f"mesh {name!r} cannot be made watertight", remedy=_REMEDY)
    by_identity = {id(source): source for index, (source, _) in enumerate(solid) if index not in redundant}
    sources = list(by_identity.values())
    area_before = surface_area(mesh)
    area_dropped = area_before - sum(surface_area(source) for source in sources)
    report = RepairReport(
        name=name,
        vertices_before=before.vertices,
        vertices_after=after.vertices,
        faces_before=before.faces + removed.faces,
        faces_after=after.faces,
        components_before=number,
        components_after=components(result)[1],
        pieces_united=0 if result is apart else len(outward),
        holes=sum(Topology.of(source).holes for source in sources),
        boundary_edges=before.boundary_edges,
        non_manifold_edges=before.non_manifold_edges,
        degenerate_faces=removed.faces,
        seams=removed.seams,
        self_intersecting_faces=_self_intersections(result),
        inconsistent_winding=not before.consistent,
        inverted_components=inverted,
        components_dropped=number - len(sources),
        faces_dropped=before.faces - sum(len(source.faces) for source in sources),
        area_dropped=area_dropped / area_before if len(sources) < number else 0.0,
        cavities=cavities,
        watertight_before=before.watertight,
        watertight=True,
        volume_before=signed_volume(mesh) if before.watertight else None,
        volume=volume,
        area_before=area_before,
        area=surface_area(result),
        bounds=tuple(tuple(float(value) for value in corner) for corner in result.bounds),
    )
    if number > len(sources) or any(source is not closed for source, closed in solid):
        _refuse_changes(mesh, result, report, lids=close == "all")
    return result, report


_REMEDY = (
    "Give a mesh that encloses a volume: close its holes in a modelling program, or give the shape a `thickness`, "
    "which makes a shell of a surface; a surface without thickness can be a cloth sheet"
)


def _buried(mesh: trimesh.Trimesh, pieces: list[trimesh.Trimesh], name: str) -> set[int]:
    """Which pieces are open as a vessel, but inside of others, as a limb that is put into a body; raises `Refused` for
    those that are open outside."""
    found = {index: rims for index, piece in enumerate(pieces) if (rims := mouths(piece, mesh))}
    if not found:
        return set()
    solids = [part for index, piece in enumerate(pieces) if index not in found for part in closed_pieces(piece)]
    rims = [rim for rims in found.values() for rim in rims if not any(within(rim, solid) for solid in solids)]
    if not rims:
        return set(found)
    share = 100 * sum(rim.lid for rim in rims) / surface_area(mesh)
    extent = float(np.ptp(mesh.vertices, axis=0).max())
    many = "an opening" if len(rims) == 1 else f"{len(rims)} openings, the widest"
    lids = with_lids(mesh).triangles[len(mesh.faces) :]
    raise Refused(
        f"the surface of mesh {name!r} is open: it has {many} {max(rim.width for rim in rims):.3g} wide, where the "
        f"mesh is {extent:.3g} long. Closing that would add {share:.2g} % to its area, and fill it"
        f"{_pictured(name, mesh.triangles, lids, lids[:0])}",
        remedy="Give the shape a `thickness`, as `thickness: 3 mm`, and it is a shell; or set `close: all`, and it is "
        "closed and filled",
    )


def _refuse_changes(mesh: trimesh.Trimesh, result: trimesh.Trimesh, report: RepairReport, *, lids: bool) -> None:
    """Refuse what repair made of a mesh where too much is another; what it added counts unless `lids` are wanted."""
    from sim.geometry.meshes.changes import lost, missing

    new, old = missing(result, mesh), lost(mesh, result)
    added, gone = new.sum() / report.area_before, old.sum() / report.area_before
    if max(0.0 if lids else added, gone) <= _MOST_CHANGED:
        return
    raise Refused(
        f"mending mesh {report.name!r} would change more than {100 * _MOST_CHANGED:.0f} % of its surface: the area "
        f"{report.area_before:.4g} would become {report.area:.4g}, {100 * added:.2g} % of it added to close "
        f"{report.holes} hole{'' if report.holes == 1 else 's'}, {100 * gone:.2g} % taken away with "
        f"{report.components_dropped} of {report.components_before} pieces that enclose no volume"
        f"{_pictured(report.name, result.triangles[new <= 0], result.triangles[new > 0], mesh.triangles[old > 0])}",
        remedy="Mend it in a modelling program: close its holes, delete what is no part of the solid; or give the "
        "shape a `thickness`, which makes a shell of all its surface",
    )


def _pictured(name: str, kept: np.ndarray, added: np.ndarray, gone: np.ndarray) -> str:
    """Where a picture of what mending would change is, as the end of a sentence; nothing where none can be written.

    All are triangles, shape [n, 3, 3].
    """
    from sim.geometry import cache
    from sim.geometry.meshes import changes

    content = hashlib.sha256()
    for triangles in (kept, added, gone):
        content.update(np.ascontiguousarray(triangles).data)
    image = cache.folder() / "pictures" / f"{Path(name).stem}-{content.hexdigest()[:12]}.png"
    try:
        if not image.exists():
            changes.draw(kept, added, gone, image)
    except OSError:
        return ""
    return f", as the picture {image} shows"


def _why_not_closed(mesh: trimesh.Trimesh, topology: Topology) -> str:
    if np.linalg.matrix_rank(mesh.vertices - mesh.vertices.mean(axis=0), tol=1e-9 * max(mesh.scale, 1e-300)) < 3:
        return "is flat: it encloses no volume"
    if topology.watertight:
        return "encloses no volume"
    return f"cannot be made watertight: {topology.boundary_edges} of its edges have a face on one side only"


def _oriented(
    solid: list[tuple[trimesh.Trimesh, trimesh.Trimesh]],
) -> tuple[list[trimesh.Trimesh], int, int, set[int]]:
    """Turn every piece outward, except hollows: pieces inside another that face the other way than it.

    Returns the pieces, how many were turned, how many are hollows, and the indices of those left out because they
    lie inside another piece and face the same way, which adds nothing to the solid.
    """
    signs = [np.sign(_facing(source, closed)) for source, closed in solid]
    parents = _parents([closed for _, closed in solid])
    redundant: set[int] = set()

    @functools.cache
    def is_material(index: int) -> bool:
        parent = parents[index]
        if parent is None:
            return True
        return is_material(parent) if signs[index] == signs[parent] else not is_material(parent)

    oriented, inverted, cavities = [], 0, 0
    for index, (_, closed) in enumerate(solid):
        parent, material = parents[index], is_material(index)
        if parent is not None and material == is_material(parent):
            redundant.add(index)
            continue
        cavities += int(not material)
        inverted += int((signs[index] > 0) != material)
        outward = signed_volume(closed) > 0
        oriented.append(closed if outward == material else flipped(closed))
    return oriented, inverted, cavities, redundant


def _facing(source: trimesh.Trimesh, closed: trimesh.Trimesh) -> float:
    """Positive where the piece faced outward as it was given: volume of the cone from its own middle."""
    if not Topology.of(source).consistent:
        return 1.0
    about = source.copy()
    about.vertices = about.vertices - closed.bounds.mean(axis=0)
    return signed_volume(about)


def _parents(pieces: list[trimesh.Trimesh]) -> list[int | None]:
    """For every piece, the smallest other piece that holds it whole."""
    from sim.geometry.meshes.winding import WindingNumber

    volumes = [abs(signed_volume(piece)) for piece in pieces]
    bounds = [piece.bounds for piece in pieces]
    tests: dict[int, WindingNumber] = {}
    parents: list[int | None] = []
    for index, piece in enumerate(pieces):
        holders = [
            other
            for other in range(len(pieces))
            if other != index
            and volumes[other] > volumes[index]
            and (bounds[other][0] <= bounds[index][0]).all()
            and (bounds[other][1] >= bounds[index][1]).all()
        ]
        for other in sorted(holders, key=lambda candidate: volumes[candidate]):
            if other not in tests:
                tests[other] = WindingNumber(pieces[other])
            if (tests[other].at(piece.vertices) != 0).all():
                parents.append(other)
                break
        else:
            parents.append(None)
    return parents


def _self_intersections(mesh: trimesh.Trimesh) -> int:
    from pymeshfix import PyTMesh

    fixer = PyTMesh()
    fixer.set_quiet(1)
    fixer.load_array(np.ascontiguousarray(mesh.vertices), np.ascontiguousarray(mesh.faces, dtype=np.int32))
    return len(fixer.select_intersecting_triangles())
