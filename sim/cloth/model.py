"""The cloth of a world: all sheets, stepped together."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from scene.settings import Refused
from sim.cloth import load_integrator
from sim.cloth.contact.applied_forces import pulls
from sim.cloth.contact.collision import Collisions
from sim.cloth.contact.detection.surfaces import Surface
from sim.cloth.contact.dynamic_solids import Bodies, BodyCoupling
from sim.cloth.contact.solids import Solids
from sim.cloth.fabric.arrays import clear, integers, vectors
from sim.cloth.fabric.energy import ClothMeasure, Meter
from sim.cloth.fabric.fabric import Fabric, weave
from sim.cloth.fabric.mesh import ClothMesh
from sim.cloth.fabric.pin_places import put
from sim.cloth.fabric.pins import MovedPoints, find_pins, refuse_jump
from sim.cloth.fabric.state import ClothState
from sim.cloth.spec import Cloth, ClothSheet
from sim.geometry.pose import Pose

if TYPE_CHECKING:
    from sim.cloth.shell.sheet import SheetShell


@dataclass(frozen=True)
class PlacedSheet:
    """A sheet as the scene places it."""

    name: str
    sheet: ClothSheet
    fabric: Fabric
    held: np.ndarray
    pinned: list[MovedPoints]
    """Those that pins move."""
    moved: np.ndarray | None = None
    """Where its points begin instead, since it is placed through something [m], shape [n, 3]."""
    shell: SheetShell | None = None
    """What it is instead of springs and hinges, with `model: fem`."""

    @property
    def begins(self) -> np.ndarray:
        """Where its points begin [m], shape [n, 3]."""
        return self.fabric.points if self.moved is None else self.moved

    @property
    def rest(self) -> np.ndarray:
        """Where its points are in the cloth when that is at rest, in the sheet's own axes [m], shape [n, 3]."""
        pose = Pose.of(self.sheet)
        return self.sheet.rest_scale * pose.scale * pose.to_local(self.fabric.points)

    @property
    def bounds(self) -> np.ndarray:
        """Box around it as placed and around where pins move it [m], shape [2, 3]."""
        places = [self.begins, *(part.motion.sweep(part.placed) for part in self.pinned)]
        return np.array(
            [np.min([p.min(axis=0) for p in places], axis=0), np.max([p.max(axis=0) for p in places], axis=0)]
        )


def find_sheets(cloth: Cloth, folder: Path) -> list[PlacedSheet]:
    """All sheets of a scene; raises Refused with the path in the scene."""
    found = []
    for name, sheet in cloth.sheets.items():
        try:
            fabric = weave(sheet, folder)
            shell = _find_shell(sheet, fabric) if cloth.model == "fem" else None
            found.append(PlacedSheet(name, sheet, fabric, *find_pins(sheet, fabric), shell=shell))
        except Refused as refused:
            raise refused.at("cloth", "sheets", name) from None
    return found


def _find_shell(sheet: ClothSheet, fabric: Fabric) -> SheetShell:
    from sim.cloth.shell.sheet import find_shell

    return find_shell(sheet, fabric)


def shells_of(sheets: list[PlacedSheet]) -> list[SheetShell] | None:
    """What they are instead of springs and hinges; None with these."""
    shells = [item.shell for item in sheets if item.shell]
    return shells or None


