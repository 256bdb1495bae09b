"""Pairs of bodies that may touch within a step, each tried with each: quicker than a sweep for up to some hundreds."""

from typing import Any

from sim.device.argument_packs import argpack
from sim.device.compiler import ti
from sim.device.double import Numbers, Vectors
from sim.rigid.dynamics.rotation import rotation_of
from sim.rigid.layout import BodyProperties, Motion, Pairs

Boxes: Any = argpack(
    own_middle=Vectors,
    own_half=Vectors,
    farthest=Numbers,
    skin=Numbers,
    plane_normal=Vectors,
    plane_offset=Numbers,
    box_middle=Vectors,
    box_half=Vectors,
    step_way=Numbers,
)
"""Boxes around bodies in their own axes, from their pivots: middles and halves of the edges; how far they reach, and
from how far off contacts are followed beyond what bodies go in a step; planes, n . x = offset. Written: boxes in world
axes that hold the bodies throughout a step, and how far they go in it. All in m."""


@ti.kernel
def list_near(
    count: ti.i32,
    solids: ti.i32,
    dt: ti.f64,
    room: ti.i32,
    boxes: Boxes,
    bodies: BodyProperties,
    motion: Motion,
    near: Pairs,
    margin: Numbers,
) -> ti.i32:
    """List pairs of `count` bodies, planes after so many `solids`, one of them dynamic, whose boxes overlap, in order,
    and how far off contacts of each are looked for [m]; returns how many there are, listed or not."""
    found = 0
    ti.loop_config(serialize=True)
    for _ in range(1):
        for a in range(count):
            way = dt * (motion.velocity[a].norm() + boxes.farthest[a] * motion.spin[a].norm())
            boxes.step_way[a] = way
            if a < solids:
                turn = rotation_of(motion.rotation[a])
                boxes.box_middle[a] = motion.position[a] + turn @ boxes.own_middle[a]
                boxes.box_half[a] = abs(turn) @ boxes.own_half[a] + way + boxes.skin[a]
        for a in range(solids):
            for b in range(a + 1, count):
                touches = bodies.dynamic[a] + bodies.dynamic[b] > 0
                if touches:
                    if b < solids:
                        between = abs(boxes.box_middle[a] - boxes.box_middle[b])
                        touches = (between <= boxes.box_half[a] + boxes.box_half[b]).all()
                    else:
                        normal = boxes.plane_normal[b - solids]
                        lowest = normal.dot(boxes.box_middle[a]) - abs(normal).dot(boxes.box_half[a])
                        touches = lowest <= boxes.plane_offset[b - solids]
                if touches:
                    if found < room:
                        near.pair_body[2 * found], near.pair_body[2 * found + 1] = a, b
                        beyond = ti.min(boxes.skin[a], boxes.skin[b])
                        margin[found] = boxes.step_way[a] + boxes.step_way[b] + beyond
                    found += 1
    return found
