"""Sheets of cloth: drawn with a thickness, each point knowing where it is in the cloth and how far from its rim."""

from __future__ import annotations

from array import array
from types import SimpleNamespace
from typing import Any

from mathutils import Vector
from mathutils.kdtree import KDTree

from common.attributes import WET
from render.blender import versions
from render.content.axes import z_up_columns
from render.content.changing.curved import curved
from render.content.changing.meshes import MovingMesh
from render.content.materials import make_material
from render.content.nodes import REST, RIM, Graph
from render.content.ply import TriangleMesh, max_of, min_of
from render.errors import Unusable
from render.looks.simple import Known

FILLED = 0.9
"""Thickness as drawn over that of the simulation, unless set: cloth that lies on cloth does not reach into it."""
ANEW = "simulate its frames again"
REST_COLUMNS = ("rest_x", "rest_y", "rest_z")


class Sheet(MovingMesh):
    """A sheet of cloth; `first` is its mesh in any frame, `action` the diagonal of the action's box [m]. If `wet`,
    meshes may have a column of that name. Files for other programs have the triangles of the simulation, Blender has
    them curved.

    Raises Unusable for what its look has and files of old do not hold.
    """

    def __init__(
        self, name: str, look: Any, first: TriangleMesh, action: float, known: Known = "all", wet: bool = False
    ):
        thick = drawn_thickness(look, first) is not None
        size = rest_size(first) or action
        back = getattr(look, "back", None)
        if back is not None and not thick:
            raise Unusable(f"'{name}' has a back, but its files say no thickness\n  fix: give its look one, or {ANEW}")
        if not has_rest(first) and (getattr(look, "weave", None) or getattr(look, "hem", None)):
            what = f"'{name}' has a weave or hem, but its files do not say where its points are in the cloth"
            raise Unusable(f"{what}\n  fix: remove these settings, or {ANEW}")
        sides = [(name, look)]
        if back is not None:
            sides.append((f"{name} back", SimpleNamespace(**vars(look) | {"color": back})))
        kinds: dict[str, Any] = {"rests": has_rest(first), "thick": thick, "known": known, "wet": _wet if wet else None}
        super().__init__("cloth_" + name, *(make_material(side, its, size, **kinds) for side, its in sides))
        self._look = look
        self._curved = known == "all"

    def build(self, source: TriangleMesh, name: str) -> Any:
        source = curved(source) if self._curved else source
        mesh = super().build(source, name)
        note_rest(mesh, source)
        return mesh

    def take(self, mesh: Any, source: TriangleMesh | None) -> None:
        super().take(mesh, source)
        if source is not None:
            self.finish(self.thing, source)

    def finish(self, thing: Any, source: TriangleMesh) -> None:
        thicken(thing, drawn_thickness(self._look, source), two_sided=len(self._materials) > 1)


def _wet(graph: Graph) -> Any:
    return graph.node("Attribute", attribute_name=WET).outputs["Fac"]


def has_rest(source: TriangleMesh) -> bool:
    """Whether its file says where its points are in the cloth."""
    return source.has(*REST_COLUMNS)


def rest_size(source: TriangleMesh) -> float:
    """Diagonal of the box around the cloth at rest [m], 0 where its file does not know it."""
    return sum(extent**2 for extent in _rest_extents(source)) ** 0.5


def drawn_thickness(look: Any, source: TriangleMesh) -> float | None:
    """Of the look [m], or by the simulation's; None where neither says it."""
    set_by_look: float | None = getattr(look, "thickness", None)
    if set_by_look is not None or not source.has("thickness") or source.vertex_count() == 0:
        return set_by_look
    return FILLED * float(source.columns["thickness"][0])


def note_rest(mesh: Any, source: TriangleMesh) -> None:
    """Give the mesh of a frame the attributes REST and RIM, where its file says where its points are in the cloth.

    The axis along which the cloth is shortest at rest comes last: a sheet lies in the first two.
    """
    if not has_rest(source) or len(mesh.polygons) == 0:
        return
    extents = _rest_extents(source)
    shortest = extents.index(min(extents))
    u, v, w = (source.columns[REST_COLUMNS[axis]] for axis in sorted(range(3), key=lambda axis: axis == shortest))
    rest = mesh.attributes.new(REST, "FLOAT_VECTOR", "POINT")
    rest.data.foreach_set("vector", z_up_columns(u, w, _negated(v)))
    places = [Vector(place) for place in zip(u, v, w, strict=True)]
    borders = _open_edges(mesh)
    tree = KDTree(2 * len(borders))
    for edge in borders:
        edge.use_edge_sharp = True  # else the shading of the cloth's faces would round it off
        for vertex in edge.vertices:
            tree.insert(places[vertex], vertex)
    tree.balance()
    versions.keep_sharp_edges(mesh)
    far = max(rest_size(source), 1.0)
    distances = array("f", (tree.find(place)[2] if borders else far for place in places))
    mesh.attributes.new(RIM, "FLOAT", "POINT").data.foreach_set("value", distances)


def thicken(thing: Any, thickness: float | None, two_sided: bool) -> None:
    """Have an object drawn with a thickness [m], half of it on either side; the side on which its normals do not look
    takes the second of two materials."""
    if thickness is None:
        return
    wall = thing.modifiers.get("thickness") or thing.modifiers.new("thickness", "SOLIDIFY")
    wall.thickness, wall.offset = thickness, 0.0
    wall.material_offset = int(two_sided)


def _open_edges(mesh: Any) -> list[Any]:
    """Edges of one triangle."""
    uses = array("i", bytes(4 * len(mesh.edges)))
    of_corners = array("i", bytes(4 * len(mesh.loops)))
    mesh.loops.foreach_get("edge_index", of_corners)
    for edge in of_corners:
        uses[edge] += 1
    return [edge for edge, count in zip(mesh.edges, uses, strict=True) if count == 1]


def _rest_extents(source: TriangleMesh) -> list[float]:
    if not has_rest(source) or source.vertex_count() == 0:
        return [0.0] * 3
    return [float(max_of(column) - min_of(column)) for column in (source.columns[name] for name in REST_COLUMNS)]


def _negated(column: Any) -> Any:
    return array("f", (-value for value in column)) if isinstance(column, array) else -column
