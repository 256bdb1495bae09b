"""What a fluid asks of what is not fluid: of emitters and drains, and of bodies and cloth that it moves."""

from typing import Protocol

import numpy as np

from sim.device.compiler import ti
from sim.fluid.forces.terms import Terms


class Exchange(Protocol):
    """Particles that come, are led, and go."""

    def lead(self) -> None:
        """Hold those that are led to their way, whatever forces there are."""

    def exchange(self, dt: float) -> bool:
        """Take out and bring in what the step dt [s] demands; returns whether there was anything."""


class ViscousDrag(Protocol):
    """Bodies that obey forces in the equations of implicit viscosity: rows as `sim.fluid.forces.body_unknowns` has
    them, and the body of each solid that is listed near a particle, or -1."""

    table: ti.Ndarray
    body_of: ti.Ndarray

    def begin(self, viscosity: float, sums: ti.Ndarray) -> None:
        """Residuals and directions, where particles have their first guess as velocity, and viscous_search.w is the
        density; viscosity: kinematic, times the step [m^2]."""

    def pull(self) -> None:
        """The images of the searches."""

    def finish(self, *, solved: bool) -> np.ndarray:
        """By how much velocities and angular velocities change, shape [bodies, 6]."""


class Bodies(Protocol):
    """What the fluid moves, bodies or cloth, as solvers talk with it in the course of a step dt [s]."""

    layer_mass_ratio: float
    """Mass of the fluid's layer around it over its own, where it is lightest."""

    def list(self) -> None:
        """Find what of them is near the particles, as the particles' lists are made."""

    def gather_forces(self, terms: Terms) -> None:
        """Note the forces that positions and velocities give, to act in the step."""

    def predict(self, dt: float) -> None:
        """Bring them to where they will be after the step, by what is known before its pressures."""

    def subtract_predicted(self, dt: float) -> None:
        """Take from the source of the pressures what has been foreseen by those of the last step."""

    def respond(self, ahead: float, *, beside_expected: bool = False) -> None:
        """Find what gives way to the pressures in position.w, and leave in pressure_acceleration.w by how much that
        lowers the second derivative of the densities of particles [kg/(m^3 s^2)]; pairs act where particles will be
        `ahead` [s]. `beside_expected`: but for what has been foreseen."""

    def gather_pressures(self, ahead: float) -> None:
        """Note the forces of the pressures found, which are in search.x."""

    def viscous_drag(self) -> ViscousDrag | None:
        """Their part in the equations of implicit viscosity, if they have one."""

    def apply_viscosity(self, dt: float, change: np.ndarray) -> None:
        """Take the changes of velocity and angular velocity by viscosity over the step, shape [bodies, 6]."""

    def apply(self, dt: float) -> None:
        """Let the forces noted last act in the step, and move what they act on to where they take it."""

    def hold_along_surfaces(self, dt: float) -> None:
        """Let what is held along surfaces by the pressures in position.w act in the step, in place of what the last
        step held."""

    def revert(self, dt: float) -> None:
        """Take back what was taken last."""

    def commit(self, dt: float) -> dict[str, float]:
        """Make the step with what was noted and taken; returns its statistics."""

    def drift(self, dt: float) -> dict[str, float]:
        """Make the step with half of the last forces; returns its statistics."""

    def kick(self, dt: float, terms: Terms) -> None:
        """Change velocities by half of the forces that positions and velocities give now, and remember them."""

    def prevent_penetration(self, dt: float) -> None:
        """Keep particles that have gone dt [s] with their velocities on their side of what is thin."""

    @property
    def bytes(self) -> int:
        """Memory of what the exchange with the fluid needs [bytes]."""
