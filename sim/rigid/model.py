"""Rigid bodies that obey forces, and what they meet: one step after the other.

A step: forces change velocities (free_motion); near bodies are paired (broad_phase), and the places where they touch or
will are found (narrow_phase, box_box, manifold); impulses are found for all of them together (contact_solver); bodies
move (free_motion, rotation); those that were struck bounce (restitution, rebounds), and what overlaps still is parted
without gaining speed (contact_table). Where there is cloth, bodies bounce last, when it is known what it does to them.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from sim.bodies.movement import Movement
from sim.bodies.overlaps import DEEP
from sim.device.double import vec3
from sim.rigid.bodies import SAVED, RigidBodies, rotations
from sim.rigid.body import Body, RigidMeasure, RigidState
from sim.rigid.collision import contact_table
from sim.rigid.collision.detection import Detection
from sim.rigid.dynamics import contact_solver, free_motion, sums
from sim.rigid.dynamics.contact_impulses import solve_impulses
from sim.rigid.dynamics.rebounds import Rebounds
from sim.rigid.dynamics.release import borne_by, wrenches
from sim.rigid.dynamics.springs import pulled
from sim.rigid.dynamics.time_step_limits import limiting_term, step_limits
from sim.rigid.spec import Rigid

STATISTICS = ("contacts", "contact_iterations", "contact_error", "overlap", "contacts_capped")
"""What is told of a step: how many contacts, sweeps over them, the velocity that the last of them changed most [m/s],
the deepest overlap [m], and whether the sweeps ended at their cap."""
SHARE = 0.2
"""Of overlap that is not left alone, so much is undone in a step, by moving bodies without giving them speed."""
PARTING = 2.0
"""The greatest speed of that, in sizes of the smallest body a second."""
PARTING_SWEEPS = 50
PARTING_ERROR = 1e-6
"""In sizes of the smallest body a second."""
LOWEST = -1e30
"""No body is lower [m]."""


class RigidModel(RigidBodies):
    """Steps all bodies and walls of a world: those that obey forces, and those that they meet.

    bodies: planes last; settings: of the solver.
    """

    def __init__(
        self,
        bodies: Sequence[Body],
        gravity: np.ndarray,
        settings: Rigid,
        state: RigidState,
        *,
        bottom: float = -np.inf,
    ):
        """Under the height `bottom` [m] a body is out of the scene: its speed does not limit the steps of others."""
        super().__init__(bodies, state)
        self._lowest = max(bottom, LOWEST)
        self.settings = settings
        self.gravity = np.asarray(gravity, dtype=np.float64)
        self._pull = vec3(*self.gravity), vec3(*self.gravity / max(float(np.linalg.norm(self.gravity)), 1e-300))
        """Gravity [m/s^2], and its direction."""
        self._sums = np.zeros(sums.SUMS)
        self.stats: dict[str, float] = {}
        self._drawn = [k for k, body in enumerate(bodies) if body.pulls]
        previous = state.contact_pair, state.contact_place, state.contact_force
        self.contacts = Detection(self, settings, previous)
        self.path_deviation = np.zeros((self.count, 3))
        """By how much bodies are off where their velocities at the end of the step would have taken them [m]."""
        self._began = self.position.copy()
        """Where bodies were when contacts were found, before they moved [m]."""
        self._met = self.moving_as(self.velocity, self.spin, self.momentum, position=self._began)
        # Other velocities of the same bodies, while parting.
        self._apart = np.zeros((3, self.count, 3))
        self._parting = self.moving_as(*self._apart)
        self._shift = tuple(self._apart[:2])
        self._least = float(self.size[self.dynamic].min(initial=np.inf))
        """Size of the smallest body [m]."""
        self._rebounds = Rebounds(self, self.contacts, settings, float(np.linalg.norm(self.gravity)), self._met)
        self.awaits_cloth = False
        """Whether `rebound` is called after each step, with what the cloth did in it."""

    def advance(self, dt: float, movements: Mapping[int, Movement]) -> dict[str, float]:
        """Step by dt [s]; `movements` tells where bodies are then that do not obey forces, by index.

        Returns the STATISTICS.
        """
        self._move(dt, movements)
        count = self.contacts.count
        if count:
            self.contacts.tables.struck[:count] = 0
            if not self.awaits_cloth:
                self._rebounds.strike(dt, np.zeros(self.count, bool))
            self._remember(dt)
            self._part(dt)
        else:
            self.contacts.previous = np.zeros((0, 2), np.int32), np.zeros((0, 3)), np.zeros((0, 3))
        self.land(movements)
        return self.stats

    def predict(self, dt: float, movements: Mapping[int, Movement]) -> np.ndarray:
        """Where `advance` would take bodies, and how fast they would be: rows of `motions`."""
        kept = [values.copy() for values in self._kept]
        self._move(dt, movements)
        rows = self.motions()
        for values, before in zip(self._kept, kept, strict=True):
            values[:] = before
        self.contacts.count = 0
        self.path_deviation[:] = 0.0
        return rows

    def release(self, bodies: Collection[int]) -> None:
        """Bring what touches one of `bodies`, or hangs together with what does, to the present, by the forces of the
        last step: these change how they move, or go."""
        pairs, place, force = self.contacts.previous
        if not len(bodies) or not len(pairs):
            return
        chosen = borne_by(pairs, self.dynamic, bodies) & (self.velocity_lag > 0)
        arm = np.einsum("nij,nj->ni", rotations(self.rotation[pairs[:, 0]]).as_matrix(), place)
        pressing, turning = wrenches(pairs, arm, force, self.position)
        lag = self.velocity_lag[chosen, None]
        forces = self._force[chosen] + pressing[chosen]
        self.velocity[chosen] += lag * (self.gravity + forces / self.mass[chosen, None])
        self.momentum[chosen] += lag * (self._torque[chosen] + turning[chosen])
        self.velocity_lag[chosen] = 0.0
        self._turn()

    def _move(self, dt: float, movements: Mapping[int, Movement]) -> None:
        """Forces, contacts, and where they take bodies; what bounces and overlaps is left to do."""
        self.stats = dict.fromkeys(STATISTICS, 0)
        self._steer(dt, movements)
        for k in self._drawn:
            body = self.bodies[k]
            coming = self.velocity[k] + dt * (self.gravity + body.force / self.mass[k])
            self._force[k] = body.force + self.mass[k] * pulled(body.pulls, self.position[k], coming, dt)
        packs = self.properties, self._loads, self.motion, self.step_velocities
        free_motion.accelerate(self.count, dt, self._pull[0], *packs)
        if self.contacts.find(dt):
            gap = self.contacts.tables.gap[: self.contacts.count]
            self.stats["contacts"], self.stats["overlap"] = self.contacts.count, max(-float(gap.min()), 0.0)
            if self.awaits_cloth:
                self._remembered = self.contacts.forces(dt)
            self._solve_contacts()
            if self.awaits_cloth:
                self._pressed = self.contacts.forces(dt)
        self._began[:] = self.position
        free_motion.move(self.count, dt, *packs)
        self.path_deviation = dt * self.velocity - (self.position - self._began)

    def _solve_contacts(self) -> None:
        sweeps, change, capped = solve_impulses(
            self.contacts.count, self.settings, self.dynamic, self.motion, self.contacts.tables
        )
        self.stats["contact_iterations"], self.stats["contact_error"] = sweeps, change
        self.stats["contacts_capped"] = int(capped)

    def _remember(self, dt: float) -> None:
        count, tables = self.contacts.count, self.contacts.tables
        place, force = tables.new_place, tables.new_force
        force[:count] = 0.0
        contact_table.remember(count, dt, tables.struck, self.motion, tables.pressed, place, force)
        self.contacts.previous = self.contacts.pair_of_contact.copy(), place[:count].copy(), force[:count].copy()

    def _part(self, dt: float) -> None:
        tables = self.contacts.tables
        deep = contact_table.separate(
            self.contacts.count,
            dt,
            tables.allowed_overlap,
            SHARE,
            PARTING * self._least,
            tables.gap,
            self._met,
            tables.pressed,
            tables.parting_speed,
            tables.parting_impulse,
            tables.parting_friction,
        )
        if deep:
            self._apart[:] = 0.0
            count, error = self.contacts.count, PARTING_ERROR * self._least
            contact_solver.solve(count, 0, PARTING_SWEEPS, error, self._parting, tables.parting, tables.outcome)
            free_motion.shift(self.count, dt, self.properties, *self._shift, self.motion)

    def meetings(self, dt: float) -> tuple[np.ndarray, ...] | None:
        """Contacts of the last step, of dt [s], as it left them: pairs of bodies, places [m],
        normals towards the first, gaps [m], coefficients of friction while sliding and at rest, and forces on the first
        [N], in this step and in the one before; None without any."""
        count, table = self.contacts.count, self.contacts.tables.table
        if not count:
            return None
        pair = table["body"][: 2 * count].reshape(-1, 2)
        place, normal = table["place"][:count], table["normal"][:count]
        speed = [self.velocity[k] + np.cross(self.spin[k], place - self._began[k]) for k in pair.T]
        gap = self.contacts.tables.gap[:count] + dt * ((speed[0] - speed[1]) * normal).sum(axis=1)
        friction = np.column_stack([table["kinetic_friction"][:count], table["static_friction"][:count]])
        moved = place + (self.position - self._began)[pair[:, 0]]
        return pair, moved, normal, gap, friction, self._pressed, self._remembered

    def rebound(
        self, dt: float, bodies: np.ndarray, impulse: np.ndarray, contacts: np.ndarray, force: np.ndarray
    ) -> None:
        """Let bounce what was struck in the last step, of dt [s], though cloth gave `bodies` these impulses [N s] and
        [N m s], shape [n, 6], so that some `contacts` bear other forces [N], shape [m, 3]."""
        count, tables = self.contacts.count, self.contacts.tables
        if not count:
            return
        self._renew(dt, contacts, force)
        self.free_velocity[bodies] += impulse[:, :3] / self.mass[bodies, None]
        inverse_inertia = self.inverse_inertia[bodies]
        self.free_spin[bodies] += np.einsum("nij,nj->ni", inverse_inertia, impulse[:, 3:])
        braked = np.zeros(self.count, bool)
        pair = tables.table["body"][: 2 * count].reshape(-1, 2)
        braked[pair[contacts].ravel()] = True
        self._rebounds.strike(dt, braked & self.dynamic)
        self.contacts.previous[2][tables.struck[:count] == 2] = 0.0

    def _renew(self, dt: float, contacts: np.ndarray, force: np.ndarray) -> None:
        """Take other forces [N] for those of some contacts in the last step."""
        previous = self.contacts.previous[2]
        lasting = previous[contacts].any(axis=1)
        previous[contacts[lasting]] = force[lasting]
        table = self.contacts.tables.table
        push = (force * table["normal"][contacts]).sum(axis=1)
        table["normal_impulse"][contacts] = dt * push
        table["friction_impulse"][contacts] = dt * (force - push[:, None] * table["normal"][contacts])

    def near(self, reach: np.ndarray | float) -> np.ndarray:
        """Pairs of bodies, one of them dynamic, whose boxes would overlap if larger by `reach` [m] all around."""
        return self.contacts.near(reach)

    def overlaps(self) -> list[tuple[str, str, float]]:
        """Names of bodies that are inside each other by more than DEEP of the smaller one's size, and how deep [m]."""
        return self.contacts.overlaps(DEEP)

    def measure(self) -> RigidMeasure:
        """Energies [J], speeds and momentum of the bodies that obey forces."""
        reach = self.contacts.broad_phase.reach
        sums.add_up(self.count, *self._pull, self._lowest, reach, self.size, self.properties, self.motion, self._sums)
        found = self._sums.tolist()
        return RigidMeasure(
            kinetic_energy=found[sums.KINETIC],
            potential_energy=found[sums.POTENTIAL],
            v_max=found[sums.FASTEST],
            relative_speed=found[sums.RELATIVE],
            spin_max=found[sums.SPINNING],
            momentum=self._sums[sums.MOMENTUM : sums.MOMENTUM + 3].copy(),
            finite=math.isfinite(found[sums.EVERYTHING]),
        )

    def step_limits(self, measure: RigidMeasure) -> dict[str, float]:
        """Largest steps [s] by what limits them."""
        return step_limits(self.settings.max_step, measure.relative_speed, measure.spin_max)

    def limiting_term(self, term: str, measure: RigidMeasure) -> tuple[str, str]:
        """What one of `step_limits` comes from, and what would help."""
        return limiting_term(term, measure.v_max, measure.spin_max)

    def state(self) -> RigidState:
        """What a checkpoint keeps of the bodies that obey forces, and of contacts."""
        names = tuple(body.name for body in self.bodies if body.mass is not None)
        pair, place, force = self.contacts.previous
        bodies = {saved: getattr(self, name)[self.dynamic] for saved, name in SAVED.items()}
        return RigidState(names, **bodies, contact_pair=pair, contact_place=place, contact_force=force)

    @property
    def bytes(self) -> int:
        """Of what grows with bodies and contacts."""
        grids = sum(body.shape.grid.values.nbytes for body in self.bodies if body.shape.grid)
        return self.contacts.tables.bytes + 4 * self._apart.nbytes + grids
