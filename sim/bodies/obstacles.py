"""The solids of a scene as the fluid and the renderer need them: walls, surfaces, insides, and how they move."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from scene.settings import Refused
from sim.bodies.planes import PlaneWall, box_bounds, plane_of, sides_of
from sim.geometry.shapes import place
from sim.geometry.solids import Solid
from sim.geometry.spec import Plane
from sim.spec import SIDES, BoxContainer, MeshContainer, SimulationSpec

if TYPE_CHECKING:
    from sim.bodies.dynamic import Dynamic
    from sim.bodies.movement import Movement
    from sim.bodies.prescribed import Prescribed
    from sim.rigid.spec import RigidBody


@dataclass(frozen=True)
class Obstacle:
    """A body with a surface mesh. `hollow`: its inside holds the fluid, as a mesh container's does.

    The solid of a body with a motion is the one that is moved: placed as at the motion's start, whatever the time.
    """

    name: str
    solid: Solid
    hollow: bool = False
    motion: Prescribed | Dynamic | None = None

    @property
    def dynamic(self) -> Dynamic:
        """The motion of a body that obeys forces; raises ValueError for others."""
        if self.motion is None or not self.motion.obeys_forces:
            raise ValueError(f"'{self.name}' obeys no forces")
        return self.motion

    @property
    def prescribed(self) -> Prescribed:
        """The motion that the scene prescribes; raises ValueError for bodies that stand or obey forces."""
        if self.motion is None or self.motion.obeys_forces:
            raise ValueError(f"the scene prescribes no motion of '{self.name}'")
        return self.motion

    def movement(self, time: float) -> Movement | None:
        """How the solid has been moved at `time` [s]; None for one that stands."""
        return self.motion.at(time) if self.motion else None

    def centre_at(self, time: float) -> np.ndarray:
        """Where its centre is at `time` [m], shape [3]."""
        return self.motion.at(time).carry(self.centre) if self.motion else self.centre

    @functools.cached_property
    def centre(self) -> np.ndarray:
        """Centre of mass as placed [m], or of the bounding box of a surface without inside, shape [3]."""
        return self.solid.mass_properties(1.0).centre if self.solid.closed else self.solid.bounds.mean(axis=0)

    @property
    def pivot(self) -> np.ndarray:
        """The origin about which a body that moves turns, as placed [m], shape [3]; raises ValueError for one that
        stands."""
        if self.motion is None:
            raise ValueError(f"'{self.name}' stands")
        return self.motion.pivot

    @functools.cached_property
    def reach(self) -> float:
        """Greatest distance [m] of its surface from the origin about which it turns."""
        return float(np.linalg.norm(self.solid.surface.vertices - self.pivot, axis=1).max())

    @functools.cached_property
    def size(self) -> float:
        """The least edge of the box around it in its own axes, or the greatest where it is flat [m]."""
        from sim.geometry.primitives import primitive

        extents = 2 * primitive(self.solid).half
        return float(extents.min() if extents.min() > 0 else extents.max())

    @functools.cached_property
    def bounds(self) -> np.ndarray:
        """Box around all places where it comes [m], shape [2, 3]; a motion without end counts where it starts."""
        return self.motion.sweep(self.solid.surface.vertices) if self.motion else np.asarray(self.solid.bounds)

    @property
    def fastest(self) -> float:
        """The greatest speed [m/s] of its surface at any time."""
        return self.motion.fastest(self.reach) if self.motion else 0.0


@dataclass(frozen=True)
class Obstacles:
    """All solids of a scene at one time."""

    placed: list[Obstacle]
    walls: list[PlaneWall]
    boxes: dict[str, BoxContainer]

    @property
    def dynamic(self) -> dict[int, Obstacle]:
        """Bodies that obey forces, by their index in `placed`."""
        return {index: item for index, item in enumerate(self.placed) if item.motion and item.motion.obeys_forces}

    @property
    def prescribed(self) -> dict[int, Obstacle]:
        """Bodies whose motion the scene prescribes, likewise."""
        return {index: item for index, item in enumerate(self.placed) if item.motion and not item.motion.obeys_forces}

    @property
    def names(self) -> set[str]:
        """Of all bodies and containers."""
        return {item.name for item in self.placed} | {wall.body for wall in self.walls} | set(self.boxes)

    def planes(self) -> np.ndarray:
        """Normals and offsets of all walls, shape [n, 4]."""
        return np.array([[*wall.normal, wall.offset] for wall in self.walls]).reshape(-1, 4)

    @property
    def endless(self) -> bool:
        """Whether a body moves on for ever as the scene prescribes."""
        return any(item.prescribed.endless for item in self.prescribed.values())

    def bounds(self) -> list[np.ndarray]:
        """Boxes around everything that ends somewhere [m], each of shape [2, 3]."""
        return [item.bounds for item in self.placed] + self.box_bounds()

    def next_keyframe(self, time: float) -> float:
        """The first time after `time` [s] at which the velocity of a body jumps; infinite where none does."""
        return min((item.motion.next_keyframe(time) for item in self.placed if item.motion), default=math.inf)

    def box_surfaces(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """The closed sides of the box containers, facing inward: vertices [m] and triangles."""
        return {name: _box_surface(container) for name, container in self.boxes.items()}

    def box_bounds(self) -> list[np.ndarray]:
        """The box containers' inner boxes [m], each of shape [2, 3]."""
        return [box_bounds(container) for container in self.boxes.values()]


