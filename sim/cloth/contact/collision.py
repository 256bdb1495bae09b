"""What cloth touches: found by where its points come from and go, and kept from step to step with its forces.

Given where points were and where an integrator takes them, `find` adds the pairs of a point and a triangle, or of two
edges, that come nearer than their thickness on the way: the integrator has to keep those apart, and to ask again. When
nothing is new, or it was asked often enough, `hold_back` lets points go so far together that nothing passes through.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import taichi as ti

from sim.cloth.contact import augmented_lagrangian, search
from sim.cloth.contact.crowding import SHARE as AT_REST
from sim.cloth.contact.crowding import Crowding
from sim.cloth.contact.dynamic_solids import LooseBodies, wrenches
from sim.cloth.contact.impact_zones import ImpactZones
from sim.cloth.contact.roundness import Roundness
from sim.cloth.contact.search import EDGE, PLANE, POINT, Hits
from sim.cloth.contact.surfaces import Surface, Tree
from sim.cloth.fabric.arrays import incidence, integers, numbers, vectors
from sim.cloth.fabric.layout import Touches
from sim.cloth.fabric.mesh import ClothMesh
from sim.device.double import vec3

EARLY = 0.95
"""Pairs count as touching when they come nearer than this share of their thickness."""
LEAST = 0.25
"""This share of the thickness, or of the distance at the start where that is less, is kept in any case."""
NEAR = 1.2
"""Contacts are forgotten from this many thicknesses on."""
SHARE = 0.2
"""Of what the thickness lacks, at most so much is made up for in a step."""
PATIENCE, PATIENCE_WITH_BODIES = 0.025, 0.1
"""And no sooner than in this time [s]: what is pushed keeps the speed, and bodies are heavy."""
ENDS = 1e-9
"""Weights below this are none."""
ROOM = 8
"""Hits of one point or edge that there is room for at first."""
HALVINGS = 40
"""Of how far the ways of points that would pass one another differ."""


@dataclass(frozen=True)
class Wall:
    """The half-space n.x < offset, and its friction."""

    normal: np.ndarray
    offset: float
    slide: float
    hold: float


@dataclass
class Known:
    """Contacts: kind and four points, thickness [m], weights, normals, limits [m], and forces along and across [N]."""

    key: np.ndarray
    thick: np.ndarray
    weight: np.ndarray
    normal: np.ndarray
    limit: np.ndarray
    press: np.ndarray
    grip: np.ndarray

    @classmethod
    def none(cls) -> Known:
        """Where nothing touches."""
        shapes = (0,), (0, 4), (0, 3), (0,), (0,), (0, 3)
        return cls(np.zeros((0, 5), np.int32), *map(np.zeros, shapes))

    def take(self, rows: np.ndarray) -> Known:
        """Those of the given rows, in their order."""
        return Known(*(values[rows] for values in vars(self).values()))

    def joined(self, other: Known) -> Known:
        """With those of another, in the order of their keys."""
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        whole = Known(*(np.concatenate(pair) for pair in pairs))
        return whole.take(np.lexsort(whole.key.T[::-1]))


class Collisions:
    """All contacts of the cloth of a scene. `half`: half the thickness at points [m]; `slide` and `hold`: friction."""

    def __init__(
        self,
        mesh: ClothMesh,
        solids: Surface | None,
        walls: list[Wall],
        half: np.ndarray,
        slide: np.ndarray,
        hold: np.ndarray,
        loose: LooseBodies,
        made: np.ndarray,
    ):
        """made: points of solids before anything moves [m], shape [n, 3]."""
        self.mesh = mesh
        self.loose = loose
        self.walls = walls
        self.half, self._slide, self._hold = half, slide, hold
        self.known = Known.none()
        self.narrow = np.zeros((0, 4), np.int32)
        """Points of pairs that came too near in the last search."""
        cloth = Surface.of(mesh.triangles)
        places = np.concatenate([mesh.placed[: mesh.count], made])
        self._half = numbers(half)
        self._own = Tree(cloth.triangles, places), Tree(cloth.edges, places)
        self._solid = (Tree(solids.triangles, places), Tree(solids.edges, places)) if solids else ()
        points, edges = integers(cloth.points), self._own[1].member
        self._round = Roundness(solids.triangles, places, mesh.count) if solids else None
        self._crowding = Crowding(mesh, half)
        self._searches = [
            _Search(False, False, points, len(cloth.points), self._own[0], self._crowding),
            _Search(True, True, edges, len(cloth.edges), self._own[1], self._crowding),
        ]
        if solids:
            self._searches += [
                _Search(False, False, points, len(cloth.points), self._solid[0]),
                _Search(True, False, edges, len(cloth.edges), self._solid[1]),
                _Search(False, False, integers(solids.points), len(solids.points), self._own[0]),
            ]
        self._cloth_points, self._points = cloth.points, points
        self._between = np.zeros((0, 3))
        """Forces where bodies touch one another, as far as they are known [N]."""
        self._number = integers(np.zeros(len(cloth.points)))
        self._make_room(64)

    @property
    def count(self) -> int:
        """Contacts of the cloth, and those of bodies that it may change."""
        return len(self.known.key) + len(self.loose.taken)

    def remember(self, key: np.ndarray, *others: np.ndarray) -> None:
        """Go on with the contacts of a step before: weights, normals, limits and forces as in `Known`."""
        self.known = Known(key, self._thickness(key), *others)

    def begin(self, start: ti.Ndarray, dt: float) -> None:
        """Look again at contacts where points are now, at the begin of a step of dt [s]; those that have parted are
        forgotten."""
        known = self.known
        self._dt, self._bears = dt, self._on_bodies(known)
        self._between = self.loose.all_meetings.before.copy()
        if not len(known.key):
            self._upload()
            return
        apart, normal, weight = self._nearest(known, start)
        normal, real = self._facing(known.key, weight, normal, start, start)
        keep = (apart < NEAR * known.thick) & (apart > 0) & real
        known.limit = self._limits(known, apart)
        known.normal, known.weight = normal, weight
        self.known = known.take(np.flatnonzero(keep))
        self._upload()
        self._guess()

    def begin_again(self) -> None:
        """Bodies are aimed elsewhere in the same step."""
        own, known = len(self.known.key), self.known
        known.press, known.grip = self.touches.press.to_numpy()[:own], self.touches.grip.to_numpy()[:own]
        self._between = self.loose.all_meetings.before.copy()
        self._upload()
        self._guess()

    def _guess(self) -> None:
        """Try the ways of bodies that forces which are known would take them."""
        if self.loose.count:
            met, known = self._between[self.loose.taken], self.known
            force = np.concatenate([known.press[:, None] * known.normal + known.grip, met])
            body, total, arm = self._held
            self.loose.try_forces(self.loose.sum(body, wrenches(total, arm, force)))

    def find(self, start: ti.Ndarray, place: ti.Ndarray, early: float = EARLY, add: bool = True) -> int:
        """Look for what comes nearer than a share of its thickness on the way from `start` to `place` [m]; returns how
        many were not known. To `add` them asks the integrator to solve again, as forces belong to other contacts; so
        are those that are known and come too near all the same: their sides have slid to where they meet otherwise."""
        fresh, known = self._search(start, place, early), self.known
        if len(known.key) and len(fresh.key):
            new = ~_among(fresh.key, known.key)
            if add:
                new |= _among(fresh.key[:, 1:], self.narrow)
            fresh = fresh.take(np.flatnonzero(new))
        if add and len(fresh.key):
            if not self._bears and self._on_bodies(fresh):
                self._bears = True
                known.limit = self._limits(known, self._nearest(known, start)[0])
            apart = self._nearest(fresh, start)[0]
            fresh.limit = self._limits(fresh, np.where(apart > 0, apart, fresh.thick))
            self._keep_forces()
            self.known = known.take(np.flatnonzero(~_among(known.key, fresh.key))).joined(fresh)
            self._upload()
        return len(fresh.key)

    def harden(self, dt: float, inertias: float, springs: float, sinking: float) -> None:
        """Set the stiffness with which contacts are looked for; see `touch.harden`."""
        mesh = self.mesh
        factors = inertias, springs, sinking, self.borne
        tables = mesh.points.mass, mesh.stiff, self._thick, self.touches, self.loose.tables
        augmented_lagrangian.harden(self.count, mesh.count, *factors, dt, *tables)

    @property
    def borne(self) -> float:
        """The greatest mass of bodies that one contact bears [kg]."""
        return self.loose.heaviest(self._held[0][: len(self.known.key)])

    def astray(self, share: float, place: ti.Ndarray) -> int:
        """How many contacts lack more than a share of their thickness at these places [m]; among bodies, or under
        them, how many press from as far, too."""
        own = len(self.known.key)
        return augmented_lagrangian.count_astray(own, int(self.borne > 0), share, self._thick, self.touches, place)

    def learn(self) -> None:
        """Take the forces of contacts for known."""
        augmented_lagrangian.learn(self.count, self.touches)

    def press_on(self) -> float:
        """Renew the forces that friction counts; returns how far that may move contacts [m]."""
        return augmented_lagrangian.press_on(self.count, self.touches) if self.count else 0.0

    def on_bodies(self) -> np.ndarray:
        """What contacts do to bodies in the step: forces [N], and torques about the centres of mass that they were
        aimed at [N m], shape [bodies, 6]."""
        return self._wrenches_of(slice(None))

    def of_cloth(self) -> np.ndarray:
        """The same of contacts with cloth alone."""
        return self._wrenches_of(slice(len(self.known.key)))

    def _wrenches_of(self, contacts: slice) -> np.ndarray:
        body, total, arm = (values[contacts] for values in self._held)
        return self.loose.sum(body, wrenches(total, arm, self._forces()[contacts]))

    def between_bodies(self) -> np.ndarray:
        """The force of the `meetings` of bodies in the step [N], shape [n, 3]."""
        return self._forces()[len(self.known.key) :]

    def _forces(self) -> np.ndarray:
        return self.touches.touch_force.to_numpy()[: self.count]

    def end(self) -> None:
        """Keep forces for the next step."""
        if self.count:
            self.learn()
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
            self._search(start, place)
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

    def _search(self, start: ti.Ndarray, place: ti.Ndarray, early: float = EARLY) -> Known:
        for tree in (*self._own, *self._solid):
            tree.enclose(self._half, start, place)
        found = [one.run(self._half, start, place, early) for one in self._searches]
        self.narrow = np.concatenate([corners[narrow > 0] for corners, *_, narrow in found])
        parts = [Known.none()]
        for one, (corners, weight, normal, _) in zip(self._searches, found, strict=True):
            if one.edges:
                # Where an end of an edge is nearest, its point and a triangle are a pair already.
                between = (np.abs(weight) > ENDS).all(axis=1)
                corners, weight, normal = corners[between], weight[between], normal[between]
            if len(corners):
                kind = np.full((len(corners), 1), EDGE if one.edges else POINT, np.int32)
                key = np.concatenate([kind, corners], axis=1)
                normal, real = self._facing(key, weight, normal, start, place)
                parts.append(self._unknown(key, weight, normal).take(np.flatnonzero(real)))
        for index, wall in enumerate(self.walls):
            points = self._near_wall(wall, place, early)
            key = np.full((len(points), 5), -1, np.int32)
            key[:, 0], key[:, 1] = PLANE + index, points
            normal = np.broadcast_to(wall.normal, (len(points), 3))
            parts.append(self._unknown(key, np.eye(4)[np.zeros(len(points), int)], normal))
        whole = parts[0]
        for part in parts[1:]:
            whole = whole.joined(part)
        return whole

    def _near_wall(self, wall: Wall, place: ti.Ndarray, early: float) -> np.ndarray:
        search.find_near_plane(
            len(self._cloth_points),
            early,
            vec3(*wall.normal),
            wall.offset,
            self._points,
            self._half,
            place,
            self._number,
        )
        return self._cloth_points[np.flatnonzero(self._number.to_numpy())]

    def _unknown(self, key: np.ndarray, weight: np.ndarray, normal: np.ndarray) -> Known:
        n = len(key)
        thick = self._thickness(key)
        limit = self._offset(key) + thick
        return Known(key, thick, weight, np.array(normal), limit, np.zeros(n), np.zeros((n, 3)))

    def _thickness(self, key: np.ndarray) -> np.ndarray:
        """At which distance pairs touch [m]."""
        other = np.where(key[:, 3] >= 0, self.half[key[:, 3]], 0.0)
        return self._crowding.thickness(key, self.half[key[:, 1]] + other)

    def _offset(self, key: np.ndarray) -> np.ndarray:
        """How far walls are from the origin [m]; 0 for pairs of points."""
        offsets = np.array([0.0] * PLANE + [wall.offset for wall in self.walls])
        return offsets[key[:, 0]]

    def _friction(self, key: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found = []
        for at_points, of_walls in (
            (self._slide, [wall.slide for wall in self.walls]),
            (self._hold, [wall.hold for wall in self.walls]),
        ):
            walls = np.array([0.0] * PLANE + of_walls)
            other = np.where(key[:, 3] >= 0, at_points[key[:, 3]], walls[key[:, 0]])
            found.append(np.sqrt(at_points[key[:, 1]] * other))
        return found[0], found[1]

    def _limits(self, known: Known, apart: np.ndarray) -> np.ndarray:
        """How far contacts have to be apart after a step at the begin of which they are so far apart [m]."""
        lacking = np.maximum(known.thick - apart, 0.0)
        share = min(SHARE, self._dt / (PATIENCE_WITH_BODIES if self._bears else PATIENCE))
        return self._offset(known.key) + np.where(lacking > 0, apart + share * lacking, known.thick)

    def _on_bodies(self, known: Known) -> bool:
        """Whether any of these contacts is with a body that obeys forces."""
        corner = known.key[:, 1:] - self.loose.first
        return bool((self.loose.owner[corner[corner >= 0]] >= 0).any())

    def _nearest(self, known: Known, place: ti.Ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Distance [m], normal and weights of contacts for places of points."""
        apart, normal, weight = known.limit.copy(), known.normal.copy(), known.weight.copy()
        pairs = np.flatnonzero(known.key[:, 0] < PLANE)
        if len(pairs):
            key = np.ascontiguousarray(known.key[pairs])
            found = np.zeros(len(pairs)), np.zeros((len(pairs), 3)), np.zeros((len(pairs), 4))
            search.look_again(len(pairs), key, place, *found)
            apart[pairs], normal[pairs], weight[pairs] = found
        planes = np.flatnonzero(known.key[:, 0] >= PLANE)
        if len(planes):
            points = place.to_numpy()[known.key[planes, 1]]
            apart[planes] = (points * known.normal[planes]).sum(axis=1) - self._offset(known.key[planes])
        return apart, normal, weight

    def _facing(
        self, key: np.ndarray, weight: np.ndarray, normal: np.ndarray, start: ti.Ndarray, place: ti.Ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Normals of contacts, of which `normal` holds for triangles, where solids may be round, and which are none."""
        if self._round is None or self._round.flat:
            return normal, np.ones(len(key), bool)
        return self._round.normals(key, weight, normal, start.to_numpy(), place.to_numpy())

    def _keep_forces(self) -> None:
        own = len(self.known.key)
        press, grip = self.touches.press.to_numpy()[: self.count], self.touches.grip.to_numpy()[: self.count]
        self.known.press, self.known.grip = press[:own], grip[:own]
        met = self.loose.meetings
        self._between[self.loose.taken] = press[own:, None] * met.normal + grip[own:]

    def _upload(self) -> None:
        known, own = self.known, len(self.known.key)
        self._held = self.loose.hold(known.key, known.weight)
        met, count = self.loose.meetings, self.count
        if count > self._room:
            self._make_room(2 * count)
        force = self._between[self.loose.taken]
        push = np.maximum((force * met.normal).sum(axis=1), 0.0)
        slide, hold = self._friction(known.key)
        press = np.concatenate([known.press, push])
        limit = np.concatenate([known.limit, -np.maximum(met.gap, 0.0)])
        friction = np.concatenate([np.column_stack([slide, hold]), met.friction])
        first, entry = incidence(known.key[:, 1:], self.mesh.count)
        body, total, arm = self._held
        _fill(self._thick, np.concatenate([known.thick, np.ones(count - own)]))
        for name, values in (
            ("touch_corner", np.concatenate([known.key[:, 1:].ravel(), np.full(4 * (count - own), -1)])),
            ("touch_weight", np.concatenate([known.weight, np.zeros((count - own, 4))])),
            ("touch_body", body.ravel()),
            ("touch_sum", total.ravel()),
            ("touch_arm", arm.reshape(-1, 3)),
            ("touch_normal", np.concatenate([known.normal, met.normal])),
            ("law", np.column_stack([limit, friction, press])),
            ("press", press),
            ("grip", np.concatenate([known.grip, force - push[:, None] * met.normal])),
            ("first_touch", first),
            ("of_touch", entry),
        ):
            _fill(self._arrays[name], values)

    def _make_room(self, room: int) -> None:
        self._room = room
        three = np.zeros((room, 3))
        self._arrays = {
            "touch_corner": integers(np.zeros(4 * room)),
            "touch_body": integers(np.full(2 * room, -1)),
            "touch_sum": numbers(np.zeros(2 * room)),
            "touch_arm": vectors(np.zeros((2 * room, 3))),
            **{name: ti.Vector.ndarray(4, ti.f64, room) for name in ("touch_weight", "law")},
            **{name: vectors(three) for name in ("touch_normal", "grip", "touch_force", "touch_block")},
            **{name: vectors(three) for name in ("touch_trial", "touch_way")},
            **{name: numbers(np.zeros(room)) for name in ("hard", "press")},
            "awake": integers(np.ones(room)),
            "first_touch": integers(np.zeros(self.mesh.count + 1)),
            "of_touch": integers(np.zeros(4 * room)),
        }
        self.touches = Touches(**self._arrays)
        self._thick = numbers(np.zeros(room))

    @property
    def bytes(self) -> int:
        """Memory of the tables of contacts and bodies, and of all trees [bytes]."""
        return 4 * self._room * 8 * 8 + self.loose.bytes + sum(tree.bytes for tree in (*self._own, *self._solid))


class _Search:
    """Points against triangles, or edges against edges."""

    def __init__(
        self, edges: bool, itself: bool, query: ti.Ndarray, number: int, tree: Tree, own: Crowding | None = None
    ):
        """`own`: where cloth is looked for that may be a neighbour."""
        self.edges, self.itself = edges, itself
        self._crowding = own if own and own.present else None
        self._query, self._queries, self._tree = query, number, tree
        self._number = integers(np.zeros(number))
        self._make_room(ROOM)

    def _make_room(self, room: int) -> None:
        self._room, slots = room, max(room * self._queries, 1)
        self._hits = Hits(
            corner=integers(np.zeros(4 * slots)),
            weight=ti.Vector.ndarray(4, ti.f64, slots),
            toward=vectors(np.zeros((slots, 3))),
            narrow=integers(np.zeros(slots)),
        )

    def run(self, half: ti.Ndarray, start: ti.Ndarray, place: ti.Ndarray, early: float) -> tuple[np.ndarray, ...]:
        """Points, weights and normals of pairs that come near, and whether they come too near."""
        while True:
            search.find_near(
                self.edges,
                self.itself,
                self._crowding is not None,
                self._queries,
                self._room,
                self._tree.leaves,
                self._tree.number,
                early,
                LEAST,
                AT_REST,
                self._query,
                self._tree.member,
                self._tree.low,
                self._tree.high,
                half,
                start,
                place,
                self._crowding.places if self._crowding else start,
                self._number,
                self._hits,
            )
            number = self._number.to_numpy()[: self._queries]
            if number.max(initial=0) <= self._room:
                break
            self._make_room(2 * int(number.max()))
        total = int(number.sum())
        corners, narrow = np.zeros((total, 4), np.int32), np.zeros(total, np.int32)
        weight, normal = np.zeros((total, 4)), np.zeros((total, 3))
        if total:
            first = np.cumsum(number) - number
            search.gather(
                self._queries, self._room, integers(first), self._number, self._hits, corners, weight, normal, narrow
            )
        return corners, weight, normal, narrow


def _fill(array: ti.Ndarray, values: np.ndarray) -> None:
    """Put values at the beginning of an array, and zeros behind them."""
    whole = np.zeros((array.shape[0], *np.shape(values)[1:]), np.asarray(values).dtype)
    whole[: len(values)] = values
    array.from_numpy(whole.astype(np.int32) if whole.dtype.kind == "i" else whole)


def _among(keys: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Which rows of `keys` are rows of `others`."""
    kind = np.dtype((np.void, keys.dtype.itemsize * keys.shape[1]))
    one, other = (np.ascontiguousarray(rows).view(kind).ravel() for rows in (keys, others))
    return np.isin(one, other)
