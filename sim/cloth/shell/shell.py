"""The shell of all sheets of a scene on the device, and what of it stays the same in all steps."""

from __future__ import annotations

import numpy as np

from sim.cloth.fabric.arrays import incidence, integers, numbers, vectors
from sim.cloth.fabric.fabric import Fabric, edges_of
from sim.cloth.fabric.rows import BendingRows
from sim.cloth.shell.curvature import Bending, find_bending
from sim.cloth.shell.layout import ShellRest
from sim.cloth.shell.membrane import Membrane, find_membrane
from sim.cloth.spec import ClothSheet
from sim.geometry.pose import Pose


class Shell:
    """Triangles and curvatures of all sheets, numbered through; on the device, `rest` is all of them."""

    def __init__(self, sheets: list[ClothSheet], fabrics: list[Fabric]):
        starts = np.cumsum([0] + [len(fabric.points) for fabric in fabrics]).tolist()
        self.count = starts[-1]
        parts = list(zip(sheets, fabrics, strict=True))
        rests = [sheet.rest_scale * fabric.points for sheet, fabric in parts]
        warps = [Pose.of(sheet).rotation @ np.array(sheet.fabric.warp) for sheet in sheets]
        found = [
            (
                find_membrane(sheet, rest, fabric.triangles, warp),
                find_bending(sheet, rest, fabric.triangles, warp),
            )
            for (sheet, fabric), rest, warp in zip(parts, rests, warps, strict=True)
        ]
        self.membrane = _together([part for part, _ in found], starts)
        self.bending = _one_after_another([part for _, part in found], starts)
        self.places = np.concatenate(rests)
        """At rest [m], shape [n, 3], each sheet by itself."""
        self.triangles = len(self.membrane.area)
        self.edges = np.unique(np.sort(edges_of(self.membrane.corners), axis=1), axis=0)

    @property
    def stiffness_at_point(self) -> np.ndarray:
        """What stretching holds each point by [N/m], shape [n]."""
        membrane = self.membrane
        warp, weft, _, shear = membrane.modulus.T
        squares = membrane.slopes**2
        held = squares[..., 0] * (warp + shear)[:, None] + squares[..., 1] * (weft + shear)[:, None]
        return np.bincount(membrane.corners.ravel(), (membrane.area[:, None] * held).ravel(), minlength=self.count)

    def bending_rows(self) -> BendingRows:
        """The second derivatives of bending."""
        whole = self.bending.matrix()
        diagonal = whole.diagonal()
        whole.setdiag(0.0)
        whole.eliminate_zeros()
        whole.sort_indices()
        return BendingRows(whole.indptr, whole.indices, whole.data, diagonal)

    def curvature(self, places: np.ndarray) -> np.ndarray:
        """Three kinds of curvature along the normals at points [J^0.5], shape [n, 3]."""
        return np.einsum("nkx,nx->nk", self.bending.bent(places), self.normals(places))

    def normals(self, places: np.ndarray) -> np.ndarray:
        """Unit normals at points, shape [n, 3]."""
        corners, normal = self.membrane.corners, np.zeros((self.count, 3))
        faces = np.cross(*(places[corners[:, k]] - places[corners[:, 0]] for k in (1, 2)))
        np.add.at(normal, corners.ravel(), np.repeat(faces, 3, axis=0))
        return normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]

    def on_device(self) -> ShellRest:
        """All of it for kernels."""
        membrane, bending = self.membrane, self.bending
        warp, weft, both, shear = membrane.modulus.T
        first, entry = incidence(membrane.corners, self.count)
        own = np.repeat(np.arange(self.count), np.diff(bending.first))
        mirrored = np.searchsorted(own * self.count + bending.points, bending.points * self.count + own)
        return ShellRest(
            shell_corner=integers(membrane.corners.ravel()),
            warp_slope=vectors(membrane.slopes[..., 0]),
            weft_slope=vectors(membrane.slopes[..., 1]),
            rest_area=numbers(membrane.area),
            modulus=vectors(np.column_stack([warp, weft, both])),
            shear_modulus=numbers(shear),
            barrier=numbers(membrane.barrier),
            stretch_delay=numbers(membrane.delay),
            first_corner=integers(first),
            of_corner=integers(entry),
            first_beside=integers(bending.first),
            beside=integers(bending.points),
            bend_weight=vectors(bending.weights),
            mirrored=integers(mirrored),
            bend_delay=numbers(bending.delay),
            rest_curvature=vectors(self.curvature(self.places)),
        )

    @property
    def bytes(self) -> int:
        """Memory of it on the device [bytes]."""
        return 8 * (16 * self.triangles + 5 * self.count) + 32 * len(self.bending.points)


def _together(parts: list[Membrane], starts: list[int]) -> Membrane:
    corners = [part.corners + start for part, start in zip(parts, starts, strict=False)]
    names = ("slopes", "area", "modulus", "barrier", "delay")
    return Membrane(np.concatenate(corners), *(np.concatenate([getattr(p, name) for p in parts]) for name in names))


def _one_after_another(parts: list[Bending], starts: list[int]) -> Bending:
    counts = np.concatenate([np.diff(part.first) for part in parts])
    return Bending(
        np.concatenate([[0], np.cumsum(counts)]),
        np.concatenate([part.points + start for part, start in zip(parts, starts, strict=False)]),
        np.concatenate([part.weights for part in parts]),
        np.concatenate([part.delay for part in parts]),
    )
