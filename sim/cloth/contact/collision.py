"""What cloth touches: found by where its points come from and go, and kept from step to step with its forces.

Given where points were and where an integrator takes them, `find` adds the pairs of a point and a triangle, or of two
edges, that come nearer than their thickness on the way: the integrator has to keep those apart, and to ask again. When
nothing is new, or it was asked often enough, `hold_back` lets points go so far together that nothing passes through.
"""

from __future__ import annotations

import numpy as np

from sim.cloth.contact import augmented_lagrangian
from sim.cloth.contact.contact_set import ContactSet, among
from sim.cloth.contact.contact_tables import ContactTables
from sim.cloth.contact.detection.detector import EARLY, Detector
from sim.cloth.contact.detection.search import PLANE
from sim.cloth.contact.detection.surfaces import Surface
from sim.cloth.contact.dynamic_solids import BodyCoupling, wrenches
from sim.cloth.contact.impact_zones import ImpactZones
from sim.cloth.contact.solids import Wall
from sim.cloth.fabric.layout import Contacts, ProjectedContacts
from sim.cloth.fabric.mesh import ClothMesh
from sim.device.compiler import ti

NEAR = 1.2
"""Contacts are forgotten from this many thicknesses on."""
SHARE = 0.2
"""Of what the thickness lacks, at most so much is made up for in a step."""
PATIENCE, PATIENCE_WITH_BODIES = 0.025, 0.1
"""And no sooner than in this time [s]: what is pushed keeps the speed, and bodies are heavy."""
HALVINGS = 40
"""Of how far the displacements of points that would pass one another differ."""


