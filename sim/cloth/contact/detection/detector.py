"""What of a cloth comes near itself, solids and walls on the way of a step: all searches together."""

from __future__ import annotations

import numpy as np

from sim.cloth.contact.contact_set import ContactSet
from sim.cloth.contact.detection import search
from sim.cloth.contact.detection.crowding import Crowding
from sim.cloth.contact.detection.pair_search import Pairs, PairSearch
from sim.cloth.contact.detection.roundness import Roundness
from sim.cloth.contact.detection.search import EDGE, PLANE, POINT
from sim.cloth.contact.detection.surfaces import Surface
from sim.cloth.contact.solids import Wall
from sim.cloth.fabric.arrays import integers, numbers
from sim.cloth.fabric.mesh import ClothMesh
from sim.device.compiler import ti
from sim.device.double import vec3

EARLY = 0.95
"""Pairs count as touching when they come nearer than this share of their thickness."""
ENDS = 1e-9
"""Weights below this are none."""


class Detector:
    """Finds contacts; `narrow`: points of pairs that came too near in the last search, shape [n, 4]."""

    def __init__(self, mesh: ClothMesh, solids: Surface | None, walls: list[Wall], half: np.ndarray, made: np.ndarray):
        """half: half the thickness at points [m]; made: points of solids before anything moves [m], shape [n, 3]."""
        self.walls, self.half = walls, half
        self.narrow = np.zeros((0, 4), np.int32)
        cloth = Surface.of(mesh.triangles)
        places = np.concatenate([mesh.placed[: mesh.count], made])
        self._half = numbers(half)
        points, triangles, edges = cloth.trees(places)
        self._crowding = Crowding(mesh, half)
        self._searches = [
            PairSearch(False, points, triangles, self._crowding),
            PairSearch(True, edges, edges, self._crowding),
        ]
        self._trees = [points, triangles, edges]
        self._round: Roundness | None = None
        if solids:
            corners, faces, sides = solids.trees(places)
            self._trees += [corners, faces, sides]
            self._round = Roundness(solids.triangles, places, mesh.count)
            self._searches += [
                PairSearch(False, points, faces),
                PairSearch(True, edges, sides),
                PairSearch(False, corners, triangles),
            ]
        self._cloth_points, self._points = cloth.points, integers(cloth.points)
        self._number = integers(np.zeros(len(cloth.points)))

    def search(self, start: ti.Ndarray, place: ti.Ndarray, early: float = EARLY) -> ContactSet:
        """What comes nearer than a share of its thickness on the way from `start` to `place` [m], without forces."""
        for tree in self._trees:
            tree.enclose(self._half, start, place)
        found = [one.run(self._half, start, place, early) for one in self._searches]
        self.narrow = np.concatenate([pairs.corners[pairs.narrow > 0] for pairs in found])
        whole = ContactSet.none()
        for one, pairs in zip(self._searches, found, strict=True):
            whole = whole.joined(self._of_pairs(one.edges, pairs, start, place))
        for index, wall in enumerate(self.walls):
            points = self._near_wall(wall, place, early)
            key = np.full((len(points), 5), -1, np.int32)
            key[:, 0], key[:, 1] = PLANE + index, points
            normal = np.broadcast_to(wall.normal, (len(points), 3))
            whole = whole.joined(self._new(key, np.eye(4)[np.zeros(len(points), int)], normal))
        return whole

    def _of_pairs(self, edges: bool, pairs: Pairs, start: ti.Ndarray, place: ti.Ndarray) -> ContactSet:
        corners, weight, normal = pairs.corners, pairs.weight, pairs.normal
        if edges:
            # Where an end of an edge is nearest, its point and a triangle are a pair already.
            between = (np.abs(weight) > ENDS).all(axis=1)
            corners, weight, normal = corners[between], weight[between], normal[between]
        if not len(corners):
            return ContactSet.none()
        kind = np.full((len(corners), 1), EDGE if edges else POINT, np.int32)
        key = np.concatenate([kind, corners], axis=1)
        normal, real = self.facing(key, weight, normal, start, place)
        return self._new(key, weight, normal).take(np.flatnonzero(real))

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

    def _new(self, key: np.ndarray, weight: np.ndarray, normal: np.ndarray) -> ContactSet:
        n = len(key)
        thickness = self.thickness(key)
        limit = self.offset(key) + thickness
        return ContactSet(key, thickness, weight, np.array(normal), limit, np.zeros(n), np.zeros((n, 3)))

    def thickness(self, key: np.ndarray) -> np.ndarray:
        """At which distance contacts touch [m]."""
        other = np.where(key[:, 3] >= 0, self.half[key[:, 3]], 0.0)
        return self._crowding.thickness(key, self.half[key[:, 1]] + other)

    def offset(self, key: np.ndarray) -> np.ndarray:
        """How far walls are from the origin [m]; 0 for pairs of points."""
        offsets = np.array([0.0] * PLANE + [wall.offset for wall in self.walls])
        return offsets[key[:, 0]]

    def nearest(self, contacts: ContactSet, place: ti.Ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Distance [m], normal and weights of contacts for places of points."""
        apart, normal, weight = contacts.limit.copy(), contacts.normal.copy(), contacts.weight.copy()
        pairs = np.flatnonzero(contacts.key[:, 0] < PLANE)
        if len(pairs):
            key = np.ascontiguousarray(contacts.key[pairs])
            found = np.zeros(len(pairs)), np.zeros((len(pairs), 3)), np.zeros((len(pairs), 4))
            search.look_again(len(pairs), key, place, *found)
            apart[pairs], normal[pairs], weight[pairs] = found
        planes = np.flatnonzero(contacts.key[:, 0] >= PLANE)
        if len(planes):
            points = place.to_numpy()[contacts.key[planes, 1]]
            apart[planes] = (points * contacts.normal[planes]).sum(axis=1) - self.offset(contacts.key[planes])
        return apart, normal, weight

    def facing(
        self, key: np.ndarray, weight: np.ndarray, normal: np.ndarray, start: ti.Ndarray, place: ti.Ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Normals of contacts, of which `normal` holds for triangles, where solids may be round, and which are none."""
        if self._round is None or self._round.flat:
            return normal, np.ones(len(key), bool)
        return self._round.normals(key, weight, normal, start.to_numpy(), place.to_numpy())

    @property
    def bytes(self) -> int:
        """Memory of all trees [bytes]."""
        return sum(tree.bytes for tree in self._trees)
