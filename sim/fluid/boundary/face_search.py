"""Which solids are near which particles: sought for groups of particles first."""

from sim.device.arrays import IntArray, Vec4Array, real, vec3
from sim.device.compiler import ti
from sim.fluid.boundary.half_spaces.nearest import FAR, half_spaces
from sim.fluid.boundary.half_spaces.pose import to_local
from sim.fluid.layout import Solids, Walls
from sim.geometry.distance.sdf import GRID, PLANE

GROUP = 32
"""Points in a row for which solids are sought together."""


@ti.kernel
def count(
    count: ti.i32, groups: ti.i32, reach: ti.f64, position: Vec4Array, number: ti.i32, solids: Solids, first: IntArray
) -> ti.i32:
    """Write to `first` where the members of each group will begin, and after the last where they end, which is
    returned: those of a `number` of solids that may come near its box."""
    for g in range(groups):
        low, high = _box(g, count, position)
        found = 0
        for s in range(number):
            if _comes_near(s, low, high, reach, solids):
                found += most_half_spaces(solids.kind[s])
        first[g + 1] = found
    ti.loop_config(serialize=True)
    for _ in range(1):
        total = 0
        for g in range(groups):
            first[g] = total
            total += first[g + 1]
        first[groups] = total
    return first[groups]


@ti.func
def _box(g: ti.i32, count: ti.i32, position: Vec4Array):
    low, high = vec3(1e30), vec3(-1e30)
    for i in range(g * GROUP, ti.min((g + 1) * GROUP, count)):
        low, high = ti.min(low, position[i].xyz), ti.max(high, position[i].xyz)
    return low, high


@ti.func
def _comes_near(s: ti.i32, low: vec3, high: vec3, reach: ti.f64, solids: ti.template()):
    near = _beside(s, low, high, reach, solids)
    if solids.kind[s] == PLANE:
        least = ti.cast(0.0, ti.f64)
        for axis in ti.static(range(3)):
            n = solids.pose[s, 3 * axis + 1]
            corner = ti.cast(ti.select(n > 0.0, low[axis], high[axis]), ti.f64)
            least += n * (corner - solids.pose[s, 9 + axis])
        near = least < reach
    return near


@ti.func
def most_half_spaces(kind: ti.i32) -> ti.i32:
    """Half-spaces that a solid of this kind may be to one particle."""
    return ti.select(kind == GRID, 3, 1)


@ti.func
def _beside(s: ti.i32, low: vec3, high: vec3, reach: ti.f64, solids: ti.template()):
    beside = True
    for axis in ti.static(range(3)):
        beside = beside and ti.cast(low[axis], ti.f64) < solids.boxes[s, 3 + axis] + reach
        beside = beside and ti.cast(high[axis], ti.f64) > solids.boxes[s, axis] - reach
    return beside


@ti.kernel
def find(
    kinds: ti.template(),
    count: ti.i32,
    groups: ti.i32,
    reach: ti.f64,
    position: Vec4Array,
    has_own: ti.i32,
    own: IntArray,
    number: ti.i32,
    solids: Solids,
    first: IntArray,
    member: IntArray,
    walls: Walls,
):
    """Write to `member` the solids that may come near each group, and the entries of each particle: where they begin
    and how many there are, and of each its solid, its particle, and the half-space within `reach` [m], in the solid's
    own frame."""
    for g in range(groups):
        low, high = _box(g, count, position)
        slot = first[g]
        for s in range(number):
            if _comes_near(s, low, high, reach, solids):
                for k in range(most_half_spaces(solids.kind[s])):
                    member[slot + k] = s if k == 0 else -1
                slot += most_half_spaces(solids.kind[s])
    for i in range(count):
        g = i // GROUP
        room = first[g + 1] - first[g]
        start = GROUP * first[g] + (i - GROUP * g) * room
        x = position[i].xyz
        found = 0
        for k in range(room):
            s = member[first[g] + k]
            wanted = s >= 0
            if has_own == 1:
                wanted = wanted and own[i] != s
            if wanted:
                wanted = _beside(s, x, x, reach, solids)
            if wanted:
                p = to_local(s, x, solids.pose)
                one, second, third = half_spaces(s, p, ti.cast(reach, real), kinds, solids)
                for c in range(3):
                    front = one if c == 0 else (second if c == 1 else third)
                    if front.xyz.dot(ti.cast(p, real)) - front.w < reach and front.w < FAR:
                        e = start + found
                        walls.solid[e] = s
                        walls.particle[e] = i
                        walls.near[e] = front
                        found += 1
        walls.begin[i] = start
        walls.size[i] = found
