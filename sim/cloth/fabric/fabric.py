"""A piece of cloth as masses, springs and hinges.

Springs stand for what the threads do per width and length, so that the cloth is as stiff at any spacing.

- Sheets: with cells of a x b, springs along the threads have k = s w / l, w the width between the middles of the cells
  beside, l their length; the two diagonals of a cell k = G (a^2 + b^2) / (2 a b), G the shear stiffness. Diagonals
  resist stretching as well and draw the cloth together across: for a strip that may contract, pulled along its
  threads, to have the stretch stiffness K, c = (K + sqrt(K^2 + 4 G^2)) / 2 is the stiffness without contraction, and
  s = c - G a^2 / b^2 along a.
- Meshes: k = K A / l^2 for an edge of length l whose triangles have the area A together (Van Gelder 1998), which is
  exact for equal triangles: K as asked for, G = 3/8 K.
- Hinges of sheets: threads resist bending by k = B w / l at each point, and the twist of a cell bends one of its
  diagonals, k = 2 B a b / (a^2 + b^2). To the first order that is B/2 (u_xx^2 + u_zz^2 + 2 u_xz^2), the same in all
  directions. (Hinges at the edges of triangles would be a sixth too soft: points with four and with eight edges
  give way in turns.)
- Hinges of meshes: an edge of length l resists an angle by k = B l^2 / A, which is right for equal triangles (Seung
  & Nelson 1988).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from scene.settings import Refused
from sim.cloth.spec import ClothSheet
from sim.geometry.pose import Pose
from sim.geometry.shapes import load_mesh

DEFAULT_POINTS = 40
"""Along the longer side of a sheet whose spacing is not given."""
MOST_POINTS = 4_000_000


@dataclass(frozen=True)
class Fabric:
    """Masses and what is between them, as placed; lengths at rest are those of `points` times the rest scale."""

    points: np.ndarray
    """World coordinates [m], shape [n, 3]."""
    area: np.ndarray
    """Of the cloth around each point [m^2], shape [n]."""
    triangles: np.ndarray
    """Shape [t, 3]."""
    springs: np.ndarray
    """Shape [s, 2]."""
    stiffness: np.ndarray
    """Of the springs [N/m], shape [s]."""
    hinges: np.ndarray
    """The two points of an edge, then one point on either side of it, shape [h, 4]."""
    rigidity: np.ndarray
    """Of the hinges [N m], shape [h]."""
    skips: np.ndarray
    """Points next but one along a thread or across an edge, shape [b, 2]."""
    skip_stiffness: np.ndarray
    """Of springs between them instead of hinges [N/m], shape [b]."""
    sides: dict[str, np.ndarray]
    """Points on the sides and corners of a sheet."""


def without_springs(fabric: Fabric) -> Fabric:
    """The same points and triangles, with nothing between them."""
    pairs, hinges, nothing = np.zeros((0, 2), int), np.zeros((0, 4), int), np.zeros(0)
    return replace(
        fabric, springs=pairs, stiffness=nothing, hinges=hinges, rigidity=nothing, skips=pairs, skip_stiffness=nothing
    )


def weave(sheet: ClothSheet, folder: Path) -> Fabric:
    """The fabric of a sheet; raises Refused, located within the sheet."""
    pose = Pose.of(sheet)
    if sheet.shape.type == "mesh":
        from scene import assets

        try:
            mesh, _ = load_mesh(sheet.shape, assets.resolve(sheet.shape.file, folder), closed=False)
        except Refused as refused:
            raise refused.at("shape", "file") from refused
        return _of_mesh(sheet, pose.to_world(mesh.vertices), np.asarray(mesh.faces))
    return _of_sheet(sheet, pose)


def _of_sheet(sheet: ClothSheet, pose: Pose) -> Fabric:
    cells, size = _cells(sheet)
    (nx, nz), (a, b) = cells, size * pose.scale / cells
    x, z = (np.linspace(-0.5, 0.5, n + 1) * length for n, length in zip(cells, size, strict=True))
    local = np.stack(np.broadcast_arrays(x[:, None], 0.0, z[None, :]), axis=-1).reshape(-1, 3)
    points = pose.to_world(local)
    index = np.arange((nx + 1) * (nz + 1)).reshape(nx + 1, nz + 1)
    along, across, shear = _lattice_stiffness(sheet, a, b)
    # What stands for the cloth on both sides of a thread: half a cell at the borders.
    wide_x, wide_z = (np.r_[0.5, np.ones(n - 1), 0.5] for n in (nx, nz))
    warp = _pairs(index[:-1], index[1:]), np.broadcast_to(along * b / a * wide_z, (nx, nz + 1))
    weft = _pairs(index[:, :-1], index[:, 1:]), np.broadcast_to(across * a / b * wide_x[:, None], (nx + 1, nz))
    groups = [warp, weft]
    if shear > 0:
        diagonal = np.full((nx, nz), shear * (a * a + b * b) / (2 * a * b))
        groups += [
            (_pairs(index[:-1, :-1], index[1:, 1:]), diagonal),
            (_pairs(index[1:, :-1], index[:-1, 1:]), diagonal),
        ]
    skips = [
        (
            _pairs(index[:-2], index[2:]),
            np.broadcast_to(_skip(sheet.bend_stiffness, b * wide_z, a), (max(nx - 1, 0), nz + 1)),
        ),
        (
            _pairs(index[:, :-2], index[:, 2:]),
            np.broadcast_to(_skip(sheet.bend_stiffness, a * wide_x, b)[:, None], (nx + 1, max(nz - 1, 0))),
        ),
    ]
    triangles = _lattice_triangles(index)
    sides = {"left": index[0], "right": index[-1], "back": index[:, 0], "front": index[:, -1]}
    sides["corners"] = index[[0, 0, -1, -1], [0, -1, 0, -1]]
    return Fabric(
        points=points,
        area=a * b * np.outer(wide_x, wide_z).ravel(),
        triangles=triangles,
        springs=np.concatenate([pairs for pairs, _ in groups]),
        stiffness=np.concatenate([np.ravel(k) for _, k in groups]),
        **_lattice_hinges(index, a, b, sheet.bend_stiffness),
        skips=np.concatenate([pairs for pairs, _ in skips]),
        skip_stiffness=np.concatenate([np.ravel(k) for _, k in skips]),
        sides=sides,
    )


def _cells(sheet: ClothSheet) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of cells along x and z, and the lengths of both sides [m] before scaling."""
    size = np.array(sheet.shape.size)
    wanted = size.max() / DEFAULT_POINTS if sheet.spacing is None else sheet.spacing / sheet.scale
    if np.prod(size / wanted) > MOST_POINTS:
        raise Refused(
            f"a sheet of {size[0]:g} m x {size[1]:g} m has {np.prod(size / wanted):.3g} points at this spacing "
            f"(at most {MOST_POINTS:,})",
            location=("spacing",),
            remedy="use a larger spacing",
        )
    # Cells are nearly squares, also where the spacing does not divide the shorter side.
    edge = size.min() / max(1, round(size.min() / wanted))
    return np.maximum(1, np.rint(size / edge)).astype(int), size


