"""Which solids are near each particle, and the half-spaces that they are to it.

Particles lie in the order of their cells, so that GROUP of them in a row are close together: solids are sought for
groups first. An entry is a pair of a particle and a solid; those of a particle lie together.
"""

from __future__ import annotations

import math

import numpy as np

from sim.device.arrays import GROWTH, numpy_real, real, vec4
from sim.device.compiler import ti
from sim.fluid.boundary import face_search, face_sums
from sim.fluid.boundary.face_search import GROUP
from sim.fluid.boundary.half_space import half_space_fit
from sim.fluid.boundary.shapes import Shapes
from sim.fluid.layout import Points, Walls
from sim.neighbors.spatial_hash import NeighborList


class Faces:
    """Half-spaces near points, in coordinates relative to the origin of the shapes.

    begin, size: of the entries of each point; solid, particle: of each entry; face: unit normal and distance [m];
    weight of each: less where a nearer one faces the same way; held: the same, of solids that hold fluid along them;
    pull: what it alone adds to the gradient of the density, over the rest density [1/m], as pressure feels it
    (`along_faces`), and how far it does where another is near (`gaps.openness`) in w. share: of all, over the rest
    density, in w, and its gradient [1/m]. excess: by how much denser than the fluid, over that, a particle may be in a
    gap.
    """

    def __init__(self, shapes: Shapes, spacing: float, h: float, reach: float):
        self.shapes = shapes
        self.spacing, self.h, self.reach = spacing, h, reach
        self.fit = vec4(*half_space_fit(spacing, h))
        self._rows = self._groups = self._entries = 0
        self._lists: Walls | None = None
        self._points: Points | None = None
        self._make_room(1, 1, 1)

    def _make_room(self, points: int, groups: int, entries: int) -> None:
        if points > self._rows:
            self._rows = math.ceil(GROWTH * points)
            self.begin, self.size = ti.ndarray(ti.i32, self._rows), ti.ndarray(ti.i32, self._rows)
            self.share = ti.ndarray(vec4, self._rows)
            self.excess = ti.ndarray(real, self._rows)
            self.begin.fill(0)
            self.size.fill(0)
            self.share.fill(0)
            self.excess.fill(0)
            self._lists = None
        if groups > self._groups:
            self._groups = math.ceil(GROWTH * groups)
            self._first = ti.ndarray(ti.i32, self._groups + 1)
        if entries > self._entries:
            self._entries = math.ceil(GROWTH * entries)
            self._member = ti.ndarray(ti.i32, -(-self._entries // GROUP))
            self.solid, self.particle = ti.ndarray(ti.i32, self._entries), ti.ndarray(ti.i32, self._entries)
            self._near, self.face, self.pull = (ti.ndarray(vec4, self._entries) for _ in range(3))
            self.weight, self.held = ti.ndarray(real, self._entries), ti.ndarray(real, self._entries)
            self._lists = None

    @property
    def lists(self) -> Walls:
        """All of these as kernels take them."""
        if self._lists is None:
            self._lists = Walls(
                self.spacing,
                self.fit,
                self.begin,
                self.size,
                self.share,
                self.excess,
                self.solid,
                self.particle,
                self._near,
                self.face,
                self.weight,
                self.held,
                self.pull,
                self.shapes.pose,
            )
        return self._lists

    def points(self, position: ti.Ndarray, velocity: ti.Ndarray) -> Points:
        """Points that nothing catches in gaps, to be placed; kept while the same arrays are asked for."""
        known = self._points
        if known is None or (known.position, known.velocity, known.slack) != (position, velocity, self.excess):
            self._points = Points(position, velocity, self.excess, self.excess)
        return self._points

    def find(self, position: ti.Ndarray, count: int, own: ti.Ndarray | None = None) -> None:
        """List the solids within the reach of `count` points [m], but for each point's `own`."""
        groups = -(-count // GROUP)
        self._make_room(count, groups, 1)
        if not count:
            return
        shapes = self.shapes
        if not shapes.count:
            self.size.fill(0)
            return
        total = face_search.count(count, groups, self.reach, position, shapes.count, shapes.tables, self._first)
        self._make_room(count, groups, GROUP * total)
        face_search.find(
            shapes.kinds,
            count,
            groups,
            self.reach,
            position,
            own is not None,
            own if own is not None else self._first,
            shapes.count,
            shapes.tables,
            self._first,
            self._member,
            self.lists,
        )

    def place(
        self,
        points: Points,
        count: int,
        ahead: float,
        *,
        gaps: bool = False,
        since: float | None = None,
        fall: float = 0.0,
        rest_density: float = 1.0,
        pulls: bool = True,
    ) -> None:
        """Find the half-spaces where the solids are now, and `count` points will be `ahead` [s]; without `pulls` these
        stay.

        gaps: whether points have slack; it is brought on where it is given how much time `since` the last step [s] has
        gone by: then velocities in gaps are changed, too. fall: g d [m^2/s^2]; rest_density [kg/m^3].
        """
        if not self.shapes.count:
            return
        face_sums.place(
            self.shapes.kinds,
            gaps,
            pulls,
            count,
            ahead,
            1.0 / self.h,
            rest_density,
            -1.0 if since is None else since,
            fall,
            points,
            self.shapes.tables,
            self.lists,
        )

    def note(self, count: int, known: ti.Ndarray) -> None:
        """Remember what solids add to points where they are, by the half-spaces that are listed."""
        face_sums.note(count, self.share, known)

    def ease(self, count: int, known: ti.Ndarray, eased: ti.Ndarray) -> None:
        """Let what those that are listed now add at once to what was `known`, at the same places, not press yet.

        A mesh is known by what its nodes see: beside edges and in bent places other faces come into sight as a point
        goes from cell to cell. As fluid that was there all the time, they would shoot it out, the faster, the shorter
        the step.
        """
        face_sums.ease(count, known, self.share, eased, self.excess)

    def sever(self, position: ti.Ndarray, count: int, neighbors: NeighborList) -> None:
        """Take from lists the neighbours on the other side of a thin solid."""
        if self.shapes.thin:
            face_sums.sever(count, position, self.lists, neighbors.lists)

    def prevent_penetration(self, position: ti.Ndarray, velocity: ti.Ndarray, count: int, gap: float) -> int:
        """Bring particles back that have gone through a thin solid since they were listed, `gap` [m] off it; how many.
        Their velocities are those of the surface then, where they would go in."""
        if not self.shapes.thin:
            return 0
        return face_sums.prevent_penetration(
            self.shapes.kinds, count, gap, position, velocity, self.shapes.tables, self.lists
        )

    @property
    def bytes(self) -> int:
        """Memory of what is known of points, groups and entries [bytes]."""
        number = np.dtype(numpy_real).itemsize
        return self._rows * (8 + 5 * number) + 4 * self._groups + self._entries * (8 + 4 // GROUP + 14 * number)
