"""Bodies that the fluid moves: what passes between them and a pressure solver in the course of a step.

Solvers that look for pressures ask three times. What is known before, gravity, friction, contacts and the pressures of
the last step, takes bodies to where they are when pressures are looked for; those found act on them in place
of the last step's, by the equations that `sim.coupling.fluid_rigid.reaction` adds, as if nothing but the fluid held
them; and the step is made with these, contacts and all. What rests, or is held, so gives way to no more than the change
of its pressures. Where pressures follow from positions (WCSPH), bodies step as particles do, by velocity Verlet.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

from sim.bodies.movement import Movement
from sim.coupling.fluid_rigid.density_ratio import layer_mass_ratio
from sim.coupling.fluid_rigid.lubrication import Lubrication
from sim.coupling.fluid_rigid.reaction import Reaction
from sim.coupling.fluid_rigid.viscous_drag import ViscousDrag
from sim.fluid.forces.terms import Terms
from sim.fluid.system import FluidSystem
from sim.rigid.model import RigidModel

if TYPE_CHECKING:
    import trimesh


class Floating:
    """The bodies of `rigid` that obey forces, as `system.bodies`.

    rows: of these bodies, by their index, among all that move in the boundary; solids: their places there; origin of
    the system's coordinates [m]; surfaces of the bodies, as they are placed. Wrenches and responses, as
    `sim.coupling.fluid_rigid.reaction` has them, are of shape [bodies, 6].
    """

    def __init__(
        self,
        rigid: RigidModel,
        system: FluidSystem,
        rows: Mapping[int, int],
        solids: Sequence[int],
        origin: np.ndarray,
        surfaces: Sequence[trimesh.Trimesh],
    ):
        self.rigid = rigid
        self.system = system
        layer = system.spec.rest_density * system.spec.spacing
        bodies = [rigid.bodies[index] for index in rows]
        self.layer_mass_ratio = max(
            layer_mass_ratio(mesh, body.pivot, body.mass.mass, body.mass.inertia, layer)
            for mesh, body in zip(surfaces, bodies, strict=True)
            if body.mass is not None
        )
        self.reaction = Reaction(system, solids)
        self.lubrication = Lubrication(system, solids, surfaces, [body.pivot for body in bodies])
        self.reaction.lubrication = self.lubrication
        self._bodies, self._rows = np.array(list(rows)), np.array(list(rows.values()))
        self._origin = origin
        self._steady = np.zeros((len(rows), 6))
        """Wrenches of forces that act beside pressures which are looked for."""
        self._ahead = False
        """Whether bodies are foreseen to be where the step will have taken them."""
        self._here = self._local(rigid.motions())
        self._set_inertia(self._here)

    def begin(self, movements: Mapping[int, Movement]) -> None:
        """A step begins after which prescribed bodies are at these `movements`, by index; in the boundary these
        are aimed there already."""
        self._movements = movements
        if not self.system.count:
            # While there is no fluid, bodies are stepped without it.
            self._steady = np.zeros_like(self._steady)
            self.pose()

    def viscous_drag(self) -> ViscousDrag:
        return ViscousDrag(self.system, self.reaction)

    def gather_forces(self, terms: Terms) -> None:
        self._steady = self.reaction.forces(terms) + self.lubrication.steady + self._held

    def predict(self, dt: float) -> None:
        last = self.pushed
        self._push(self._steady + last)
        self._lead()
        self._here = self._local(self.rigid.predict(dt, self._movements))
        self._push(last)
        self._set_inertia(self._here)
        self._aim()
        self._expected = self._response_to(last)
        """Responses that bodies have been predicted with."""
        self._found = np.zeros_like(last)
        self._ahead = True

    def list(self) -> None:
        self.reaction.list()
        self._find_lubrication()

    def subtract_predicted(self, dt: float) -> None:
        self.reaction.subtract_predicted(dt, self._expected)

    def respond(self, ahead: float, *, beside_expected: bool = False) -> None:
        if beside_expected:
            self._last = self.reaction.respond_beside_expected(ahead, self._expected)
        else:
            self.reaction.respond(ahead)

    def gather_pressures(self, ahead: float) -> None:
        self._last = self.reaction.pressed(ahead)

    def apply_viscosity(self, dt: float, change: np.ndarray) -> None:
        masses = np.linalg.inv(self._mobility)
        force = change[:, :3] / self._inverse_mass
        wrench = np.concatenate((force, np.einsum("nij,nj->ni", masses, change[:, 3:])), axis=1) / dt
        self._steady = self._steady + wrench
        if self._ahead:
            self._shift(dt, change / dt)
        else:
            self._kick(dt, wrench)

    def apply(self, dt: float) -> None:
        wrench, response = self._last
        self._found = self._found + wrench
        self._shift(dt, response - self._expected)
        self._expected = np.zeros_like(response)

    def hold_along_surfaces(self, dt: float) -> None:
        held = self.reaction.held()
        change = held - self._held
        self._steady = self._steady + change
        self._shift(dt, self._response_to(change))
        self.rigid.fluid_hold[self._bodies] = held

    def revert(self, dt: float) -> None:
        wrench, response = self._last
        self._found = self._found - wrench
        self._shift(dt, -response)

    def commit(self, dt: float) -> dict[str, float]:
        self._push(self._steady + self._found)
        self._lead()
        self._ahead = False
        return self._advance(dt, self._found)

    def drift(self, dt: float) -> dict[str, float]:
        whole = self.pushed
        self._push(whole / 2)
        self._steady = np.zeros_like(whole)
        return self._advance(dt, whole)

    def kick(self, dt: float, terms: Terms) -> None:
        self._find_lubrication()
        self._push(self.reaction.forces(terms) + self.lubrication.steady + self.reaction.lubrication_wrenches())
        self._kick(dt / 2, self.pushed)

    def prevent_penetration(self, dt: float) -> None:
        """Bodies are thick: pressure does."""

    def _kick(self, dt: float, wrench: np.ndarray) -> None:
        impulse = np.zeros((self.rigid.count, 6))
        impulse[self._bodies] = dt * wrench
        self.rigid.kick(impulse[:, :3], impulse[:, 3:])
        self._here = self._local(self.rigid.motions())
        self._aim()
        self.system.boundary.move()

    def acting(self, index: int) -> tuple[np.ndarray, np.ndarray]:
        """Force [N] and torque about its centre of mass [N m] of the fluid on a body, by its index; where pressures are
        looked for, those of the last step."""
        wrench = (self.pushed + self._steady)[self._bodies == index][0]
        return wrench[:3], wrench[3:]

    @property
    def _held(self) -> np.ndarray:
        """Of what they hold along their surfaces in the last step: wrenches."""
        return self.rigid.fluid_hold[self._bodies]

    @property
    def pushed(self) -> np.ndarray:
        """What the fluid does to the bodies: wrenches."""
        return np.concatenate((self.rigid.fluid_force, self.rigid.fluid_torque), axis=1)[self._bodies]

    @property
    def bytes(self) -> int:
        return self.reaction.bytes

    def _find_lubrication(self) -> None:
        """Look for films where solids are near each other."""
        if self.system.count and len(self.rigid.near(self.lubrication.reach)):
            self.lubrication.find(self._here)
        else:
            self.lubrication.forget()

    def _lead(self) -> None:
        """Let bodies that the fluid pushes go as particles do: what they do to it and how far they go is then one."""
        self.rigid.fluid_driven[self._bodies] = self.rigid.fluid_force[self._bodies].any(axis=1)

    def _push(self, wrench: np.ndarray) -> None:
        self.rigid.fluid_force[self._bodies] = wrench[:, :3]
        self.rigid.fluid_torque[self._bodies] = wrench[:, 3:]

    def _advance(self, dt: float, wrench: np.ndarray) -> dict[str, float]:
        """Make the step, and keep this wrench from it."""
        stats = self.rigid.advance(dt, self._movements)
        self._push(wrench)
        self._here = self._local(self.rigid.motions())
        self._set_inertia(self._here)
        self._aim()
        return stats

    def pose(self) -> None:
        """Bodies have gone elsewhere since they were stepped."""
        self._here = self._local(self.rigid.motions())
        self._set_inertia(self._here)
        self._aim()

    def _local(self, motions: np.ndarray) -> np.ndarray:
        """Of the motions of all bodies those of the free ones, from the system's origin on."""
        mine = motions[self._bodies]
        mine[:, 9:12] -= self._origin
        return mine

    def _set_inertia(self, here: np.ndarray) -> None:
        """Set how bodies respond to forces where they are by these motions."""
        self._mobility = self.rigid.mobility(here[:, :9].reshape(-1, 3, 3), self._bodies)
        self._inverse_mass = 1.0 / self.rigid.mass[self._bodies, None]
        self.reaction.set_inertia(
            np.concatenate((here[:, 9:12], self._inverse_mass, self._mobility.reshape(-1, 9)), axis=1)
        )

    def _response_to(self, wrench: np.ndarray) -> np.ndarray:
        turning = np.einsum("nij,nj->ni", self._mobility, wrench[:, 3:])
        return np.concatenate((wrench[:, :3] * self._inverse_mass, turning), axis=1)

    def _shift(self, dt: float, response: np.ndarray) -> None:
        """Take bodies further by accelerations that act from the start of the step."""
        here = self._here
        turned = Rotation.from_rotvec(dt * dt * response[:, 3:]).as_matrix() @ here[:, :9].reshape(-1, 3, 3)
        here[:, :9] = turned.reshape(-1, 9)
        here[:, 9:12] += dt * dt * response[:, :3]
        here[:, 12:] += dt * response
        self._aim()
        self.system.boundary.move()

    def _aim(self) -> None:
        self.system.boundary.motions[self._rows] = self._here