def _lattice_stiffness(sheet: ClothSheet, a: float, b: float) -> tuple[float, float, float]:
    """Of threads along x, along z, and of shear [N/m]."""
    stretch = sheet.stretch_stiffness
    shear = stretch / 2 if sheet.shear_stiffness is None else sheet.shear_stiffness
    whole = (stretch + math.sqrt(stretch**2 + 4 * shear**2)) / 2
    along, across = whole - shear * (a / b) ** 2, whole - shear * (b / a) ** 2
    if min(along, across) <= 0:
        raise Refused(
            f"cells of {a:.3g} m x {b:.3g} m are too narrow for a shear stiffness of {shear:.3g} N/m",
            location=("spacing",),
            remedy="give a spacing that divides both sides, or a lower shear_stiffness",
        )
    return along, across, shear


def _lattice_triangles(index: np.ndarray) -> np.ndarray:
    """Two a cell, cut along one diagonal and the other in turns; they face along the sheet's own y."""
    p00, p01, p10, p11 = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    turned = (np.add.outer(np.arange(len(p00)), np.arange(p00.shape[1])) % 2).astype(bool)[..., None, None]
    straight = np.stack([np.stack([p00, p01, p11], -1), np.stack([p00, p11, p10], -1)], axis=-2)
    other = np.stack([np.stack([p00, p01, p10], -1), np.stack([p01, p11, p10], -1)], axis=-2)
    return np.where(turned, other, straight).reshape(-1, 3)


