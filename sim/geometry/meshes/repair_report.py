"""What repair found in a mesh and made of it, in numbers and in words."""

from __future__ import annotations

from dataclasses import asdict, dataclass


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
