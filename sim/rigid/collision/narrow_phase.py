"""Where bodies touch, or will within the step: the features of each of two looked up in the field of the other."""

import math
from typing import Any

from sim.device.argument_packs import argpack
from sim.device.compiler import ti
from sim.device.double import Integers, Numbers, Quaternions, Singles, Vectors, mat3, vec3, vec4
from sim.geometry.distance.sdf import (
    BOX,
    CAPSULE,
    CYLINDER,
    GRID,
    PLANE,
    SPHERE,
    TORUS,
    distance_on_grid,
    distance_to_box,
    distance_to_capsule,
    distance_to_cylinder,
    distance_to_plane,
    distance_to_sphere,
    distance_to_torus,
)
from sim.rigid.collision.box_box import Box, box_box
from sim.rigid.collision.manifold import FEW, MOST, Found, add
from sim.rigid.collision.shapes import AXIS, CIRCLE, POINT, SEGMENT
from sim.rigid.dynamics.rotation import rotation_of
from sim.rigid.layout import Motion

AROUND = 16
"""Points on a circle among which the nearest is looked for first; every other one may become a contact, too."""
AROUND_STEP = 2.0 * math.pi / AROUND
SECTIONS = 36
"""Golden sections, each of which shortens the interval to 0.62 of it."""
FLAT = 0.9
"""Cosine of the angle between a circle's axis and the normal above which it lies flat."""
GOLDEN = 0.6180339887498949
INNER = 0.9999
"""Share of an axis within which its nearest place is not one of its ends."""
ASIDE = 0.875
"""Cosine of the angle, 29 degrees, by which a mesh's surface may face elsewhere than the body that it touches."""


class _Search:
    """The least of a function of one variable, one value after the other (Kiefer 1953)."""

    low: ti.f64
    high: ti.f64
    left: ti.f64
    right: ti.f64
    at_left: ti.f64
    at_right: ti.f64
    best: ti.f64
    least: ti.f64

    @ti.func
    def next(self, section: ti.i32, final: ti.i32) -> ti.f64:
        """Where to look in this section, or the middle of what is left in the final one."""
        t = self.low + GOLDEN * (self.high - self.low)
        if section == 0:
            t = self.high - GOLDEN * (self.high - self.low)
        elif section > 1:
            if self.at_left < self.at_right:
                self.high, self.right, self.at_right = self.right, self.left, self.at_left
                t = self.high - GOLDEN * (self.high - self.low)
            else:
                self.low, self.left, self.at_left = self.left, self.right, self.at_right
                t = self.low + GOLDEN * (self.high - self.low)
        if final:
            t = 0.5 * (self.low + self.high)
        return t

    @ti.func
    def learn(self, trial: ti.i32, section: ti.i32, t: ti.f64, value: ti.f64):
        """Take down what was found there."""
        if trial == 1 or value < self.least:
            self.best, self.least = t, value
        if section >= 0:
            if 2.0 * t < self.low + self.high:
                self.left, self.at_left = t, value
            else:
                self.right, self.at_right = t, value


Search: Any = ti.dataclass(_Search)

Shapes: Any = argpack(
    kind=Integers,
    size=Vectors,
    hollow=Integers,
    reach=Numbers,
    first_feature=Integers,
    feature=Integers,
    centre=Vectors,
    direction=Vectors,
    rounding=Numbers,
    cone=Quaternions,
    grid=Integers,
    frame=Numbers,
    values=Singles,
)
"""What contacts need of all bodies; features of body b are those from first_feature[b] to first_feature[b + 1]."""


@ti.kernel
def find_contacts(
    kinds: ti.template(),
    pairs: ti.i32,
    pair: Integers,
    margin: Numbers,
    shapes: Shapes,
    motion: Motion,
    number: Integers,
    found: Found,
):
    """Contacts with a gap below `margin` [m] of pairs of bodies, MOST places for each pair.

    kinds: the kinds of shapes that there are, as bits; pair: both bodies of each. Normals point from the
    second body to the first, places are in the middle of the gap, the gap is negative in overlap [m].
    """
    for k in range(pairs):
        a, b = pair[2 * k], pair[2 * k + 1]
        first, count = k * MOST, 0
        undecided = True
        if ti.static(kinds & (1 << BOX) > 0):
            if shapes.kind[a] == BOX and shapes.kind[b] == BOX:
                box_a = Box(motion.position[a], rotation_of(motion.rotation[a]), shapes.size[a])
                box_b = Box(motion.position[b], rotation_of(motion.rotation[b]), shapes.size[b])
                count = box_box(first, box_a, box_b, margin[k], found)
                undecided = count == 0
        if undecided:
            scale = ti.min(shapes.reach[a], shapes.reach[b])
            most = MOST if shapes.kind[a] == GRID or shapes.kind[b] == GRID else FEW
            for turn in range(2):
                one, other, sign = a, b, 1.0
                if turn == 1:
                    one, other, sign = b, a, -1.0
                # A sphere's centre alone tells all that there is between it and any other shape.
                if shapes.kind[other] != SPHERE or shapes.kind[one] == SPHERE:
                    count = _look_up(
                        kinds, first, count, most, scale, one, other, sign, margin[k], shapes, motion, found
                    )
        number[k] = ti.max(count, 0)


