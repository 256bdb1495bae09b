"""One rigid body, the state of all that obey forces, and what is measured of them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from sim.geometry.mass import MassProperties
from sim.rigid.collision.shapes import ContactShape
from sim.rigid.spec import Pull


@dataclass
class RigidState:
    """Of the dynamic bodies, by name; of contacts, by the index of their bodies in the world that made it."""

    names: tuple[str, ...] = ()
    position: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """Centres of mass [m]."""
    rotation: np.ndarray = field(default_factory=lambda: np.zeros((0, 4)))
    """Of the bodies' own axes, unit quaternions w, x, y, z."""
    velocity: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """[m/s]"""
    momentum: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """Angular, about the centre of mass, in world axes [kg m^2/s]."""
    late: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """By how much both are those of an earlier time [s]."""
    fluid_force: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """That the next step begins with [N]."""
    fluid_torque: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """About the centre of mass, in world axes [N m]."""
    fluid_hold: np.ndarray = field(default_factory=lambda: np.zeros((0, 6)))
    """Both, of fluid that is held along surfaces."""
    contact_pair: np.ndarray = field(default_factory=lambda: np.zeros((0, 2), np.int32))
    """Both bodies of the contacts of the last step, in the order of these pairs."""
    contact_place: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """In the first body's axes, from its centre of mass [m]."""
    contact_force: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """On the first body, in world axes [N]."""

    def without_contacts(self) -> RigidState:
        """The bodies only, for a world that numbers its own otherwise."""
        none = RigidState()
        contacts = {name: getattr(none, name) for name in ("contact_pair", "contact_place", "contact_force")}
        return replace(self, **contacts)


@dataclass(frozen=True)
class Body:
    """One body or wall as contacts see it; `mass` only of bodies that obey forces."""

    name: str
    shape: ContactShape
    kinetic_friction: float
    static_friction: float
    restitution: float
    mass: MassProperties | None = None
    velocity: np.ndarray = field(default_factory=lambda: np.zeros(3))
    """At the start [m/s]."""
    angular_velocity: np.ndarray = field(default_factory=lambda: np.zeros(3))
    """At the start [rad/s]."""
    force: np.ndarray = field(default_factory=lambda: np.zeros(3))
    """That acts on its centre of mass all the time [N]."""
    torque: np.ndarray = field(default_factory=lambda: np.zeros(3))
    """[N m]"""
    pulls: tuple[Pull, ...] = ()

    @property
    def pivot(self) -> np.ndarray:
        """What its place is measured to, as placed: the centre of mass, where it has one [m]."""
        return self.shape.origin if self.mass is None else self.mass.centre

    @property
    def shift(self) -> np.ndarray:
        """From there to the origin of its shape, in its own axes [m]."""
        return self.shape.turn.T @ (self.shape.origin - self.pivot)

    @property
    def bounds(self) -> np.ndarray:
        """Box around it in its own axes, from the pivot [m], shape [2, 3]."""
        return self.shape.bounds + self.shift

    @property
    def size(self) -> float:
        """The least edge of that box, or the greatest where it is flat [m]."""
        extents = self.shape.bounds[1] - self.shape.bounds[0]
        return float(extents.min() if extents.min() > 0 else extents.max())


@dataclass(frozen=True)
class RigidMeasure:
    """Sums over the dynamic bodies, and extremes."""

    kinetic_energy: float
    potential_energy: float
    v_max: float
    relative_speed: float
    """The greatest speed over the body's own size [1/s]."""
    spin_max: float
    momentum: np.ndarray
    """[kg m/s], shape [3]."""
    finite: bool
