"""How triangles resist stretching, as they are at rest: constant strain, orthotropic (Turner et al. 1956).

The energy per area is e.C e/2 of the Green strain e = (e_warp, e_weft, angle), which is that of St. Venant and
Kirchhoff, and b (J - 1 - ln J) of the area J over that at rest, which keeps triangles from collapsing; C gives way
for it, so that small strains meet with the stiffness that the fabric has.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.cloth.spec import ClothSheet

BARRIER = 0.1
"""Of the least stiffness of stretches: that of the barrier."""


@dataclass(frozen=True)
class Membrane:
    """Triangles of all sheets."""

    corners: np.ndarray
    """Points of triangles, shape [t, 3]."""
    slopes: np.ndarray
    """Of what is 1 at a corner and 0 at the others, along warp and weft [1/m], shape [t, 3, 2]."""
    area: np.ndarray
    """At rest [m^2], shape [t]."""
    modulus: np.ndarray
    """Of warp, weft, both together, and shear, without the barrier [N/m], shape [t, 4]."""
    barrier: np.ndarray
    """[N/m], shape [t]."""
    delay: np.ndarray
    """Stress by the rate of strain over that by strain [s], shape [t]."""

    @property
    def stiffness(self) -> np.ndarray:
        """How the strains push back, at rest, shape [t, 3, 3]: energy per area and strain squared [N/m]."""
        whole = np.zeros((len(self.area), 3, 3))
        warp, weft, both, shear = self.modulus.T
        for (row, column), value in {(0, 0): warp, (1, 1): weft, (0, 1): both, (1, 0): both}.items():
            whole[:, row, column] = value + self.barrier
        whole[:, 2, 2] = shear
        return whole


def find_membrane(sheet: ClothSheet, points: np.ndarray, triangles: np.ndarray, warp: np.ndarray) -> Membrane:
    """Of one sheet with `points` at rest [m], shape [n, 3], and the direction of its warp there, shape [3]."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    twice = np.cross(b - a, c - a)
    double = np.linalg.norm(twice, axis=1)
    normal = twice / double[:, None]
    along = warp_on(normal, warp)
    across = np.cross(normal, along)
    slopes = np.empty((len(triangles), 3, 2))
    for k, edge in enumerate((c - b, a - c, b - a)):
        turned = np.cross(normal, edge) / double[:, None]
        slopes[:, k, 0], slopes[:, k, 1] = (turned * along).sum(axis=1), (turned * across).sum(axis=1)
    modulus, barrier = moduli(sheet)
    count = len(triangles)
    return Membrane(
        triangles,
        slopes,
        double / 2,
        np.broadcast_to(modulus, (count, 4)),
        np.full(count, barrier),
        np.full(count, sheet.woven.damping_time),
    )


def moduli(sheet: ClothSheet) -> tuple[np.ndarray, float]:
    """Of warp, weft, both, and shear, without the barrier, and that [N/m]."""
    fabric = sheet.resistance
    warp, weft, poisson = fabric.warp_stiffness, fabric.weft_stiffness, fabric.poisson_ratio
    free = 1 - poisson**2 * weft / warp
    whole = np.array([warp / free, weft / free, poisson * weft / free])
    barrier = BARRIER * float(np.linalg.eigvalsh([whole[[0, 2]], whole[[2, 1]]])[0])
    return np.append(whole - barrier, fabric.shear_stiffness), barrier


def normals_at_points(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Unit normals at points, of the areas of the triangles around them, shape [n, 3]; 0 where there is none."""
    normal, faces = np.zeros((len(points), 3)), [points[triangles[:, k]] - points[triangles[:, 0]] for k in (1, 2)]
    np.add.at(normal, triangles.ravel(), np.repeat(np.cross(*faces), 3, axis=0))
    return normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]


def warp_on(normal: np.ndarray, warp: np.ndarray) -> np.ndarray:
    """The direction of the warp in planes across the normals, shape [n, 3]; where that stands upright, another one."""
    flat = warp - (normal @ warp)[:, None] * normal
    length = np.linalg.norm(flat, axis=1)
    other = np.eye(3)[np.abs(warp).argmin()]
    instead = np.cross(other, normal)
    flat = np.where(length[:, None] > 1e-3, flat, instead)
    return flat / np.linalg.norm(flat, axis=1)[:, None]
