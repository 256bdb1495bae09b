"""Rigid bodies, which spray, foam and bubbles cannot enter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from sim.bodies.filmed import Body
from sim.foam.fluid import hermite


@dataclass(frozen=True)
class Motion:
    """Of a rigid body at one time."""

    position: np.ndarray
    """Of its centre of mass [m], shape [3]."""
    rotation: Rotation
    velocity: np.ndarray
    """[m/s], shape [3]."""
    angular_velocity: np.ndarray
    """[rad/s], shape [3]."""

    def towards(self, end: Motion, share: float, duration: float) -> Motion:
        """After a share of the `duration` [s] until `end`: on the cubic that fits position and velocity at both ends,
        turning evenly (Shoemake 1985)."""
        turn = Slerp([0.0, 1.0], Rotation.concatenate([self.rotation, end.rotation]))
        return Motion(
            hermite(share, duration, self.position, self.velocity, end.position, end.velocity),
            turn(share),
            (1 - share) * self.velocity + share * end.velocity,
            (1 - share) * self.angular_velocity + share * end.angular_velocity,
        )


@dataclass(frozen=True)
class Placed:
    """A body at one time."""

    body: Body
    motion: Motion

    def held(self, position: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Positions and velocities, shape [n, 3], of what sticks to the surface where it got into the body, and whether
        it did, shape [n]."""
        motion = self.motion
        local = motion.rotation.inv().apply(position - motion.position)
        inside = self.body.contains(local)
        if inside.any():
            position, velocity = position.copy(), velocity.copy()
            arm = motion.rotation.apply(self.body.nearest(local[inside]))
            position[inside] = motion.position + arm
            velocity[inside] = motion.velocity + np.cross(motion.angular_velocity, arm)
        return position, velocity, inside


@dataclass(frozen=True)
class Passing:
    """A body on its way from one frame to the next."""

    body: Body
    before: Motion
    after: Motion

    def at(self, share: float, duration: float) -> Placed:
        """After a share of the `duration` [s] between the frames."""
        return Placed(self.body, self.before.towards(self.after, share, duration))