class ClothModel:
    """Sheets that move; those in `state` go on from there, others begin as placed."""

    def __init__(
        self,
        sheets: list[PlacedSheet],
        gravity: np.ndarray,
        settings: Cloth,
        state: ClothState,
        time: float,
        solids: Solids | None = None,
    ):
        solids = solids or Solids.none()
        self.sheets = sheets
        self.settings = settings
        starts = np.cumsum([0] + [len(item.fabric.points) for item in sheets]).tolist()
        self._rows = {item.name: slice(a, b) for item, a, b in zip(sheets, starts, starts[1:], strict=False)}
        self._pinned = [
            part.shifted(start) for item, start in zip(sheets, starts, strict=False) for part in item.pinned
        ]
        position, velocity = (
            np.concatenate(parts) for parts in zip(*(_begin(item, state) for item in sheets), strict=True)
        )
        self.mesh = ClothMesh(
            [item.sheet for item in sheets],
            [item.fabric for item in sheets],
            position,
            velocity,
            np.concatenate([item.held for item in sheets]),
            settings.air,
            gravity,
            solids.points,
            shells_of(sheets),
        )
        self.solids = solids
        self._gravity = np.asarray(gravity)
        self.collisions = self._collisions()
        if len(state.touch_key):
            limit, normal_force, friction_force = np.split(state.touch_force, [1, 2], axis=1)
            forces = limit[:, 0], normal_force[:, 0], friction_force
            self.collisions.remember(state.touch_key, state.touch_weight, state.touch_normal, *forces)
        self._refuse_jumps(position, time)
        integrator = load_integrator(settings.integrator, settings.model)
        self.integrator = integrator(self.mesh, gravity, settings, self.collisions)
        if self.integrator.past and len(state.past_position) == self.mesh.count:
            self.integrator.past.recall(state.past_position, state.past_velocity, state.past_step)
        self._meter = Meter(self.mesh)
        self.fluid_force = vectors(_fluid_force(sheets, state))
        """On points, in the last step [N]."""
        self.stuck = 0
        """Pairs that came too near in the last step, since solids push them together."""
        self.unsolved = False
        """Whether the integrator ended the last step far from a solution."""
        self._solid_rows = integers(np.arange(self.mesh.count, self.mesh.total))
        self._pinned_rows = integers(np.concatenate([np.zeros(0, int), *(part.points for part in self._pinned)]))

    def _collisions(self) -> Collisions:
        counts = [len(item.fabric.points) for item in self.sheets]
        half = np.repeat([item.sheet.thickness / 2 for item in self.sheets], counts)
        friction = np.repeat([item.sheet.friction_coefficients for item in self.sheets], counts, axis=0)
        of_solids = np.column_stack([self.solids.kinetic_friction, self.solids.static_friction])
        own = self.mesh.count
        return Collisions(
            self.mesh,
            Surface.of(self.solids.triangles + own) if len(self.solids.triangles) else None,
            self.solids.walls,
            np.concatenate([half, np.zeros(len(self.solids.points))]),
            np.concatenate([friction, of_solids]),
            BodyCoupling(self._owner(), own),
            self.solids.made,
        )

    def _owner(self) -> np.ndarray:
        """Of points of solids, the row of their body among those that obey forces; -1 of others."""
        rows = {body: row for row, body in enumerate(self.solids.dynamic)}
        return np.array([rows.get(body, -1) for body in self.solids.body], int)

    def advance(
        self, dt: float, until: float, moved: np.ndarray | None = None, bodies: Bodies | None = None
    ) -> dict[str, float]:
        """Step by dt [s] to the time `until` [s], when points of solids are `moved` [m]; returns what the integrator
        reports."""
        self.set_targets(dt, until, moved, bodies)
        return self.note(self.integrator.advance(dt))

    def set_targets(
        self, dt: float, until: float, moved: np.ndarray | None = None, bodies: Bodies | None = None
    ) -> None:
        """Say where held points are at the time `until` [s], after a step of dt [s], and points of solids, which are
        `moved` [m] by then, unless they belong to `bodies` that give way; and find the drag of air."""
        if moved is not None:
            put(len(moved), self._solid_rows, moved, self.mesh.place)
            if bodies is not None:
                self.collisions.bodies.predict(bodies, moved, dt)
        if self._pinned:
            targets = np.concatenate([part.at(until) for part in self._pinned])
            put(len(targets), self._pinned_rows, targets, self.mesh.place)
        self.mesh.air.update(self.mesh)

    def note(self, stats: dict[str, float]) -> dict[str, float]:
        """Remember of what the integrator reports whether solids leave no room, and whether it found a solution."""
        self.stuck = int(stats.get("cloth_stuck", 0))
        self.unsolved = stats.get("cloth_unsolved", 0) > 0
        return stats

    def leave_fluid(self) -> None:
        """Feel nothing more of what fluid did in the last step: there is none now."""
        clear(self.fluid_force)

    def settle_solids(self, places: np.ndarray) -> None:
        """Say where points of solids came to be [m], since bodies gave way."""
        put(len(places), self._solid_rows, places, self.mesh.points.position)

    def measure(self) -> ClothMeasure:
        """Energies and extremes as they are now."""
        return self._meter.read()

    def step_limits(self) -> dict[str, float]:
        """Largest steps [s] by what limits them."""
        return {"cloth step": self.settings.max_step} | self.integrator.limits()

    def limiting_term(self, term: str) -> tuple[str, str]:
        """What one of `step_limits` comes from, and what would help."""
        return ("cloth.max_step", "raise it") if term == "cloth step" else self.integrator.limiting_term(term)

    def next_keyframe(self, time: float) -> float:
        """The first time after `time` [s] at which the velocity of a pin jumps; infinite where none does."""
        return min((part.motion.next_keyframe(time) for part in self._pinned), default=np.inf)

    def state(self) -> ClothState:
        """What a checkpoint keeps: points, contacts with their forces, and the force of the fluid."""
        counts = {item.name: len(item.fabric.points) for item in self.sheets}
        points = self.mesh.points
        count, contacts = self.mesh.count, self.collisions.contacts
        return ClothState(
            counts,
            points.position.to_numpy()[:count],
            points.velocity.to_numpy()[:count],
            contacts.key.copy(),
            contacts.weight.copy(),
            contacts.normal.copy(),
            np.column_stack([contacts.limit, contacts.normal_force, contacts.friction_force]),
            self.fluid_force.to_numpy()[:count],
            *(self.integrator.past.arrays() if self.integrator.past else ()),
        )

    def vertices(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Positions [m] and velocities [m/s] of one sheet's points, shape [n, 3]."""
        points, rows = self.mesh.points, self._rows[name]
        return points.position.to_numpy()[rows], points.velocity.to_numpy()[rows]

    def pin_force(self, name: str) -> np.ndarray:
        """Force of the pins on one sheet [N], shape [3], as if they did not accelerate."""
        rows = self._rows[name]
        held = self.mesh.held[rows]
        weight = self.mesh.mass[rows, None] * self._gravity
        force = pulls(self.mesh)[rows] + self.fluid_force.to_numpy()[rows] + weight
        return -force[held].sum(axis=0)

    @property
    def bytes(self) -> int:
        """Memory of the mesh and of the integrator with its contacts [bytes]."""
        return self.mesh.bytes + self.integrator.bytes

    def _refuse_jumps(self, position: np.ndarray, time: float) -> None:
        for part in self._pinned:
            name = next(name for name, rows in self._rows.items() if rows.start <= part.points[0] < rows.stop)
            size = float(np.ptp(self.mesh.placed[self._rows[name]], axis=0).max())
            refuse_jump(name, part, position[part.points], size, time)


def _fluid_force(sheets: list[PlacedSheet], state: ClothState) -> np.ndarray:
    count = sum(len(item.fabric.points) for item in sheets)
    same = list(state.sheets) == [item.name for item in sheets] and len(state.fluid_force) == count
    return state.fluid_force if same else np.zeros((count, 3))


def _begin(item: PlacedSheet, state: ClothState) -> tuple[np.ndarray, np.ndarray]:
    """Positions [m] and velocities [m/s] of a sheet's points."""
    found = state.of(item.name)
    if found is not None and len(found[0]) == len(item.fabric.points):
        return found
    velocity = np.where(item.held[:, None], 0.0, np.array(item.sheet.velocity))
    return item.begins, velocity