class Collisions:
    """All contacts of the cloth of a scene. `half`: half the thickness at points [m]; friction: coefficients of points
    while sliding and at rest, shape [points, 2]."""

    def __init__(
        self,
        mesh: ClothMesh,
        solids: Surface | None,
        walls: list[Wall],
        half: np.ndarray,
        friction: np.ndarray,
        bodies: BodyCoupling,
        made: np.ndarray,
    ):
        """made: points of solids before anything moves [m], shape [n, 3]."""
        self.mesh = mesh
        self.bodies = bodies
        self.walls = walls
        self.half = half
        self.contacts = ContactSet.none()
        self._friction_of_points = friction
        self._friction_of_walls = np.array(
            [(0.0, 0.0)] * PLANE + [(wall.kinetic_friction, wall.static_friction) for wall in walls]
        )
        self._detector = Detector(mesh, solids, walls, half, made)
        self._between = np.zeros((0, 3))
        """Forces where bodies touch one another, of the step before or as this one found them [N]."""
        self._tables = ContactTables(mesh.count)

    @property
    def tables(self) -> Contacts:
        """All contacts on the device, for Newton's method."""
        return self._tables.newton

    @property
    def projected(self) -> ProjectedContacts:
        """The same for small steps."""
        return self._tables.projected

    @property
    def narrow(self) -> np.ndarray:
        """Points of pairs that came too near in the last search, shape [n, 4]."""
        return self._detector.narrow

    @property
    def count(self) -> int:
        """Contacts of the cloth, and those of bodies that it may change."""
        return len(self.contacts.key) + len(self.bodies.taken)

    def remember(self, key: np.ndarray, *others: np.ndarray) -> None:
        """Go on with the contacts of a step before: weights, normals, limits and forces as in `ContactSet`."""
        self.contacts = ContactSet(key, self._detector.thickness(key), *others)

    def begin(self, start: ti.Ndarray, dt: float) -> None:
        """Look again at contacts where points are now, at the begin of a step of dt [s]; those that have parted are
        forgotten."""
        contacts = self.contacts
        self._dt, self._bears = dt, self._on_bodies(contacts)
        self._between = self.bodies.all_meetings.before.copy()
        if not len(contacts.key):
            self._upload()
            return
        apart, normal, weight = self._detector.nearest(contacts, start)
        normal, real = self._detector.facing(contacts.key, weight, normal, start, start)
        keep = (apart < NEAR * contacts.thickness) & (apart > 0) & real
        contacts.limit = self._limits(contacts, apart)
        contacts.normal, contacts.weight = normal, weight
        self.contacts = contacts.take(np.flatnonzero(keep))
        self._upload()
        self._guess()

    def begin_again(self) -> None:
        """Bodies are predicted elsewhere in the same step."""
        contacts = self.contacts
        contacts.normal_force, contacts.friction_force = self._tables.multipliers(len(contacts.key))
        self._between = self.bodies.all_meetings.before.copy()
        self._upload()
        self._guess()

    def _guess(self) -> None:
        """Try the displacements of bodies by the multipliers."""
        if self.bodies.count:
            force = np.concatenate([self.contacts.force, self._between[self.bodies.taken]])
            body, body_weight, arm = self._sides
            self.bodies.try_forces(self.bodies.sum(body, wrenches(body_weight, arm, force)))

    def find(self, start: ti.Ndarray, place: ti.Ndarray, early: float = EARLY, add: bool = True) -> int:
        """Look for what comes nearer than a share of its thickness on the way from `start` to `place` [m]; returns how
        many are new. To `add` them asks the integrator to solve again, as forces belong to other contacts; so are old
        ones that come too near all the same: their sides have slid to where they meet otherwise."""
        fresh, contacts = self._detector.search(start, place, early), self.contacts
        if len(contacts.key) and len(fresh.key):
            new = ~among(fresh.key, contacts.key)
            if add:
                new |= among(fresh.key[:, 1:], self.narrow)
            fresh = fresh.take(np.flatnonzero(new))
        if add and len(fresh.key):
            if not self._bears and self._on_bodies(fresh):
                self._bears = True
                contacts.limit = self._limits(contacts, self._detector.nearest(contacts, start)[0])
            apart = self._detector.nearest(fresh, start)[0]
            fresh.limit = self._limits(fresh, np.where(apart > 0, apart, fresh.thickness))
            self._keep_forces()
            self.contacts = contacts.take(np.flatnonzero(~among(contacts.key, fresh.key))).joined(fresh)
            self._upload()
        return len(fresh.key)

    def set_stiffness(self, dt: float, inertias: float, springs: float, sinking: float) -> None:
        """Set the contact stiffness; see `augmented_lagrangian.set_stiffness`."""
        mesh = self.mesh
        factors = inertias, springs, sinking, self.borne
        arrays = mesh.points.mass, mesh.stiffness_at_point, self._tables.thickness, self.tables, self.bodies.tables
        augmented_lagrangian.set_stiffness(self.count, mesh.count, *factors, dt, *arrays)

    @property
    def borne(self) -> float:
        """The greatest mass of bodies that one contact bears [kg]."""
        return self.bodies.heaviest(self._sides[0][: len(self.contacts.key)])

    def violations(self, share: float, place: ti.Ndarray) -> int:
        """How many contacts lack more than a share of their thickness at these places [m]; among bodies, or under
        them, how many press from as far, too."""
        own, thickness = len(self.contacts.key), self._tables.thickness
        return augmented_lagrangian.count_violations(own, int(self.borne > 0), share, thickness, self.tables, place)

    def update_multipliers(self) -> None:
        """Take the forces of contacts for the multipliers."""
        augmented_lagrangian.update_multipliers(self.count, self.tables)

    def update_lagged_forces(self) -> float:
        """Renew the normal forces that bound friction; returns how far that may move contacts [m]."""
        return augmented_lagrangian.update_lagged_forces(self.count, self.tables) if self.count else 0.0

    def on_bodies(self) -> np.ndarray:
        """What contacts do to bodies in the step: forces [N], and torques about the centres of mass where they were
        predicted [N m], shape [bodies, 6]."""
        return self._wrenches_of(slice(None))

    def of_cloth(self) -> np.ndarray:
        """The same of contacts with cloth alone."""
        return self._wrenches_of(slice(len(self.contacts.key)))

    def _wrenches_of(self, contacts: slice) -> np.ndarray:
        body, body_weight, arm = (values[contacts] for values in self._sides)
        return self.bodies.sum(body, wrenches(body_weight, arm, self._tables.forces(self.count)[contacts]))

    def between_bodies(self) -> np.ndarray:
        """The force of the `meetings` of bodies in the step [N], shape [n, 3]."""
        return self._tables.forces(self.count)[len(self.contacts.key) :]

    def end(self) -> None:
        """Keep forces for the next step."""
        if self.count:
            self.update_multipliers()
        self._keep_forces()

    def hold_back(self, start: ti.Ndarray, place: ti.Ndarray, velocity: ti.Ndarray | None = None) -> tuple[int, int]:
        """Let points that would pass one another go on as one, their velocities too; returns how many did, and how
        many pairs are too near still: solids that move push them together."""
        if not len(self.narrow):
            return 0, 0
        begin, there = start.to_numpy(), place.to_numpy()
        speed = velocity.to_numpy() if velocity else np.zeros_like(there)
        zones, joined = ImpactZones(self._free_mass(begin)), np.zeros(self.mesh.total, bool)
        for _ in range(HALVINGS):
            zone = zones.add(self.narrow)
            inside = (zone >= 0) & (zones.mass > 0)
            if not inside.any():
                break
            joined |= inside
            there = begin + zones.join(zone, there - begin)
            speed = zones.join(zone, speed)
            place.from_numpy(there)
            self._detector.search(start, place)
            if not len(self.narrow):
                break
        if velocity:
            velocity.from_numpy(speed)
        return int(joined.sum()), len(self.narrow)

    def _free_mass(self, places: np.ndarray) -> np.ndarray:
        """Mass of points [kg]; 0 for those that are held, belong to solids, or touch a plane."""
        mass = np.zeros(self.mesh.total)
        mass[: self.mesh.count] = np.where(self.mesh.held, 0.0, self.mesh.mass)
        for wall in self.walls:
            mass[places @ wall.normal - wall.offset < NEAR * self.half] = 0.0
        return mass

    def _friction(self, key: np.ndarray) -> np.ndarray:
        """Coefficients of contacts while sliding and at rest, shape [n, 2]: geometric means of both sides."""
        points = self._friction_of_points
        other = np.where(key[:, 3:4] >= 0, points[key[:, 3]], self._friction_of_walls[key[:, 0]])
        return np.sqrt(points[key[:, 1]] * other)

    def _limits(self, contacts: ContactSet, apart: np.ndarray) -> np.ndarray:
        """How far contacts have to be apart after a step at the begin of which they are so far apart [m]."""
        lacking = np.maximum(contacts.thickness - apart, 0.0)
        share = min(SHARE, self._dt / (PATIENCE_WITH_BODIES if self._bears else PATIENCE))
        return self._detector.offset(contacts.key) + np.where(lacking > 0, apart + share * lacking, contacts.thickness)

    def _on_bodies(self, contacts: ContactSet) -> bool:
        """Whether any of these contacts is with a body that obeys forces."""
        corner = contacts.key[:, 1:] - self.bodies.first
        return bool((self.bodies.owner[corner[corner >= 0]] >= 0).any())

    def _keep_forces(self) -> None:
        own = len(self.contacts.key)
        normal_force, friction_force = self._tables.multipliers(self.count)
        self.contacts.normal_force, self.contacts.friction_force = normal_force[:own], friction_force[:own]
        met = self.bodies.meetings
        self._between[self.bodies.taken] = normal_force[own:, None] * met.normal + friction_force[own:]

    def _upload(self) -> None:
        contacts = self.contacts
        self._sides = self.bodies.list_contacts(contacts.key, contacts.weight)
        met_force = self._between[self.bodies.taken]
        self._tables.fill(contacts, self._friction(contacts.key), self.bodies.meetings, met_force, self._sides)

    @property
    def bytes(self) -> int:
        """Memory of the tables of contacts and bodies, and of all trees [bytes]."""
        return self._tables.bytes + self.bodies.bytes + self._detector.bytes
