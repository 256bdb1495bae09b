"""Fluid that touches bodies and vessels: it goes on inside them while its surface is looked for, and ends on theirs.

As with plane walls, but each particle has a wall of its own: the plane through the nearest point of the body, which the
particle is in front of. So closed bodies, open vessels and shells thinner than a spacing are alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import KDTree

from sim.bodies.filmed import Body
from workflow.stages.surface.layers import NEXT, Cloud
from workflow.stages.surface.mesh import Surface
from workflow.stages.surface.walls import BEHIND, TOGETHER, TOUCHING

CLOSE = 0.1
"""Particles nearer than this are on the surface, in spacings: which side they are on cannot be said."""
ASIDE = 0.45
"""How far from a particle what else it touches is looked for, in spacings: nearly as far as it is from what it lies
on."""
ELSEWHERE = 0.7
"""Cosine of the angle between two sides that a particle touches, at most."""
CORNERS = 3
"""Times that what is behind sides is brought in front of each: they need not be at right angles."""
MEETING, AGAINST = 2.8, -0.3
"""How near, in spacings, what goes on inside from two sides may come to each other, so that a surface is between them,
and the cosine of the angle between these, below which they are two: next to an edge of a body, fluid goes on from both.
"""
EVEN = 0.25
"""Of two that are nearer the deeper one is left out, or both where their depths differ by less, in spacings."""
SUNK = 0.01
"""How far the fluid reaches into what it touches, in spacings: two surfaces in one place would flicker."""
ASTRAY = 0.1
"""How far from a body what lies on the plane of one of its sides is no longer on that, in spacings."""
BEYOND = 2.0
"""How far the surface may be from all fluid that goes on inside, in spacings."""


@dataclass(frozen=True)
class Solid:
    """A body or a vessel where it is in a frame."""

    body: Body
    position: np.ndarray
    """Of the origin of its coordinates [m], shape [3]."""
    turn: np.ndarray
    """From these to those of the world, a rotation matrix, shape [3, 3]."""

    def touching(self, points: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
        """Indices of points [m], shape [n, 3], that are outside, but nearer than `reach` [m], and the points of the
        surface next to them [m], shape [k, 3]."""
        near, foot = self.body.touching(self._local(points), reach)
        return near, self._world(foot)

    def closest(self, points: np.ndarray) -> np.ndarray:
        """The points of the surface next to points; both [m], shape [n, 3]."""
        return self._world(self.body.nearest(self._local(points)))

    def _local(self, points: np.ndarray) -> np.ndarray:
        return (points - self.position) @ self.turn

    def _world(self, points: np.ndarray) -> np.ndarray:
        return points @ self.turn.T + self.position


@dataclass(frozen=True)
class Contacts:
    """Particles that touch solids, one row for each pair."""

    solids: Sequence[Solid]
    particle: np.ndarray
    """Their indices, shape [k]."""
    solid: np.ndarray
    """Index of what each touches, shape [k]."""
    foot: np.ndarray
    """The point of it next to the particle [m], shape [k, 3]."""
    normal: np.ndarray
    """Unit vector from there to the particle, shape [k, 3]."""
    height: np.ndarray
    """How far the particle is from there [m], shape [k]."""

    @classmethod
    def none(cls) -> Contacts:
        """Of particles that touch nothing."""
        nothing, nowhere = np.empty(0, int), np.empty((0, 3))
        return cls((), nothing, nothing, nowhere, nowhere, np.empty(0))

    def of(self, particles: np.ndarray) -> Contacts:
        """Those of some particles, a mask, numbered as they follow one another."""
        number = np.cumsum(particles) - 1
        kept = particles[self.particle]
        return replace(
            self,
            particle=number[self.particle[kept]],
            **{name: getattr(self, name)[kept] for name in ("solid", "foot", "normal", "height")},
        )

    def in_front(self, points: np.ndarray, contact: np.ndarray) -> np.ndarray:
        """Points [m], shape [n, 3], of which those behind what the particle of a contact each, shape [n], touches have
        come to it: to all that it touches, in a corner."""
        order = np.argsort(self.particle, kind="stable")
        first = np.searchsorted(self.particle[order], self.particle[contact])
        last = np.searchsorted(self.particle[order], self.particle[contact], side="right")
        for _ in range(CORNERS):
            for other in range(int((last - first).max(initial=0))):
                row = order[np.minimum(first + other, last - 1)]
                depth = np.einsum("ij,ij->i", points - self.foot[row], self.normal[row])
                points = points - np.minimum(depth, 0.0)[:, None] * self.normal[row]
        return points


def contacts(positions: np.ndarray, solids: Sequence[Solid], spacing: float) -> Contacts:
    """Of particles at `positions` [m], shape [n, 3], of `spacing` [m]; spray touches nothing, as with walls."""
    if not len(positions) or not solids:
        return Contacts.none()
    points = positions.astype(np.float64)
    found = [_touched(points, solid, spacing) for solid in solids]
    particle, foot, normal = (np.concatenate(part) for part in zip(*found, strict=True))
    which = np.repeat(np.arange(len(solids)), [len(one[0]) for one in found])
    height = np.einsum("ij,ij->i", points[particle] - foot, normal)
    beside = KDTree(points).query_ball_point(points[particle], NEXT * spacing, return_length=True) - 1
    fit = (height > CLOSE * spacing) & (height < TOUCHING * spacing) & (beside >= TOGETHER)
    return Contacts(solids, particle[fit], which[fit], foot[fit], normal[fit], height[fit])


def _touched(points: np.ndarray, solid: Solid, spacing: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which points touch a solid, where, and the unit vectors from there; in an edge that it has around the fluid, on
    both sides of it: the second is what is next to a place a little to one side, and looks elsewhere."""
    near, foot = solid.touching(points, TOUCHING * spacing)
    normal = _units(points[near] - foot)
    across = _units(np.cross(normal, np.eye(3)[np.abs(normal).argmin(axis=1)]))
    found = [(near, foot, normal)]
    for way in (across, -across, np.cross(normal, across), -np.cross(normal, across)):
        probe = points[near] + ASIDE * spacing * way
        seen = solid.closest(probe) if len(near) else probe
        away = _units(probe - seen)
        there = points[near] - np.einsum("ij,ij->i", points[near] - seen, away)[:, None] * away
        new = np.einsum("ij,ij->i", probe - points[near], away) < 0
        for _, _, known in found:
            new &= np.einsum("ij,ij->i", known, away) < ELSEWHERE
        # beside an edge that the solid turns to the fluid, the plane of its other side is in the fluid
        new[new] = np.linalg.norm(solid.closest(there[new]) - there[new], axis=1) < ASTRAY * spacing
        found.append((near, np.where(new[:, None], there, np.inf), away))
    particle, foot, normal = (np.concatenate(part) for part in zip(*found, strict=True))
    new = np.isfinite(foot).all(axis=1)
    return particle[new], foot[new], normal[new]


