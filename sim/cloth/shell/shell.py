"""The shell of all sheets of a scene on the device, and what of it stays the same in all steps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sim.cloth.fabric.arrays import incidence, integers, numbers, vectors
from sim.cloth.fabric.fabric import edges_of
from sim.cloth.fabric.rows import BendingRows
from sim.cloth.shell.curvature import Bending
from sim.cloth.shell.layout import ShellRest
from sim.cloth.shell.membrane import Membrane, normals_at_points
from sim.cloth.shell.sheet import SheetShell

if TYPE_CHECKING:
    from sim.cloth.fabric.mesh import ClothMesh

FLAT = 1e-6
"""Points that are no further from a plane than this share of their sheet's size, as a root of squares, lie in it."""


class Shell:
    """Triangles and curvatures of all sheets, numbered through; on the device, `rest` is all of them."""

    def __init__(self, parts: list[SheetShell]):
        rests = [part.places for part in parts]
        starts = np.cumsum([0] + [len(rest) for rest in rests]).tolist()
        self.count = starts[-1]
        self.membrane = _together([part.membrane for part in parts], starts)
        self.bending = _one_after_another([part.bending for part in parts], starts)
        self.places = np.concatenate(rests)
        """At rest [m], shape [n, 3], each sheet by itself."""
        self.rest_curvature = self.curvature(self.places)
        """Shape [n, 3], [J^0.5]."""
        self.flat = np.concatenate([np.full(len(rest), float(_flat(rest))) for rest in rests])
        """1 in sheets that are flat at rest, else 0, shape [n]."""
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

    def row_sums(self) -> tuple[np.ndarray, np.ndarray]:
        """Bounds of how stretching and bending push points back [N/m], and of how they damp them [kg/s], shape [n].

        Sums of the norms of the blocks of each row, at rest (Gershgorin's theorem for blocks: Feingold & Varga 1962).
        """
        membrane, bending = self.membrane, self.bending
        u, v = membrane.slopes[..., 0], membrane.slopes[..., 1]
        strains = np.zeros((self.triangles, 3, 3, 2))
        strains[:, :, 0, 0], strains[:, :, 1, 1] = u, v
        strains[:, :, 2, 0], strains[:, :, 2, 1] = v, u
        blocks = np.einsum("tkia,tij,tmjb->tkmab", strains, membrane.stiffness, strains)
        norms = membrane.area[:, None] * np.linalg.norm(blocks, ord=2, axis=(3, 4)).sum(axis=2)
        rows = abs(bending.matrix()).sum(axis=1)
        found = []
        for of_faces, of_points in ((np.ones(self.triangles), 1.0), (membrane.delay, bending.delay)):
            weights = (norms * of_faces[:, None]).ravel()
            found.append(np.bincount(membrane.corners.ravel(), weights, minlength=self.count) + rows * of_points)
        return found[0], found[1]

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
        return normals_at_points(places, self.membrane.corners)

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
            rest_curvature=vectors(self.rest_curvature),
            flat_at_rest=numbers(self.flat),
        )

    @property
    def bytes(self) -> int:
        """Memory of it on the device [bytes]."""
        return 8 * (16 * self.triangles + 5 * self.count) + 32 * len(self.bending.points)


def shell_of(mesh: ClothMesh) -> Shell:
    """That of a cloth of finite elements.

    Raises TypeError for masses and springs.
    """
    if mesh.shell is None:
        raise TypeError("a cloth of masses and springs has no shell")
    return mesh.shell


def _flat(points: np.ndarray) -> bool:
    """Whether they lie in a plane."""
    apart = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)[2] / np.sqrt(len(points))
    return bool(apart < FLAT * np.linalg.norm(np.ptp(points, axis=0)))


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