def _lattice_hinges(index: np.ndarray, a: float, b: float, bend: float) -> dict[str, np.ndarray]:
    """Bending of the threads along both sides, and twist of the cells."""
    threads = [_thread_hinges(index, bend * b / a), _thread_hinges(index.T, bend * a / b)]
    corners = index[:-1, :-1], index[1:, 1:], index[1:, :-1], index[:-1, 1:]
    turned = np.add.outer(np.arange(len(corners[0])), np.arange(corners[0].shape[1])) % 2
    one, other = (np.stack([corners[k] for k in order], -1) for order in ((0, 1, 2, 3), (2, 3, 0, 1)))
    twists = np.where(turned[..., None], other, one).reshape(-1, 4)
    hinges = np.concatenate([*(hinges for hinges, _ in threads), twists])
    rigidity = np.concatenate([*(k for _, k in threads), np.full(len(twists), 2 * bend * a * b / (a * a + b * b))])
    return {"hinges": hinges, "rigidity": rigidity}


def _thread_hinges(index: np.ndarray, rigidity: float) -> tuple[np.ndarray, np.ndarray]:
    """Of the threads along the first axis, about edges to the threads beside; those at the borders count half."""
    beside = np.concatenate([index[:, 1:], index[:, -2:-1]], axis=1)
    beside[:, 1:-1:2] = index[:, :-2:2]
    wide = np.r_[0.5, np.ones(index.shape[1] - 2), 0.5]
    members = index[1:-1], beside[1:-1], index[:-2], index[2:]
    shape = members[0].shape
    return np.stack(members, -1).reshape(-1, 4), np.broadcast_to(rigidity * wide, shape).ravel()


def _of_mesh(sheet: ClothSheet, points: np.ndarray, triangles: np.ndarray) -> Fabric:
    areas = np.linalg.norm(np.cross(*(points[triangles[:, k]] - points[triangles[:, 0]] for k in (1, 2))), axis=1) / 2
    edges, beside = np.unique(np.sort(edges_of(triangles), axis=1), axis=0, return_inverse=True)
    around = np.bincount(beside.ravel(), weights=np.tile(areas, 3), minlength=len(edges))
    length = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    found = _hinges(points, triangles, sheet.bend_stiffness)
    across = found["hinges"][:, 2:]
    reach = np.linalg.norm(points[across[:, 0]] - points[across[:, 1]], axis=1)
    width = np.linalg.norm(np.subtract(*(points[found["hinges"][:, k]] for k in (0, 1))), axis=1)
    return Fabric(
        points=points,
        area=np.bincount(triangles.ravel(), weights=np.repeat(areas / 3, 3), minlength=len(points)),
        triangles=triangles,
        springs=edges,
        stiffness=sheet.stretch_stiffness * around / length**2,
        **found,
        skips=across,
        skip_stiffness=_skip(sheet.bend_stiffness, width, reach / 2),
        sides={},
    )


def edges_of(triangles: np.ndarray) -> np.ndarray:
    """The three edges of all triangles, one after the other, shape [3 t, 2]."""
    return np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])


def _hinges(points: np.ndarray, triangles: np.ndarray, bend: float) -> dict[str, np.ndarray]:
    """Edges with exactly two triangles, and how they resist bending."""
    edges, third = np.sort(edges_of(triangles), axis=1), triangles[:, [2, 0, 1]].T.ravel()
    order = np.lexsort((third, edges[:, 1], edges[:, 0]))
    edges, third = edges[order], third[order]
    new = np.r_[True, (edges[1:] != edges[:-1]).any(axis=1)]
    first = np.flatnonzero(new)
    first = first[np.diff(np.r_[first, len(edges)]) == 2]
    hinges = np.column_stack([edges[first], third[first], third[first + 1]])
    p, q, r, s = (points[hinges[:, k]] for k in range(4))
    area = sum(np.linalg.norm(np.cross(q - p, corner - p), axis=1) for corner in (r, s)) / 2
    return {"hinges": hinges, "rigidity": bend * ((q - p) ** 2).sum(axis=1) / area}


def _skip(bend: float, width: np.ndarray, length: np.ndarray | float) -> np.ndarray:
    """Stiffness of springs next but one [N/m] that store as much at a fold of 90 degrees as bending the same width."""
    saved = 2 * length * (1 - math.cos(math.pi / 4))
    return bend * width / length * (math.pi / 2) ** 2 / saved**2


def _pairs(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.column_stack([one.ravel(), other.ravel()])