@ti.func
def _look_up(
    kinds: ti.template(),
    first: ti.i32,
    kept: ti.i32,
    most: ti.i32,
    size: ti.f64,
    a: ti.i32,
    b: ti.i32,
    sign: ti.f64,
    margin: ti.f64,
    shapes: ti.template(),
    motion: ti.template(),
    found: ti.template(),
) -> ti.i32:
    """Add contacts of the features of a with the field of b; `sign` is -1 where normals are to point to b.

    One loop tries all places of a feature, so that the kernel holds the fields once only.
    """
    count = kept
    turn_b = rotation_of(motion.rotation[b])
    turn = turn_b.transpose() @ rotation_of(motion.rotation[a])
    shift = turn_b.transpose() @ (motion.position[a] - motion.position[b])
    for f in range(shapes.first_feature[a], shapes.first_feature[a + 1]):
        kind, rounding = shapes.feature[f], shapes.rounding[f]
        centre = shift + turn @ shapes.centre[f]
        direction = turn @ shapes.direction[f]
        # A circle's other axis is normal to this one and to the body's own y.
        across = turn @ vec3(0.0, 0.0, shapes.direction[f][0])
        tries = 1
        straight = kind != POINT and kind != CIRCLE
        if straight:
            tries = 3 + SECTIONS
        elif kind == CIRCLE:
            tries = 1 + AROUND + SECTIONS
        if kind == AXIS and shapes.kind[b] != CYLINDER:
            # Rims, and what is looked up in the cylinder's own field, tell all.
            tries = 0
        search, t = Search(0.0), ti.cast(0.0, ti.f64)
        for trial in range(tries):
            section = trial - (tries - SECTIONS)
            final = trial == tries - 1
            place, valid = centre, kind == POINT
            if trial > 0:
                if straight:
                    if section < 0:
                        t, valid = ti.cast(2 * trial - 3, ti.f64), kind == SEGMENT
                    elif section == 0:
                        search.low, search.high = -1.0, 1.0
                elif section < 0:
                    t, valid = AROUND_STEP * ti.cast(trial, ti.f64), trial % 2 == 0
                elif section == 0:
                    search.low, search.high = search.best - AROUND_STEP, search.best + AROUND_STEP
                if section >= 0:
                    t, valid = search.next(section, final), final
                place = centre + t * direction
                if kind == CIRCLE:
                    place = centre + ti.cos(t) * direction + ti.sin(t) * across
            around = distance(kinds, b, place, shapes)
            if trial == 0 and around[3] >= margin + rounding + direction.norm():
                break
            search.learn(trial, section, t, around[3])
            gap = around[3] - rounding
            if kind == CIRCLE and not final:
                # Points beside the nearest count where the circle lies flat: one that rolls does not stop at them.
                flat = direction.cross(across).normalized(1e-30).dot(vec3(around[0], around[1], around[2]))
                valid = valid and abs(flat) > FLAT
            if kind == AXIS:
                # At an end the round side is not what is nearest.
                valid = valid and abs(t) < INNER
            if valid and gap < margin:
                normal = vec3(around[0], around[1], around[2])
                middle = place - normal * (rounding + 0.5 * gap)
                if ti.static(kinds & (1 << GRID) > 0):
                    if shapes.cone[f][3] > -1.0 and shapes.kind[b] != PLANE:
                        normal = _facing(normal, turn, shapes.cone[f], shapes.kind[b] == GRID)
                out, arm = turn_b @ normal, turn_b @ (place - shift)
                bend = ti.cast(0.0, ti.f64)
                if kind != CIRCLE:
                    bend = ti.max(0.5 * out.dot(motion.spin[a].cross(motion.spin[a].cross(arm))), 0.0)
                if out.norm_sqr() > 0.5:
                    at = motion.position[b] + turn_b @ middle
                    count = add(first, count, most, size, at, sign * out, gap, bend, found)
    return count


@ti.func
def _facing(direction: vec3, turn: mat3, cone: vec4, coarse: ti.i32) -> vec3:
    """What is left of a contact's direction out of b where a's surface faces within a cone, which turns by `turn`.

    Bodies touch where one faces against the other: what faces elsewhere by more than ASIDE is no contact, and its
    direction zero. A coarse grid, which rounds edges off, is believed no more than the surface is.
    """
    facing = -(turn @ vec3(cone[0], cone[1], cone[2]))
    along = direction.dot(facing)
    found = direction
    if along < cone[3]:
        sine = ti.sqrt(ti.max(1.0 - cone[3] * cone[3], 0.0))
        aside = direction - along * facing
        if along * cone[3] + aside.norm() * sine < ASIDE:
            found = vec3(0.0)
        elif coarse:
            found = cone[3] * facing + sine * aside.normalized(1e-30)
    return found


@ti.func
def distance(kinds: ti.template(), body: ti.i32, p: vec3, shapes: ti.template()) -> vec4:
    """Signed distance of a point in the body's frame, and the direction in which it grows."""
    kind, size = shapes.kind[body], shapes.size[body]
    distance = vec4(0.0)
    if ti.static(kinds & (1 << PLANE) > 0):
        if kind == PLANE:
            distance = distance_to_plane(p)
    if ti.static(kinds & (1 << SPHERE) > 0):
        if kind == SPHERE:
            distance = distance_to_sphere(p, size[0])
    if ti.static(kinds & (1 << BOX) > 0):
        if kind == BOX:
            distance = distance_to_box(p, size)
    if ti.static(kinds & (1 << CAPSULE) > 0):
        if kind == CAPSULE:
            distance = distance_to_capsule(p, size[0], size[1])
    if ti.static(kinds & (1 << CYLINDER) > 0):
        if kind == CYLINDER:
            distance = distance_to_cylinder(p, size[0], size[1])
    if ti.static(kinds & (1 << TORUS) > 0):
        if kind == TORUS:
            distance = distance_to_torus(p, size[0], size[1])
    if ti.static(kinds & (1 << GRID) > 0):
        if kind == GRID:
            distance = distance_on_grid(p, shapes.grid, shapes.frame, shapes.values, body)
            if shapes.hollow[body] == 1:
                distance = -distance
    return distance
