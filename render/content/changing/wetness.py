"""What is wet, as pictures show it: a lattice of points as an image, which materials look up.

The layers of the lattice, one above the other, are strips of one image; between two of them it is interpolated.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from common.attributes import WET
from render.blender.session import bpy
from render.content.nodes import Graph
from render.content.ply import ANEW, TriangleMesh, max_of, min_of, read_cloud
from render.errors import Unusable
from render.inputs import Box, Inputs
from render.looks.wet import soaked

LARGEST = 8192
"""Pixels of an image along an edge, at most; larger lattices become coarser."""
NAME = "wet "
"""Begins the names of what was read of it."""
CLOSE = 0.005
"""How far the ground may be from a floor that was wetted, over the diagonal of the box of the action: it is drawn a
little sunk."""
BESIDE = 0.5
"""How far beside that box the ground gets wet, likewise."""
Place = Callable[[Graph], Any]
"""The node output that says where a point is, in the axes of the lattice turned to z up [m]."""


@dataclass(frozen=True)
class Lattice:
    """Points at whole multiples of `cell` [m] along x, y (up) and z, from `low` on."""

    cell: float
    low: tuple[int, int, int]
    shape: tuple[int, int, int]
    every: int = 1
    """Points of the files along an axis for one of these."""

    @classmethod
    def around(cls, low: tuple[float, ...], high: tuple[float, ...], cell: float) -> Lattice:
        """One that holds a box [m] with a point to spare on all sides, within what an image can hold."""
        every = 1
        while True:
            first = [math.floor(edge / (every * cell)) - 1 for edge in low]
            shape = [math.ceil(edge / (every * cell)) + 2 - start for edge, start in zip(high, first, strict=True)]
            if shape[0] <= LARGEST and shape[1] * shape[2] <= LARGEST:
                x, y, z = first
                return cls(every * cell, (x, y, z), (shape[0], shape[1], shape[2]), every)
            every += 1


class WetImage:
    """How wet a body, a container or the floor is, from frame to frame."""

    def __init__(self, name: str, lattice: Lattice, place: Place | None = None):
        """place: without it, where the material says that a point is."""
        self._lattice = lattice
        self._place = place
        width, layers, depth = lattice.shape
        self.image = bpy.data.images.new(f"wet {name}", width, layers * depth, is_data=True)

    def show(self, points: TriangleMesh | None) -> None:
        """Have what is wet in a frame; nothing for None."""
        width, layers, depth = self._lattice.shape
        pixels = array("f", (0.0, 0.0, 0.0, 1.0)) * (width * layers * depth)
        if points is not None:
            cell = self._lattice.cell
            rows = zip(*(points.columns[name] for name in ("x", "y", "z", "wet")), strict=True)
            for x, y, z, wet in rows:
                i, j, k = (round(float(p) / cell) - low for p, low in zip((x, y, z), self._lattice.low, strict=True))
                if 0 <= i < width and 0 <= j < layers and 0 <= k < depth:
                    at = 4 * ((j * depth + k) * width + i)
                    value = max(pixels[at], float(wet))
                    pixels[at : at + 3] = array("f", (value,) * 3)
        self.image.pixels.foreach_set(pixels)
        self.image.update()

    def __call__(self, graph: Graph) -> Any:
        """The node output with the wetness of a point, from 0 to 1."""
        (width, layers, depth), (low_x, low_y, low_z) = self._lattice.shape, self._lattice.low
        place = graph.place() if self._place is None else self._place(graph)
        x, y, z = graph.node("SeparateXYZ", {0: place}).outputs
        per_metre = 1 / self._lattice.cell
        across = graph.math("MULTIPLY_ADD", x, per_metre / width, (0.5 - low_x) / width)
        row = graph.math("MULTIPLY_ADD", y, -per_metre, float(-low_z))
        layer = graph.math("MULTIPLY_ADD", z, per_metre, float(-low_y))
        row = graph.math("MINIMUM", graph.math("MAXIMUM", row, 0.0), depth - 1.0)
        layer = graph.math("MINIMUM", graph.math("MAXIMUM", layer, 0.0), layers - 1.0)
        below = graph.math("FLOOR", layer)
        above = graph.math("MINIMUM", graph.math("ADD", below, 1.0), layers - 1.0)
        found = (self._looked_up(graph, across, row, strip) for strip in (below, above))
        return graph.blend(graph.math("SUBTRACT", layer, below), *found)

    def _looked_up(self, graph: Graph, across: Any, row: Any, strip: Any) -> Any:
        """Of a point in one of the layers; `across` is from 0 to 1, `row` in points."""
        _, layers, depth = self._lattice.shape
        up = graph.math("ADD", graph.math("MULTIPLY_ADD", strip, float(depth), 0.5), row)
        place = graph.node("CombineXYZ", {0: across, 1: graph.math("DIVIDE", up, float(layers * depth))}).outputs[0]
        node = graph.node("TexImage", {"Vector": place}, image=self.image, extension="EXTEND")
        return graph.channel(node.outputs["Color"], "red")


class Wetness:
    """Of all that can be wet; `box` is that of the action."""

    def __init__(self, inputs: Inputs, box: Box):
        self._inputs, self._box = inputs, box
        self._cell, self._floors = inputs.wet_lattice()
        self._images: dict[str, WetImage] = {}

    def of(self, part: str, source: TriangleMesh, look: Any) -> WetImage | None:
        """What says how wet a body or container is, as its file is named; None for looks that do not show it."""
        if not any(soaked(look)) or source.vertex_count() == 0:
            return None
        return self._add(part, Lattice.around(*_bounds(source), self._cell))

    def of_floor(self, height: float, look: Any) -> WetImage | None:
        """Likewise of the ground at a height [m]; None, too, where no floor was wetted there."""
        diagonal = self._box.diagonal
        near = [floor for floor in self._floors if abs(floor - height) < CLOSE * diagonal]
        if not near or not any(soaked(look)):
            return None
        (left, back, _), (right, front, _) = self._box.low, self._box.high
        beside, floor = BESIDE * diagonal, min(near, key=lambda one: abs(one - height))
        low, high = (left - beside, floor, -front - beside), (right + beside, floor, beside - back)

        def place(graph: Graph) -> Any:
            x, y, _ = graph.node("SeparateXYZ", {0: graph.node("NewGeometry").outputs["Position"]}).outputs
            return graph.node("CombineXYZ", {0: x, 1: y, 2: floor}).outputs[0]

        return self._add("floor", Lattice.around(low, high, self._cell), place)

    def read(self, meshes: dict[str, TriangleMesh | None], frame: int) -> dict[str, TriangleMesh | None]:
        """The meshes of a frame, in which sheets say how wet they are, and the wet points of all else; raises Unusable
        for files that do not fit."""
        found: dict[str, TriangleMesh | None] = {}
        for name, mesh in meshes.items():
            path = self._inputs.wetness(name, frame) if name.startswith("cloth_") else None
            found[name] = mesh if mesh is None or path is None else _with_wet(mesh, path)
        for part in self._images:
            path = self._inputs.wetness(part, frame)
            found[NAME + part] = None if path is None else _points(path)
        return found

    def show(self, meshes: dict[str, TriangleMesh | None]) -> None:
        """Have all as wet as in a frame that was read."""
        for part, image in self._images.items():
            image.show(meshes[NAME + part])

    def _add(self, part: str, lattice: Lattice, place: Place | None = None) -> WetImage:
        self._images[part] = WetImage(part, lattice, place)
        return self._images[part]


def _points(path: Path) -> TriangleMesh:
    points = read_cloud(path)
    if not points.has(WET):
        raise Unusable(f"{path} does not say what is wet\n  fix: {ANEW}")
    return points


def _with_wet(mesh: TriangleMesh, path: Path) -> TriangleMesh:
    wet = _points(path).columns[WET]
    if len(wet) != mesh.vertex_count():
        raise Unusable(f"{path} is of another mesh: {len(wet)} vertices, not {mesh.vertex_count()}\n  fix: {ANEW}")
    return replace(mesh, columns=mesh.columns | {WET: wet})


def _bounds(source: TriangleMesh) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Lowest and highest corner of the box around a mesh, in its own axes [m]."""
    low, high = (tuple(float(bound(source.columns[axis])) for axis in "xyz") for bound in (min_of, max_of))
    return low, high
