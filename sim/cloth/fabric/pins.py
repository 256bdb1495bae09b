"""Which mass points are held, and where pins take them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np

from scene.settings import Refused
from sim.bodies.prescribed import Prescribed
from sim.cloth.fabric.fabric import Fabric
from sim.cloth.spec import ClothSheet, Pin


@dataclass(frozen=True)
class MovedPoints:
    """Points that a pin moves together; `placed` is where they were placed [m], shape [n, 3]."""

    points: np.ndarray
    placed: np.ndarray
    motion: Prescribed

    def at(self, time: float) -> np.ndarray:
        """Where they are to be at `time` [s], in metres, shape [n, 3]."""
        return self.motion.at(time).carry(self.placed)

    @property
    def fastest(self) -> float:
        """The greatest speed of a point at any time [m/s]."""
        return self.motion.fastest(float(np.linalg.norm(self.placed - self.motion.pivot, axis=1).max()))

    def shifted(self, start: int) -> MovedPoints:
        """The same points in a mesh that numbers the sheet's from `start` on."""
        return replace(self, points=self.points + start)


ELSEWHERE = 1e-3
"""A pin may not take points by more than this share of their sheet's size at once."""


def refuse_jump(sheet: str, moved: MovedPoints, position: np.ndarray, size: float, time: float) -> None:
    """Raise Refused where points that a pin moves and are at `position` [m], shape [n, 3], would be elsewhere at once;
    size: of their sheet [m]."""
    jump = float(np.linalg.norm(moved.at(time) - position, axis=1).max())
    if jump > ELSEWHERE * size:
        raise Refused(
            f"a pin would take points {jump:.3g} m elsewhere at once at {time:g} s",
            location=("cloth", "sheets", sheet, "pins"),
            remedy="let its first keyframe have no offset, or give pins without keyframes",
        )


def find_pins(sheet: ClothSheet, fabric: Fabric) -> tuple[np.ndarray, list[MovedPoints]]:
    """Whether each point is held, and those of them that are moved; raises Refused, located within the sheet."""
    held = np.zeros(len(fabric.points), bool)
    moved: list[MovedPoints] = []
    for index, pin in enumerate(sheet.pins):
        pin = Pin(at=pin) if isinstance(pin, str) else pin
        points = fabric.sides[pin.at] if isinstance(pin.at, str) else _next_to(fabric, pin, index)
        twice = np.intersect1d(points, np.concatenate([[-1], *(other.points for other in moved)]))
        if len(twice):
            raise Refused(
                f"a point at {np.round(fabric.points[int(twice[0])], 3).tolist()} is led by another pin already",
                location=("pins", index),
                remedy="let each point be led by one pin only",
            )
        held[points] = True
        if pin.keyframes or any(pin.velocity) or any(pin.angular_velocity):
            moved.append(MovedPoints(points, fabric.points[points], _motion(pin, fabric.points[points].mean(axis=0))))
    return held, moved


def _next_to(fabric: Fabric, pin: Pin, index: int) -> np.ndarray:
    from scipy.spatial import cKDTree

    if not pin.at:
        raise Refused("a pin without places holds nothing", location=("pins", index, "at"), remedy="give places")
    distance, points = cKDTree(fabric.points).query(np.array(pin.at))
    size = float(np.ptp(fabric.points, axis=0).max())
    if distance.max() > 0.1 * size:
        place = pin.at[int(distance.argmax())]
        raise Refused(
            f"the place {list(place)} is {distance.max():.3g} m off the cloth as it is placed",
            location=("pins", index, "at"),
            remedy="give places on the cloth, in coordinates of the world",
        )
    return np.unique(points)


def _motion(pin: Pin, middle: np.ndarray) -> Prescribed:
    keys = [
        SimpleNamespace(at=key.at, position=middle + np.array(key.offset), rotation=key.rotation)
        for key in pin.keyframes
    ]
    body = SimpleNamespace(
        position=keys[0].position if keys else middle,
        rotation=keys[0].rotation if keys else (),
        velocity=pin.velocity,
        angular_velocity=pin.angular_velocity,
        start=0.0,
        keyframes=keys,
    )
    motion = Prescribed(body)
    # Offsets and turns are from where the points were placed, whatever the first keyframe says.
    motion.pivot, motion.turn = middle, np.eye(3)
    return motion
