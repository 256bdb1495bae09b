"""Rigid bodies that obey forces, and what they meet: one step after the other.

A step: forces change velocities (free_motion); near bodies are paired (sweep_and_prune), and the places where they
touch or will are found (narrow_phase, box_box, manifold); impulses are found for all of them together (contact_solver);
bodies move (free_motion, rotation); those that were struck bounce (restitution), and what overlaps still is parted
without gaining speed (contact_table). Where there is cloth, bodies bounce last, when it is known what it does to them.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from sim.bodies.movement import Movement
from sim.bodies.overlaps import DEEP
from sim.device.double import vec3
from sim.geometry.distance.sdf import PLANE
from sim.neighbors.sweep_and_prune import near_pairs, near_planes
from sim.rigid.body import Body, RigidMeasure, RigidState
from sim.rigid.collision import contact_table
from sim.rigid.collision.arrays import ContactTables, integers, numbers, shapes
from sim.rigid.collision.narrow_phase import find_contacts
from sim.rigid.collision.surfaces import Surfaces
from sim.rigid.dynamics import contact_solver, free_motion, restitution
from sim.rigid.dynamics.contact_impulses import press
from sim.rigid.dynamics.release import borne_by, wrenches
from sim.rigid.dynamics.springs import pulled
from sim.rigid.dynamics.time_step_limits import TERMS, step_limits
from sim.rigid.spec import Rigid

STATISTICS = ("contacts", "contact_iterations", "contact_error", "overlap", "contacts_capped")
"""What is told of a step: how many contacts, sweeps over them, the velocity that the last of them changed most [m/s],
the deepest overlap [m], and whether the sweeps ended at their cap."""
SKIN = 1e-3
"""Contacts are followed from this share of the smaller body's size on, beyond what bodies go in a step."""
SLACK = 1e-4
"""Overlap, as a share of the smaller body, that is left alone."""
SHARE = 0.2
"""Of any other overlap, so much is undone in a step, by moving bodies without giving them speed."""
PARTING = 2.0
"""The greatest speed of that, in sizes of the smallest body a second."""
PARTING_SWEEPS = 50
PARTING_ERROR = 1e-6
"""In sizes of the smallest body a second."""
MOST_ROUNDS = 100
"""Of blows that pass from pair to pair."""


KEPT = ("position", "rotation", "velocity", "momentum", "late", "fluid_force", "fluid_torque", "fluid_hold")
"""What a state has of each free body."""


