"""All sheets of a scene as one mesh on the device, with what integrators share."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sim.cloth.fabric.air_drag import find_drag
from sim.cloth.fabric.arrays import (
    hinge_arrays,
    incidence,
    integers,
    mass_spring,
    numbers,
    point_arrays,
    spring_arrays,
    vectors,
)
from sim.cloth.fabric.fabric import Fabric, without_springs
from sim.cloth.fabric.layout import Drag, Hinges, MassSpring, Springs
from sim.cloth.spec import Air, ClothSheet
from sim.device.compiler import ti
from sim.device.double import vec3

if TYPE_CHECKING:
    from sim.cloth.shell.sheet import SheetShell
    from sim.cloth.shell.shell import Shell

ALONE = 4000
"""Cloths of fewer points are stepped by one thread on a CPU."""


class Elastic:
    """Points of all sheets as they are placed, numbered through, and what is between them: springs and hinges, or a
    shell."""

    def __init__(
        self,
        sheets: list[ClothSheet],
        fabrics: list[Fabric],
        held: np.ndarray,
        solids: np.ndarray | None = None,
        shells: list[SheetShell] | None = None,
    ):
        """`solids`: points of solids [m], shape [n, 3], which follow those of the cloth; `shells`: what sheets are
        instead of springs and hinges."""
        starts = np.cumsum([0] + [len(fabric.points) for fabric in fabrics]).tolist()
        parts = list(zip(sheets, fabrics, starts, strict=False))
        self.count = starts[-1]
        self.placed = np.concatenate([fabric.points for fabric in fabrics])
        self.mass = np.concatenate([sheet.density * fabric.area for sheet, fabric, _ in parts])
        self.held = held
        solids = np.zeros((0, 3)) if solids is None else solids
        self.total = self.count + len(solids)
        self.placed = np.concatenate([self.placed, solids])
        self.triangles = np.concatenate([fabric.triangles + start for _, fabric, start in parts])
        self.shell = _together(shells) if shells else None
        if self.shell:
            parts = [(sheet, without_springs(fabric), start) for sheet, fabric, start in parts]
        springs = [_springs(sheet, fabric, start, self.mass, self.placed) for sheet, fabric, start in parts]
        self.ends, self.rest, self.stiffness, self.damping = _near_first(springs)
        hinges = [_hinges(sheet, fabric, start, self.mass, self.placed) for sheet, fabric, start in parts]
        self.corners, self.rest_angle, self.rigidity, self.bend_damping, self.shrinking = _near_first(hinges)
        self.springs, self.hinges = len(self.ends), len(self.corners)

    @property
    def edges(self) -> np.ndarray:
        """Points that something holds together, shape [e, 2]."""
        return self.shell.edges if self.shell else self.ends

    @property
    def stiffness_of_points(self) -> np.ndarray:
        """What stretching holds each point by [N/m], shape [points]."""
        if self.shell:
            return self.shell.stiffness_at_point
        return np.bincount(self.ends.ravel(), weights=np.repeat(self.stiffness, 2), minlength=self.count)


class ClothMesh(Elastic):
    """The same on the device, as it moves."""

    def __init__(
        self,
        sheets: list[ClothSheet],
        fabrics: list[Fabric],
        position: np.ndarray,
        velocity: np.ndarray,
        held: np.ndarray,
        air: Air | None,
        gravity: np.ndarray,
        solids: np.ndarray | None = None,
        shells: list[SheetShell] | None = None,
    ):
        """gravity [m/s^2], shape [3]; `solids` and `shells` as of Elastic."""
        super().__init__(sheets, fabrics, held, solids, shells)
        solids = self.placed[self.count :]
        weight = np.concatenate([self.mass, np.zeros(len(solids))])
        fixed = np.concatenate([held, np.ones(len(solids), bool)])
        position = np.concatenate([position, solids])
        self.points = point_arrays(position, np.concatenate([velocity, 0 * solids]), weight, fixed)
        self._gravity = gravity
        springs = spring_arrays(self.ends, self.rest, self.stiffness, self.damping, self.count)
        hinges = hinge_arrays(self.corners, self.rest_angle, self.rigidity, self.bend_damping, self.count)
        self.place = vectors(position)
        """Where held points and solids are at the end of a step [m]; of others, what integrators make of it."""
        self.stiffness_at_point = numbers(self.stiffness_of_points)
        """What stretching holds each point by [N/m]."""
        self.shell_rest = self.shell.on_device() if self.shell else None
        self.air = AirDrag(self, air)
        self.model = self.as_model(springs, hinges)

    def as_model(self, springs: Springs, hinges: Hinges) -> MassSpring:
        """The points and the air of this cloth with its springs and hinges, in an order that may be another one."""
        counts = self.count, self.springs, self.hinges
        return mass_spring(self.points, springs, hinges, self.air.drag, counts, self._gravity, self.air.wind)

    @property
    def alone(self) -> bool:
        """Whether one thread does better than several that wait for one another."""
        return self.count < ALONE and ti.cfg.arch == ti.cpu

    @property
    def bytes(self) -> int:
        """Memory of points, springs, hinges and what the air needs [bytes]."""
        own = 8 * (self.count * 11 + self.springs * 5 + self.hinges * 7) + self.air.bytes
        return own + (self.shell.bytes if self.shell else 0)


class AirDrag:
    """What air does to the cloth in a step."""

    def __init__(self, mesh: ClothMesh, air: Air | None):
        self.present = air is not None
        room = mesh.count if self.present else 1
        nothing = np.zeros(room)
        self.drag = Drag(
            cloth_normal=vectors(np.zeros((room, 3))),
            drag_across=numbers(nothing),
            drag_along=numbers(nothing),
        )
        self.wind = vec3(*(air.wind if air else (0.0, 0.0, 0.0)))
        self.bytes = 8 * 5 * room
        if air:
            self._factors = air.density / 2 * air.drag, air.density / 2 * air.skin_friction
            first, entry = incidence(mesh.triangles, mesh.count)
            self._tables = integers(mesh.triangles.ravel()), integers(first), integers(entry)

    def update(self, mesh: ClothMesh) -> None:
        """Find drag for where the cloth is, and how fast."""
        if self.present:
            find_drag(mesh.count, self.wind, *self._factors, *self._tables, mesh.points, self.drag)


def _together(shells: list[SheetShell]) -> Shell:
    from sim.cloth.shell.shell import Shell

    return Shell(shells)


def _near_first(parts: list[tuple[np.ndarray, ...]]) -> tuple[np.ndarray, ...]:
    """All parts as one, in the order of their points: kernels that go from point to point then find them in caches."""
    whole = [np.concatenate(part) for part in zip(*parts, strict=True)]
    order = np.lexsort(np.sort(whole[0], axis=1).T[::-1])
    return tuple(values[order] for values in whole)


def _springs(
    sheet: ClothSheet, fabric: Fabric, start: int, mass: np.ndarray, placed: np.ndarray
) -> tuple[np.ndarray, ...]:
    """Ends, lengths at rest [m], stiffness [N/m] and damping [N s/m]."""
    ends, stiffness = fabric.springs, fabric.stiffness
    if sheet.bend_model == "springs" and sheet.bend_stiffness > 0:
        ends = np.concatenate([ends, fabric.skips])
        stiffness = np.concatenate([stiffness, fabric.skip_stiffness])
    ends = ends + start
    rest = np.linalg.norm(placed[ends[:, 0]] - placed[ends[:, 1]], axis=1) * sheet.rest_scale
    one, other = mass[ends[:, 0]], mass[ends[:, 1]]
    return ends, rest, stiffness, 2 * sheet.damping * np.sqrt(stiffness * one * other / (one + other))


def _hinges(
    sheet: ClothSheet, fabric: Fabric, start: int, mass: np.ndarray, placed: np.ndarray
) -> tuple[np.ndarray, ...]:
    """Corners, angles at rest [rad], rigidity [N m], damping [N m s], and how much smaller than placed they are."""
    if sheet.bend_model != "dihedral" or sheet.bend_stiffness == 0:
        return np.zeros((0, 4), int), *(np.zeros(0) for _ in range(4))
    corners = fabric.hinges + start
    angle, slopes = fold(*(placed[corners[:, k]] for k in range(4)))
    mobility = sum((slope**2).sum(axis=1) / mass[corners[:, k]] for k, slope in enumerate(slopes))
    damping = 2 * sheet.bend_damping * np.sqrt(fabric.rigidity / np.maximum(mobility, 1e-300))
    shrinking = np.full(len(corners), min(max(sheet.rest_scale, 1e-6), 1.0))
    return corners, angle, fabric.rigidity, np.where(mobility > 0, damping, 0.0), shrinking


def fold(p: np.ndarray, q: np.ndarray, r: np.ndarray, s: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Angles [rad] of hinges and their slopes by the four points [1/m]: as `sim.cloth.fabric.bending.fold`, on the
    host."""
    edge = q - p
    length = np.linalg.norm(edge, axis=1, keepdims=True)
    one, other = np.cross(r - p, r - q), np.cross(s - q, s - p)
    along = edge / length
    by_r, by_s = one / (one**2).sum(axis=1, keepdims=True), other / (other**2).sum(axis=1, keepdims=True)

    def dot(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return (u * v).sum(axis=1, keepdims=True)

    slopes = [
        dot(r - q, along) * by_r + dot(s - q, along) * by_s,
        -dot(r - p, along) * by_r - dot(s - p, along) * by_s,
        length * by_r,
        length * by_s,
    ]
    return -np.arctan2(dot(np.cross(one, other), along), dot(one, other))[:, 0], slopes
