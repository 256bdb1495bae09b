"""Where bodies are and how they move, and their arrays for kernels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from sim.bodies.movement import Movement
from sim.rigid.body import Body, RigidState
from sim.rigid.collision.arrays import integers
from sim.rigid.dynamics import free_motion
from sim.rigid.layout import BodyProperties, Loads, Motion, StepVelocities

SAVED = {
    "position": "position",
    "rotation": "rotation",
    "velocity": "velocity",
    "momentum": "momentum",
    "late": "velocity_lag",
    "fluid_force": "fluid_force",
    "fluid_torque": "fluid_torque",
    "fluid_hold": "fluid_hold",
}
"""What a state has of each dynamic body, and what it is called here."""


class RigidBodies:
    """All bodies and walls of a world, planes last. Positions are in world coordinates, of the bodies' pivots."""

    def __init__(self, bodies: Sequence[Body], state: RigidState):
        self.bodies = bodies
        self.count = len(bodies)
        self.dynamic = np.array([body.mass is not None for body in bodies])
        """Whether bodies obey forces, shape [bodies]."""
        self.mass = np.array([body.mass.mass if body.mass else np.inf for body in bodies])
        self.size = np.array([body.size for body in bodies])
        self._weigh()
        self._place(state)

    def _weigh(self) -> None:
        """Inertia in the bodies' own axes, and the forces on them."""
        turns = [body.shape.turn for body in self.bodies]
        tensors = [body.mass.inertia if body.mass else np.eye(3) for body in self.bodies]
        self._placed = np.array(turns)
        inertia = np.array([turn.T @ tensor @ turn for turn, tensor in zip(turns, tensors, strict=True)])
        self._inverse_inertia = np.linalg.inv(inertia) * self.dynamic[:, None, None]
        self._force = np.array([body.force for body in self.bodies], dtype=np.float64)
        self._torque = np.array([body.torque for body in self.bodies], dtype=np.float64)

    def _place(self, state: RigidState) -> None:
        """Where bodies are, and how fast: as placed, or as in `state`."""
        self._pivots = np.array([body.pivot for body in self.bodies], dtype=np.float64)
        self.position = self._pivots.copy()
        self.rotation = np.array([quaternion(body.shape.turn) for body in self.bodies])
        self.velocity = np.array([body.velocity for body in self.bodies], dtype=np.float64)
        self.momentum = np.array(
            [body.mass.inertia @ body.angular_velocity if body.mass else np.zeros(3) for body in self.bodies]
        )
        self.spin = np.zeros((self.count, 3))
        self.fluid_force, self.fluid_torque = np.zeros((2, self.count, 3))
        """Of the fluid on bodies, about their centres of mass [N] and [N m]; whoever couples them keeps them."""
        self.fluid_hold = np.zeros((self.count, 6))
        """Both, of fluid that bodies hold along their surfaces."""
        self.velocity_lag = np.zeros(self.count)
        """By how much velocities and momenta are those of an earlier time [s]."""
        self.fluid_driven = np.zeros(self.count, np.int32)
        """1 where a body is to go by its velocity at the end of a step, as fluid that moves it does."""
        row = {name: index for index, name in enumerate(state.names)}
        for k in np.flatnonzero(self.dynamic).tolist():
            if self.bodies[k].name in row:
                for saved, name in SAVED.items():
                    getattr(self, name)[k] = getattr(state, saved)[row[self.bodies[k].name]]
        self._make_packs()
        self._turn()

    def _make_packs(self) -> None:
        self.inverse_inertia = np.zeros((self.count, 3, 3))
        """As bodies are turned before a step, in world axes [1/(kg m^2)]."""
        self._shared = {
            "position": self.position,
            "rotation": self.rotation,
            "inverse_mass": np.where(self.dynamic, 1 / self.mass, 0.0),
            "inverse_inertia": self.inverse_inertia,
        }
        self.motion: Motion = self.moving_as(self.velocity, self.spin, self.momentum)
        self.properties = BodyProperties(
            dynamic=integers(self.dynamic),
            fluid_driven=self.fluid_driven,
            velocity_lag=self.velocity_lag,
            mass=np.where(self.dynamic, self.mass, 1.0),
            own_inverse_inertia=self._inverse_inertia,
        )
        self._loads = Loads(
            force=self._force, torque=self._torque, fluid_force=self.fluid_force, fluid_torque=self.fluid_torque
        )
        self.free_velocity, self.free_spin, self.old_velocity, self.old_spin, middle = np.zeros((5, self.count, 3))
        self.step_velocities = StepVelocities(
            old_velocity=self.old_velocity,
            old_spin=self.old_spin,
            free_velocity=self.free_velocity,
            free_spin=self.free_spin,
            middle_velocity=middle,
        )

    def moving_as(
        self, velocity: np.ndarray, spin: np.ndarray, momentum: np.ndarray, **otherwise: np.ndarray
    ) -> Motion:
        """The same bodies at other velocities, or with others of the members of `Motion`."""
        return Motion(**(self._shared | otherwise), velocity=velocity, spin=spin, momentum=momentum)

    def _turn(self) -> None:
        """Find angular velocities, to the bit as a step leaves them: the next one depends on them."""
        free_motion.turn(self.count, self.properties, self.motion)

    @property
    def _kept(self) -> tuple[np.ndarray, ...]:
        """What a step changes."""
        return self.position, self.rotation, self.velocity, self.spin, self.momentum, self.velocity_lag

    def kick(self, impulse: np.ndarray, turning: np.ndarray) -> None:
        """Change velocities at once by impulses at the centres of mass [N s] and about them [N m s], shape [n, 3]."""
        dynamic = self.dynamic
        self.velocity[dynamic] += impulse[dynamic] / self.mass[dynamic, None]
        self.momentum[dynamic] += turning[dynamic]
        self._turn()

    def apply_response(
        self, bodies: np.ndarray, impulse: np.ndarray, displacement: np.ndarray, turn: np.ndarray
    ) -> None:
        """Take bodies further by displacements [m] and turns [rad], with impulses [N s] and [N m s], shape [n, 6], that
        they got on it."""
        self.position[bodies] += displacement
        turned = Rotation.from_rotvec(turn) * rotations(self.rotation[bodies])
        self.rotation[bodies] = np.roll(turned.as_quat(), 1, axis=1)
        whole = np.zeros((self.count, 6))
        whole[bodies] = impulse
        self.kick(whole[:, :3], whole[:, 3:])

    def _steer(self, dt: float, movements: Mapping[int, Movement]) -> None:
        """Velocities that take bodies to where they are to be."""
        for k, now in movements.items():
            target = Rotation.from_matrix(now.rotation @ self.bodies[k].shape.turn)
            self.velocity[k] = (now.carry(self._pivots[k]) - self.position[k]) / dt
            self.spin[k] = (target * rotations(self.rotation[k]).inv()).as_rotvec() / dt

    def land(self, movements: Mapping[int, Movement]) -> None:
        """Put bodies that do not obey forces to where they are."""
        for k, now in movements.items():
            self.position[k] = now.carry(self._pivots[k])
            self.rotation[k] = quaternion(now.rotation @ self.bodies[k].shape.turn)

    def mobility(self, turned: np.ndarray, bodies: np.ndarray) -> np.ndarray:
        """Inverse inertia of `bodies` in world axes [1/(kg m^2)], when `turned` so far since they were placed."""
        turn = turned @ self._placed[bodies]
        return turn @ self._inverse_inertia[bodies] @ turn.transpose(0, 2, 1)

    def motions(self) -> np.ndarray:
        """How bodies have moved since they were placed: rotation by rows, position [m], velocity [m/s] and angular
        velocity [rad/s]; shape [bodies, 18]."""
        turned = matrices(self.rotation) @ self._placed.transpose(0, 2, 1)
        return np.concatenate((turned.reshape(-1, 9), self.position, self.velocity, self.spin), axis=1)

    def movement(self, index: int) -> Movement:
        """Where a body is now."""
        return self.movements([index])[0]

    def movements(self, indices: Sequence[int]) -> list[Movement]:
        """Where each of some bodies is now."""
        chosen = np.asarray(indices, np.int64)
        turned = matrices(self.rotation[chosen]) @ self._placed[chosen].transpose(0, 2, 1)
        parts = self._pivots[chosen], self.position[chosen], turned, self.velocity[chosen], self.spin[chosen]
        return [Movement(*values) for values in zip(*parts, strict=True)]

    def leave_fluid(self) -> None:
        """Feel nothing more of what fluid did in the last step: there is none now."""
        for done in (self.fluid_force, self.fluid_torque, self.fluid_hold, self.fluid_driven):
            done.fill(0)


def rotations(quaternions: np.ndarray) -> Rotation:
    """Of w, x, y, z, shape [4] or [n, 4]."""
    return Rotation.from_quat(np.roll(quaternions, -1, axis=-1))


def matrices(quaternions: np.ndarray) -> np.ndarray:
    """Of w, x, y, z, shape [n, 4], as matrices, shape [n, 3, 3]."""
    return rotations(quaternions).as_matrix() if len(quaternions) else np.zeros((0, 3, 3))


def quaternion(matrix: np.ndarray) -> np.ndarray:
    """w, x, y, z of a rotation matrix."""
    return np.roll(Rotation.from_matrix(matrix).as_quat(), 1)