class RigidModel:
    """All bodies and walls of a world: those that obey forces, and those that they meet.

    bodies: planes last; settings: of the solver. Positions are in world coordinates, of the bodies' pivots.
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
        self.bottom = bottom
        self.bodies = bodies
        self.settings = settings
        self.gravity = np.asarray(gravity, dtype=np.float64)
        self.count = len(bodies)
        self.free = np.array([body.mass is not None for body in bodies])
        self.mass = np.array([body.mass.mass if body.mass else np.inf for body in bodies])
        self.size = np.array([body.size for body in bodies])
        self.stats: dict[str, float] = {}
        self._surfaces = Surfaces(bodies, settings.pairs)
        self._shapes = shapes(bodies)
        self._kinds = sum({1 << body.shape.kind for body in bodies})
        self._weigh()
        self._enclose()
        self._place(state)
        self._tables = ContactTables(64)
        self._contacts = 0
        self._known = state.contact_pair, state.contact_place, state.contact_force
        self.awaits_cloth = False
        """Whether `rebound` is called after each step, with what the cloth did in it."""

    def _weigh(self) -> None:
        """Inertia in the bodies' own axes, and the forces on them."""
        turns = [body.shape.turn for body in self.bodies]
        tensors = [body.mass.inertia if body.mass else np.eye(3) for body in self.bodies]
        self._placed = np.array(turns)
        self._inertia = np.array([turn.T @ tensor @ turn for turn, tensor in zip(turns, tensors, strict=True)])
        self._inverse_inertia = np.linalg.inv(self._inertia) * self.free[:, None, None]
        self._mobile = integers(self.free)
        self._mass = np.where(self.free, self.mass, 1.0)
        self._force = np.array([body.force for body in self.bodies], dtype=np.float64)
        self._torque = np.array([body.torque for body in self.bodies], dtype=np.float64)
        self._drawn = [k for k, body in enumerate(self.bodies) if body.pulls]

    def _enclose(self) -> None:
        """Boxes around the solids in their own axes, and the planes."""
        solids = [body for body in self.bodies if body.shape.kind != PLANE]
        planes = self.bodies[len(solids) :]
        bounds = np.array([body.bounds for body in solids]).reshape(-1, 2, 3)
        self._middle, self._half = bounds.mean(axis=1), (bounds[:, 1] - bounds[:, 0]) / 2
        self._solids = len(solids)
        self._reach = np.zeros(self.count)
        self._reach[: self._solids] = np.linalg.norm(np.abs(bounds).max(axis=1), axis=1)
        self._normals = np.array([body.shape.turn[:, 1] for body in planes]).reshape(-1, 3)
        self._offsets = np.array([body.shape.turn[:, 1] @ body.shape.origin for body in planes])

    def _place(self, state: RigidState) -> None:
        """Where bodies are, and how fast: as placed, or as in `state`."""
        self._pivots = np.array([body.pivot for body in self.bodies], dtype=np.float64)
        self.position = self._pivots.copy()
        self.rotation = np.array([_quaternion(body.shape.turn) for body in self.bodies])
        self.velocity = np.array([body.velocity for body in self.bodies], dtype=np.float64)
        self.momentum = np.array(
            [body.mass.inertia @ body.angular_velocity if body.mass else np.zeros(3) for body in self.bodies]
        )
        self.fluid_force, self.fluid_torque = np.zeros((2, self.count, 3))
        """Of the fluid on bodies, about their centres of mass [N] and [N m]; whoever couples them keeps them."""
        self.fluid_hold = np.zeros((self.count, 6))
        """Both, of fluid that bodies hold along their surfaces."""
        self.lag = np.zeros((self.count, 3))
        """By how much bodies are off where their velocities at the end of the step would have taken them [m]."""
        self.late = np.zeros(self.count)
        """By how much velocities and momenta are those of an earlier time [s]."""
        self.led = np.zeros(self.count, np.int32)
        """1 where a body is to go by its velocity at the end of a step; likewise."""
        row = {name: index for index, name in enumerate(state.names)}
        for k in np.flatnonzero(self.free):
            if self.bodies[k].name in row:
                for name in KEPT:
                    getattr(self, name)[k] = getattr(state, name)[row[self.bodies[k].name]]
        self.spin = np.zeros((self.count, 3))
        shared = {
            "position": self.position,
            "rotation": self.rotation,
            "inverse_mass": np.where(self.free, 1 / self.mass, 0.0),
            "inverse_inertia": np.zeros((self.count, 3, 3)),
        }
        self._motion = _motion(shared, self.velocity, self.spin, self.momentum)
        self._moved = shared | {"velocity": self.velocity, "spin": self.spin}
        self._turn()
        self._began = self.position.copy()
        """Where bodies were when contacts were found, before they moved [m]."""
        self._met = _motion(shared | {"position": self._began}, self.velocity, self.spin, self.momentum)
        # Others of the same bodies: before the step, at its end without contact, while blows pass on, while parting.
        self._old, self._free, self._blow, self._apart = (np.zeros((3, self.count, 3)) for _ in range(4))
        self._middle_velocity = np.zeros((self.count, 3))
        self._blown, self._parting = _motion(shared, *self._blow), _motion(shared, *self._apart)

    def advance(self, dt: float, movements: Mapping[int, Movement]) -> dict[str, float]:
        """Step by dt [s]; `movements` tells where bodies are then that do not obey forces, by index.

        Returns the STATISTICS.
        """
        self._move(dt, movements)
        if self._contacts:
            self._tables.struck[: self._contacts] = 0
            if not self.awaits_cloth:
                self._bounce(dt, np.zeros(self.count, bool))
            self._remember(dt)
            self._part(dt)
        else:
            self._known = np.zeros((0, 2), np.int32), np.zeros((0, 3)), np.zeros((0, 3))
        self.land(movements)
        return self.stats

    def release(self, bodies: Collection[int]) -> None:
        """Bring what touches one of `bodies`, or hangs together with what does, to the present, by the forces of the
        last step: these change how they move, or go."""
        pairs, place, force = self._known
        if not len(bodies) or not len(pairs):
            return
        chosen = borne_by(pairs, self.free, bodies) & (self.late > 0)
        arm = np.einsum("nij,nj->ni", _rotations(self.rotation[pairs[:, 0]]).as_matrix(), place)
        pressing, turning = wrenches(pairs, arm, force, self.position)
        late = self.late[chosen, None]
        forces = self._force[chosen] + pressing[chosen]
        self.velocity[chosen] += late * (self.gravity + forces / self.mass[chosen, None])
        self.momentum[chosen] += late * (self._torque[chosen] + turning[chosen])
        self.late[chosen] = 0.0
        self._turn()

    def predict(self, dt: float, movements: Mapping[int, Movement]) -> np.ndarray:
        """Where `advance` would take bodies, and how fast they would be: rows of `motions`."""
        kept = [values.copy() for values in self._moving]
        self._move(dt, movements)
        rows = self.motions()
        for values, before in zip(self._moving, kept, strict=True):
            values[:] = before
        self._contacts = 0
        self.lag[:] = 0.0
        return rows

    @property
    def _moving(self) -> tuple[np.ndarray, ...]:
        return self.position, self.rotation, self.velocity, self.spin, self.momentum, self.late

    def kick(self, impulse: np.ndarray, turning: np.ndarray) -> None:
        """Change velocities at once by impulses at the centres of mass [N s] and about them [N m s], shape [n, 3]."""
        free = self.free
        self.velocity[free] += impulse[free] / self.mass[free, None]
        self.momentum[free] += turning[free]
        self._turn()

    def _turn(self) -> None:
        """Find angular velocities, to the bit as a step leaves them: the next one depends on them."""
        free_motion.turn(self.count, self._mobile, self._inverse_inertia, self._motion)

    def apply_response(
        self, bodies: np.ndarray, impulse: np.ndarray, displacement: np.ndarray, turn: np.ndarray
    ) -> None:
        """Take bodies further by displacements [m] and turns [rad], with impulses [N s] and [N m s], shape [n, 6], that
        they got on it."""
        self.position[bodies] += displacement
        turned = Rotation.from_rotvec(turn) * _rotations(self.rotation[bodies])
        self.rotation[bodies] = np.roll(turned.as_quat(), 1, axis=1)
        whole = np.zeros((self.count, 6))
        whole[bodies] = impulse
        self.kick(whole[:, :3], whole[:, 3:])

    def meetings(self, dt: float) -> tuple[np.ndarray, ...] | None:
        """Contacts of the last step, of dt [s], as it left them: pairs of bodies, places [m],
        normals towards the first, gaps [m], coefficients of friction while sliding and at rest, and forces on the first
        [N], in this step and in the one before; None without any."""
        count, table = self._contacts, self._tables.table
        if not count:
            return None
        pair = table["body"][: 2 * count].reshape(-1, 2)
        place, normal = table["place"][:count], table["normal"][:count]
        speed = [self.velocity[k] + np.cross(self.spin[k], place - self._began[k]) for k in pair.T]
        gap = self._tables.gap[:count] + dt * ((speed[0] - speed[1]) * normal).sum(axis=1)
        friction = np.column_stack([table["friction"][:count], table["grip"][:count]])
        moved = place + (self.position - self._began)[pair[:, 0]]
        return pair, moved, normal, gap, friction, self._pressed, self._remembered

    def _contact_forces(self, dt: float) -> np.ndarray:
        table, count = self._tables.table, self._contacts
        return (table["push"][:count, None] * table["normal"][:count] + table["drag"][:count]) / dt

    def _renew(self, dt: float, contacts: np.ndarray, force: np.ndarray) -> None:
        """Take other forces [N] for those of some contacts in the last step."""
        lasting = self._known[2][contacts].any(axis=1)
        self._known[2][contacts[lasting]] = force[lasting]
        table = self._tables.table
        push = (force * table["normal"][contacts]).sum(axis=1)
        table["push"][contacts] = dt * push
        table["drag"][contacts] = dt * (force - push[:, None] * table["normal"][contacts])

    def mobility(self, turned: np.ndarray, bodies: np.ndarray) -> np.ndarray:
        """Inverse inertia of `bodies` in world axes [1/(kg m^2)], when `turned` so far since they were placed."""
        turn = turned @ self._placed[bodies]
        return turn @ self._inverse_inertia[bodies] @ turn.transpose(0, 2, 1)

    def motions(self) -> np.ndarray:
        """How bodies have moved since they were placed: rotation by rows, position [m], velocity [m/s] and angular
        velocity [rad/s]; shape [bodies, 18]."""
        turned = _matrices(self.rotation) @ self._placed.transpose(0, 2, 1)
        return np.concatenate((turned.reshape(-1, 9), self.position, self.velocity, self.spin), axis=1)

    def leave_fluid(self) -> None:
        """Feel nothing more of what fluid did in the last step: there is none now."""
        for done in (self.fluid_force, self.fluid_torque, self.fluid_hold, self.led):
            done.fill(0)

    def _move(self, dt: float, movements: Mapping[int, Movement]) -> None:
        """Forces, contacts, and where they take bodies; what bounces and overlaps is left to do."""
        self.stats = dict.fromkeys(STATISTICS, 0)
        self._steer(dt, movements)
        for k in self._drawn:
            body = self.bodies[k]
            coming = self.velocity[k] + dt * (self.gravity + body.force / self.mass[k])
            self._force[k] = body.force + self.mass[k] * pulled(body.pulls, self.position[k], coming, dt)
        free_motion.accelerate(
            self.count,
            dt,
            vec3(*self.gravity),
            self._mobile,
            self.led,
            self.late,
            self._mass,
            self._inverse_inertia,
            self._force,
            self._torque,
            self.fluid_force,
            self.fluid_torque,
            self._motion,
            *self._old[:2],
            *self._free[:2],
            self._middle_velocity,
        )
        self._contacts = self._find(dt)
        if self._contacts:
            self._remembered = self._contact_forces(dt)
            self._press()
            self._pressed = self._contact_forces(dt)
        self._began[:] = self.position
        free_motion.move(
            self.count,
            dt,
            self._mobile,
            self.led,
            self._inverse_inertia,
            self._torque,
            self._old[0],
            self._free[0],
            self._middle_velocity,
            self._motion,
            self.late,
        )
        self.lag = dt * self.velocity - (self.position - self._began)

    def _steer(self, dt: float, movements: Mapping[int, Movement]) -> None:
        """Velocities that take bodies to where they are to be."""
        for k, now in movements.items():
            aim = Rotation.from_matrix(now.rotation @ self.bodies[k].shape.turn)
            self.velocity[k] = (now.carry(self._pivots[k]) - self.position[k]) / dt
            self.spin[k] = (aim * _rotations(self.rotation[k]).inv()).as_rotvec() / dt

    def land(self, movements: Mapping[int, Movement]) -> None:
        """Put bodies that do not obey forces to where they are."""
        for k, now in movements.items():
            self.position[k] = now.carry(self._pivots[k])
            self.rotation[k] = _quaternion(now.rotation @ self.bodies[k].shape.turn)

    def _find(self, dt: float) -> int:
        """List contacts, with what is known of them from the step before; returns how many."""
        self._pairs, margin = self._near(dt)
        pairs = len(self._pairs)
        if not pairs:
            return 0
        if pairs > self._tables.room:
            self._tables = ContactTables(2 * pairs)
        tables, pair = self._tables, integers(self._pairs)
        find_contacts(
            self._kinds,
            pairs,
            pair,
            margin,
            self._shapes,
            self.position,
            self.rotation,
            self.spin,
            tables.number,
            tables.found,
        )
        self._number = tables.number[:pairs].copy()
        self._first = integers(np.cumsum(self._number) - self._number)
        count = int(self._number.sum())
        if not count:
            return 0
        known, place, force = self._known
        size = np.minimum(self.size[self._pairs[:, 0]], self.size[self._pairs[:, 1]])
        contact_table.gather(
            pairs,
            pair,
            self._number,
            self._first,
            numbers(self._surfaces.of(self._pairs)),
            size,
            tables.found,
            integers(self._same(known)),
            place if len(place) else np.zeros((1, 3)),
            force if len(force) else np.zeros((1, 3)),
            dt,
            self._motion,
            tables.pressed,
            tables.gap,
            tables.restitution,
        )
        tables.slack[:count] = np.repeat(SLACK * size, self._number)
        self.stats["contacts"] = count
        self.stats["overlap"] = max(-float(tables.gap[:count].min()), 0.0)
        return count

    def overlaps(self) -> list[tuple[str, str, float]]:
        """Names of bodies that are inside each other by more than DEEP of the smaller one's size, and how deep [m]."""
        count = self._find(0.0)
        if not count:
            return []
        deepest: dict[tuple[int, int], float] = {}
        for (a, b), gap in zip(np.repeat(self._pairs, self._number, axis=0), self._tables.gap[:count], strict=True):
            deepest[a, b] = max(-float(gap), deepest.get((a, b), 0.0))
        return [
            (self.bodies[a].name, self.bodies[b].name, depth)
            for (a, b), depth in deepest.items()
            if depth > DEEP * min(self.size[a], self.size[b])
        ]

    def _near(self, dt: float) -> tuple[np.ndarray, np.ndarray]:
        """Pairs of bodies that may touch within the step, sorted, and how far off contacts are looked for [m]."""
        displacement = dt * (np.linalg.norm(self.velocity, axis=1) + self._reach * np.linalg.norm(self.spin, axis=1))
        skin = SKIN * self.size
        pairs = self.near((displacement + skin)[: self._solids, None])
        pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
        a, b = pairs.T
        return pairs, displacement[a] + displacement[b] + np.minimum(skin[a], skin[b])

    def near(self, reach: np.ndarray | float) -> np.ndarray:
        """Pairs of bodies, one of them free, whose boxes would overlap if larger by `reach` [m] all around."""
        solids = slice(0, self._solids)
        turn = _matrices(self.rotation[solids])
        middle = self.position[solids] + np.einsum("nij,nj->ni", turn, self._middle)
        half = np.einsum("nij,nj->ni", np.abs(turn), self._half) + reach
        pairs = near_pairs(middle - half, middle + half, self.free[solids])
        walls = near_planes(middle, half, self.free[solids], self._normals, self._offsets)
        walls[:, 1] += self._solids
        return np.concatenate((pairs, walls))

    def _same(self, known: np.ndarray) -> np.ndarray:
        """Where the contacts of the pairs begin and end among those of the pairs `known`, shape [pairs, 2]."""
        before, now = (pairs[:, 0].astype(np.int64) * self.count + pairs[:, 1] for pairs in (known, self._pairs))
        return np.column_stack([np.searchsorted(before, now, side=side) for side in ("left", "right")])

    def _press(self) -> None:
        sweeps, change = press(self._contacts, self.settings, self.free, self._motion, self._moved, self._tables)
        self.stats["contact_iterations"], self.stats["contact_error"] = sweeps, change
        self.stats["contacts_capped"] = int(change > self.settings.contact_error)

    def rebound(
        self, dt: float, bodies: np.ndarray, impulse: np.ndarray, contacts: np.ndarray, force: np.ndarray
    ) -> None:
        """Let bounce what was struck in the last step, of dt [s], though cloth gave `bodies` these impulses [N s] and
        [N m s], shape [n, 6], so that some `contacts` bear other forces [N], shape [m, 3]."""
        if not self._contacts:
            return
        self._renew(dt, contacts, force)
        self._free[0, bodies] += impulse[:, :3] / self.mass[bodies, None]
        self._free[1, bodies] += np.einsum("nij,nj->ni", self._moved["inverse_inertia"][bodies], impulse[:, 3:])
        braked = np.zeros(self.count, bool)
        pair = self._tables.table["body"][: 2 * self._contacts].reshape(-1, 2)
        braked[pair[contacts].ravel()] = True
        self._bounce(dt, braked & self.free)
        self._known[2][self._tables.struck[: self._contacts] == 2] = 0.0

    def _bounce(self, dt: float, braked: np.ndarray) -> None:
        """`braked`: bodies that may have been stopped by something else, too."""
        tables = self._tables
        struck = restitution.approach(
            self._contacts,
            dt,
            float(np.linalg.norm(self.gravity)),
            tables.gap,
            *self._old[:2],
            *self._free[:2],
            self._met,
            tables.pressed,
            tables.restitution,
            integers(braked),
            tables.extra,
            tables.slow,
            tables.struck,
            tables.bounce,
        )
        if not struck:
            return
        self._blow[:2] = self._old[:2]
        restitution.rebound(
            len(self._pairs),
            self._number,
            self._first,
            MOST_ROUNDS,
            tables.slow,
            self._blown,
            tables.pressed,
            tables.bounce,
            tables.extra,
            tables.struck,
            tables.target,
            tables.blow,
        )
        contact_solver.solve(
            self._contacts,
            self.settings.max_iterations,
            self.settings.contact_error,
            self._motion,
            tables.bouncing,
        )
        self.late[tables.table["body"][: 2 * self._contacts][np.repeat(tables.struck[: self._contacts] == 2, 2)]] = 0.0

    def _remember(self, dt: float) -> None:
        place, force = np.zeros((self._contacts, 3)), np.zeros((self._contacts, 3))
        contact_table.remember(
            self._contacts, dt, self._tables.struck, self._motion, self._tables.pressed, place, force
        )
        self._known = np.repeat(self._pairs, self._number, axis=0).astype(np.int32), place, force

    def _part(self, dt: float) -> None:
        tables = self._tables
        least = float(self.size[self.free].min())
        deep = contact_table.separate(
            self._contacts,
            dt,
            tables.slack,
            SHARE,
            PARTING * least,
            tables.gap,
            self._met,
            tables.pressed,
            tables.apart,
            tables.thrust,
            tables.slip,
        )
        if deep:
            self._apart[:] = 0
            contact_solver.solve(self._contacts, PARTING_SWEEPS, PARTING_ERROR * least, self._parting, tables.parting)
            free_motion.shift(self.count, dt, self._mobile, *self._apart[:2], self._motion)

    def measure(self) -> RigidMeasure:
        """Energies [J], speeds and momentum of the bodies that obey forces."""
        free = self.free
        velocity, spin, mass = self.velocity[free], self.spin[free], self.mass[free]
        speed, turning = np.linalg.norm(velocity, axis=1), np.linalg.norm(spin, axis=1)
        highest = self._reach[free] - self.position[free] @ self.gravity / max(np.linalg.norm(self.gravity), 1e-300)
        present = highest > self.bottom
        everything = np.concatenate((self.position[free], self.rotation[free], velocity, spin), axis=1)
        return RigidMeasure(
            kinetic_energy=float(0.5 * mass @ speed**2 + 0.5 * (self.momentum[free] * spin).sum()),
            potential_energy=-float(mass @ (self.position[free] @ self.gravity)),
            v_max=float((speed + self._reach[free] * turning).max(initial=0.0)),
            pace=float((speed / self.size[free])[present].max(initial=0.0)),
            spin_max=float(turning.max(initial=0.0)),
            momentum=mass @ velocity,
            finite=bool(np.isfinite(everything).all()),
        )

    def step_limits(self, measure: RigidMeasure) -> dict[str, float]:
        """Largest steps [s] by what limits them."""
        return step_limits(self.settings.max_step, measure.pace, measure.spin_max)

    def limiting_term(self, term: str, measure: RigidMeasure) -> tuple[str, str]:
        """What one of `step_limits` comes from, and what would help."""
        match term:
            case "spin":
                return f"{TERMS[term]} ({measure.spin_max:.3g} rad/s)", "let it turn more slowly"
            case "travel":
                return f"{TERMS[term]} ({measure.v_max:.3g} m/s)", "use lower speeds or larger bodies"
        return TERMS[term], "raise it"

    def movement(self, index: int) -> Movement:
        """Where a body is now."""
        return Movement(
            pivot=self._pivots[index],
            position=self.position[index].copy(),
            rotation=_rotations(self.rotation[index]).as_matrix() @ self.bodies[index].shape.turn.T,
            velocity=self.velocity[index].copy(),
            angular_velocity=self.spin[index].copy(),
        )

    def state(self) -> RigidState:
        """What a checkpoint keeps of the bodies that obey forces, and of contacts."""
        free = self.free
        return RigidState(
            tuple(body.name for body in self.bodies if body.mass is not None),
            self.position[free],
            self.rotation[free],
            self.velocity[free],
            self.momentum[free],
            self.late[free],
            self.fluid_force[free],
            self.fluid_torque[free],
            self.fluid_hold[free],
            *self._known,
        )

    @property
    def bytes(self) -> int:
        """Of what grows with bodies and contacts."""
        return (
            self._tables.bytes
            + 4 * self._old.nbytes
            + sum(body.shape.grid.values.nbytes for body in self.bodies if body.shape.grid)
        )


def _motion(shared: dict, velocity: np.ndarray, spin: np.ndarray, momentum: np.ndarray) -> contact_solver.Motion:
    return contact_solver.Motion(**shared, velocity=velocity, spin=spin, momentum=momentum)


def _rotations(quaternions: np.ndarray) -> Rotation:
    """Of w, x, y, z, shape [4] or [n, 4]."""
    return Rotation.from_quat(np.roll(quaternions, -1, axis=-1))


def _matrices(quaternions: np.ndarray) -> np.ndarray:
    return _rotations(quaternions).as_matrix() if len(quaternions) else np.zeros((0, 3, 3))


def _quaternion(matrix: np.ndarray) -> np.ndarray:
    return np.roll(Rotation.from_matrix(matrix).as_quat(), 1)