def find_obstacles(spec: SimulationSpec, folder: Path) -> Obstacles:
    """Load and place every rigid body and container; raises Refused with the path in the scene."""
    placed: list[Obstacle] = []
    walls: list[PlaneWall] = []
    boxes: dict[str, BoxContainer] = {}
    for name, body in (spec.rigid.bodies if spec.rigid else {}).items():
        if isinstance(body.shape, Plane):
            walls.append(plane_of(name, body.shape, body))
        else:
            placed.append(_body(name, body, folder))
    for name, container in spec.containers.items():
        if isinstance(container, BoxContainer):
            boxes[name] = container
            walls += sides_of(name, container)
        else:
            solid = _placed(container, folder, ("containers", name))
            placed.append(Obstacle(name, solid, hollow=True))
    return Obstacles(placed, walls, boxes)


def _body(name: str, body: RigidBody, folder: Path) -> Obstacle:
    motion: Prescribed | Dynamic | None = None
    if body.motion == "prescribed":
        from sim.bodies.prescribed import Prescribed

        motion = Prescribed(body)
        if body.keyframes:
            first = body.keyframes[0]
            turned = body.rotation if first.rotation is None else first.rotation
            body = body.model_copy(update={"position": first.position, "rotation": turned})
    location = ("rigid", "bodies", name)
    solid = _placed(body, folder, location)
    if body.motion == "dynamic":
        motion = _dynamic(body, solid, location)
    return Obstacle(name, solid, motion=motion)


def _dynamic(body: RigidBody, solid: Solid, location: tuple[str, ...]) -> Dynamic:
    from sim.bodies.dynamic import Dynamic
    from sim.bodies.movement import Movement

    try:
        mass = solid.mass_properties(body.density)
    except Refused as refused:
        raise refused.at(*location, "shape") from None
    velocities = np.array(body.velocity), np.array(body.angular_velocity)
    return Dynamic(Movement(mass.centre, mass.centre, np.eye(3), *velocities), solid.pose.rotation)


def _placed(body: RigidBody | MeshContainer, folder: Path, location: tuple[str, ...]) -> Solid:
    try:
        return place(body.shape, body, folder)
    except Refused as refused:
        raise refused.at(*location, *(() if refused.location else ("shape",))) from None


def _box_surface(container: BoxContainer) -> tuple[np.ndarray, np.ndarray]:
    corners = np.array([[(i >> axis) & 1 for axis in range(3)] for i in range(8)])
    low, high = box_bounds(container)
    faces = []
    for index, side in enumerate(SIDES):
        if side in container.open:
            continue
        axis, upper = divmod(index, 2)
        u, v = (1 << ((axis + 1) % 3)), (1 << ((axis + 2) % 3))
        base = (1 << axis) if upper else 0
        quad = [base, base + u, base + u + v, base + v]
        quad = quad[::-1] if upper else quad
        faces += [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]
    return low + corners * (high - low), np.array(faces)