def _units(vectors: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(length > 0, length, 1.0)


@dataclass(frozen=True)
class Inside:
    """Fluid that goes on inside solids."""

    positions: np.ndarray
    """[m], shape [m, 3]."""
    contact: np.ndarray
    """Index of the contact that each comes from, shape [m]."""


def inside(touch: Contacts, fluid: np.ndarray, spacing: float) -> Inside:
    """Copies of those of the particles at `fluid` [m], shape [n, 3], that touch, in lines straight into what they
    touch, as far as nothing comes towards them from another side: they would meet in the middle of it."""
    depth = touch.height[:, None] + spacing * np.arange(BEHIND)
    places = (touch.foot[:, None] - depth[..., None] * touch.normal[:, None]).reshape(-1, 3)
    contact = np.repeat(np.arange(len(touch.particle)), BEHIND)
    if not len(contact):
        return Inside(places, contact)
    normal = touch.normal[contact]
    first, second = KDTree(places).query_pairs(MEETING * spacing, output_type="ndarray").T
    towards = np.einsum("ij,ij->i", normal[first], normal[second]) < AGAINST
    deeper = (depth.ravel()[first] - depth.ravel()[second]) / spacing
    free = np.ones(len(contact), bool)
    free[first[towards & (deeper > -EVEN)]] = free[second[towards & (deeper < EVEN)]] = False
    away, nearest = KDTree(fluid).query(places, distance_upper_bound=MEETING * spacing)
    near = np.flatnonzero(np.isfinite(away))
    way = fluid[nearest[near]] - touch.foot[contact[near]]
    free[near[np.einsum("ij,ij->i", way, normal[near]) < 0]] = False
    return Inside(places[free], contact[free])


def gone_on(cloud: Cloud, touch: Contacts, within: Inside) -> Cloud:
    """The same particles, followed by those inside, which move as those that they come from."""
    positions, velocities = cloud
    return (
        np.concatenate([positions, within.positions.astype(np.float32)]),
        np.concatenate([velocities, velocities[touch.particle[within.contact]]]),
    )


def flush_with_solids(
    surface: Surface, fluid: np.ndarray, touch: Contacts, within: Inside, spacing: float
) -> tuple[Surface, np.ndarray]:
    """The surface, of which what was inside has come to the surface of the solids, and looks into them; and which of
    its vertices those are. `fluid`: all particles that are not inside [m], shape [n, 3]."""
    on = np.zeros(len(surface.vertices), bool)
    if not len(within.contact) or not len(surface.vertices):
        return surface, on
    place, outwards = surface.vertices.astype(np.float64), surface.normals.copy()
    away, nearest = KDTree(within.positions).query(place, distance_upper_bound=BEYOND * spacing)
    near = np.flatnonzero(np.isfinite(away))
    contact = within.contact[nearest[near]]
    flat = touch.in_front(place[near], contact)
    behind = (flat != place[near]).any(axis=1)
    near, contact, flat = near[behind], contact[behind], flat[behind]
    normal, which = touch.normal[contact], touch.solid[contact]
    foot = flat.copy()
    for index in np.unique(which):
        of = which == index
        foot[of] = touch.solids[index].closest(flat[of])
    # a plane goes on beyond the edges of what it is a side of, where only what fluid inside is nearest to is behind it
    nearer, _ = KDTree(fluid).query(place[near], distance_upper_bound=BEYOND * spacing)
    there = (away[near] < nearer) | (np.linalg.norm(foot - flat, axis=1) < ASTRAY * spacing)
    near, foot, normal = near[there], foot[there], normal[there]
    place[near] = foot - SUNK * spacing * normal
    outwards[near] = -normal
    on[near] = True
    return replace(surface, vertices=place.astype(np.float32), normals=outwards), on


def heights_above(place: np.ndarray, normal: np.ndarray, touch: Contacts, reach: float) -> np.ndarray:
    """How far vertices at `place` [m] with unit vectors `normal` out of the fluid, shape [n, 3], are above what the
    fluid next to them touches [m], shape [n]; infinite beyond `reach` [m] and for those that look into it."""
    height = np.full(len(place), np.inf)
    if not len(touch.particle):
        return height
    away, nearest = KDTree(touch.foot + touch.height[:, None] * touch.normal).query(place, distance_upper_bound=reach)
    near = np.flatnonzero(np.isfinite(away))
    contact = nearest[near]
    upwards = touch.normal[contact]
    above = np.einsum("ij,ij->i", normal[near], upwards) > 0
    distance = np.einsum("ij,ij->i", place[near] - touch.foot[contact], upwards)
    height[near[above]] = np.maximum(distance[above], 0.0)
    return height
