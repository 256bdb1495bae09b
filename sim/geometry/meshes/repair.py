"""Watertight, outward-facing triangle meshes from whatever a file holds."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from scene.settings import Refused
from sim.geometry.meshes.closing import closed_pieces, with_lids
from sim.geometry.meshes.nesting import turned_outward
from sim.geometry.meshes.openings import mouths, within
from sim.geometry.meshes.repair_report import RepairReport
from sim.geometry.meshes.topology import Topology, cleaned, components, joined, signed_volume, surface_area
from sim.geometry.meshes.union import united

if TYPE_CHECKING:
    import trimesh

# A closed piece below this share of the largest piece's volume is debris of the scan.
_NEGLIGIBLE_VOLUME = 1e-5
# A repair that adds or takes away more than this share of the surface has not understood the mesh.
_MOST_CHANGED = 0.05
# A solid thinner than this share of (area)^(3/2) is a double-sided sheet: its volume is rounding.
_FLAT = 1e-7


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
    outward, inverted, cavities, redundant = turned_outward(solid)
    apart = joined(outward)
    result = united(apart)
    after = Topology.of(result)
    volume = signed_volume(result)
    if not (after.watertight and after.consistent and 0 < volume < np.inf):
        raise Refused(f"mesh {name!r} cannot be made watertight", remedy=_REMEDY)
    low, high = result.bounds.tolist()
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
        bounds=(tuple(low), tuple(high)),
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


def _self_intersections(mesh: trimesh.Trimesh) -> int:
    from pymeshfix import PyTMesh

    fixer = PyTMesh()
    fixer.set_quiet(1)
    fixer.load_array(np.ascontiguousarray(mesh.vertices), np.ascontiguousarray(mesh.faces, dtype=np.int32))
    return len(fixer.select_intersecting_triangles())
