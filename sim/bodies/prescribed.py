"""Motion that a scene prescribes: a function of time alone.

A keyframe says where the body's own origin is (`position` of a placement: the centre of a built-in shape, the anchor of
a mesh) and how the body is turned about it (`rotation` of a placement). Between two keyframes the origin moves straight
at constant velocity, and the body turns about one axis at constant angular velocity, which is the spherical linear
interpolation of quaternions (Shoemake 1985). Before the first and after the last keyframe it is at rest. Without
keyframes it rests where it is placed until its `start`, and then keeps its velocity and angular velocity.
"""

from __future__ import annotations

import bisect
import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numpy as np
from scipy.spatial.transform import Rotation

from scene.events import TIME_TOLERANCE
from sim.bodies.movement import Movement
from sim.geometry.pose import rotation_matrix


class Led(Protocol):
    """What a scene says of something that it leads: keyframes, or velocities from `start` on."""

    @property
    def position(self) -> Sequence[float]: ...
    @property
    def rotation(self) -> Sequence[Any]: ...
    @property
    def velocity(self) -> Sequence[float]: ...
    @property
    def angular_velocity(self) -> Sequence[float]: ...
    @property
    def start(self) -> float | None: ...
    @property
    def keyframes(self) -> Sequence[Any]:
        """Each with `at`, `position` and `rotation`."""


@dataclass(frozen=True)
class _Piece:
    """Constant velocities from a time [s] on."""

    start: float
    position: np.ndarray
    rotation: np.ndarray
    velocity: np.ndarray
    angular_velocity: np.ndarray

    def speed_within(self, reach: float) -> float:
        return float(np.linalg.norm(self.velocity) + reach * np.linalg.norm(self.angular_velocity))


class Prescribed:
    """The motion of one body with `motion: prescribed`, or of the pinned points of a cloth.

    Velocities at the time of a keyframe are those after it.
    """

    obeys_forces: Literal[False] = False

    def __init__(self, body: Led):
        self._pieces = _between_keyframes(body) if body.keyframes else _constant(body)
        self._starts = [piece.start for piece in self._pieces]
        self.pivot = self._pieces[0].position
        """The body's own origin as its shape is placed: at the first keyframe [m], shape [3]."""
        self.turn = self._pieces[0].rotation
        """The rotation with which its shape is placed, shape [3, 3]."""

    def at(self, time: float) -> Movement:
        """Where the body is at `time` [s]."""
        piece = self._pieces[bisect.bisect_right(self._starts, time + TIME_TOLERANCE) - 1]
        passed = time - piece.start if math.isfinite(piece.start) else 0.0
        rotation = Rotation.from_rotvec(passed * piece.angular_velocity).as_matrix() @ piece.rotation
        return Movement(
            pivot=self.pivot,
            position=piece.position + passed * piece.velocity,
            rotation=rotation @ self.turn.T,
            velocity=piece.velocity,
            angular_velocity=piece.angular_velocity,
        )

    def next_keyframe(self, time: float) -> float:
        """The first time after `time` [s] at which velocities change; infinite where none does."""
        later = bisect.bisect_right(self._starts, time + TIME_TOLERANCE)
        return self._starts[later] if later < len(self._starts) else math.inf

    def jumps(self, time: float) -> bool:
        """Whether velocities change at `time` [s]."""
        return self.next_keyframe(time - 2 * TIME_TOLERANCE) <= time + TIME_TOLERANCE

    def fastest(self, reach: float) -> float:
        """The greatest speed [m/s] at any time within `reach` [m] of the body's own origin."""
        return max(piece.speed_within(reach) for piece in self._pieces)

    @property
    def endless(self) -> bool:
        """Whether it goes on for ever."""
        return bool(self._pieces[-1].velocity.any())

    def sweep(self, points: np.ndarray) -> np.ndarray:
        """Box [m], shape [2, 3], around the ways of points of the placed shape [m], shape [n, 3].

        Turns count as whole ones. Of a motion without end only its start counts.
        """
        boxes = []
        for piece, after in zip(self._pieces, [*self._pieces[1:], self._pieces[-1]], strict=True):
            low, high = _turned_box((points - self.pivot) @ (piece.rotation @ self.turn.T).T, piece.angular_velocity)
            boxes += [(low + place, high + place) for place in (piece.position, after.position)]
        return np.array([np.min([low for low, _ in boxes], axis=0), np.max([high for _, high in boxes], axis=0)])


def _turned_box(arms: np.ndarray, angular_velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper corner of the box around the circles on which `arms`, shape [n, 3], turn about the origin."""
    speed = np.linalg.norm(angular_velocity)
    if speed == 0:
        return arms.min(axis=0), arms.max(axis=0)
    axis = angular_velocity / speed
    middles = (arms @ axis)[:, None] * axis
    half = np.linalg.norm(arms - middles, axis=1)[:, None] * np.sqrt(np.maximum(1 - axis**2, 0.0))
    return (middles - half).min(axis=0), (middles + half).max(axis=0)


def _constant(body: Led) -> list[_Piece]:
    """At rest up to the start, then in steady motion."""
    place, turn = np.array(body.position), rotation_matrix(body.rotation)
    return [
        _Piece(-math.inf, place, turn, np.zeros(3), np.zeros(3)),
        _Piece(body.start or 0.0, place, turn, np.array(body.velocity), np.array(body.angular_velocity)),
    ]


def _between_keyframes(body: Led) -> list[_Piece]:
    """At rest up to the first keyframe, moving from each to the next, at rest from the last on."""
    rest = np.zeros(3)
    keys = body.keyframes
    turns = [rotation_matrix(body.rotation if key.rotation is None else key.rotation) for key in keys]
    places = [np.array(key.position) for key in keys]
    pieces = [_Piece(-math.inf, places[0], turns[0], rest, rest)]
    for k, (earlier, later) in enumerate(itertools.pairwise(keys)):
        seconds = later.at - earlier.at
        turn = Rotation.from_matrix(turns[k + 1] @ turns[k].T).as_rotvec()
        pieces.append(_Piece(earlier.at, places[k], turns[k], (places[k + 1] - places[k]) / seconds, turn / seconds))
    return [*pieces, _Piece(keys[-1].at, places[-1], turns[-1], rest, rest)]
