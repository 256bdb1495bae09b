"""Energies and momentum of bodies, and how fast they are."""

from sim.device.compiler import ti
from sim.device.double import Numbers, vec3
from sim.rigid.layout import BodyProperties, Motion

KINETIC, POTENTIAL, FASTEST, RELATIVE, SPINNING, MOMENTUM, EVERYTHING = 0, 1, 2, 3, 4, 5, 8
"""Where each is among the sums."""
SUMS = 9


@ti.kernel
def add_up(
    count: ti.i32,
    gravity: vec3,
    down: vec3,
    bottom: ti.f64,
    farthest: Numbers,
    extent: Numbers,
    bodies: BodyProperties,
    motion: Motion,
    sums: Numbers,
):
    """Of dynamic bodies: kinetic and potential energy [J]; the greatest speed of any point [m/s], of a body over its
    own size [1/s], of those above `bottom` [m], and of rotation [rad/s]; momentum [kg m/s]; and a sum of all there is,
    which is not finite where one value is not.

    down: the direction of gravity [m/s^2]; farthest, extent: how far bodies reach from their centres of mass, and their
    sizes [m].
    """
    ti.loop_config(serialize=True)
    for _ in range(1):
        for k in range(SUMS):
            sums[k] = 0.0
        for b in range(count):
            if bodies.dynamic[b] == 1:
                fast, turning = motion.velocity[b].norm(), motion.spin[b].norm()
                momentum = bodies.mass[b] * motion.velocity[b]
                sums[KINETIC] += 0.5 * (momentum.dot(motion.velocity[b]) + motion.momentum[b].dot(motion.spin[b]))
                sums[POTENTIAL] -= bodies.mass[b] * gravity.dot(motion.position[b])
                sums[FASTEST] = ti.max(sums[FASTEST], fast + farthest[b] * turning)
                sums[SPINNING] = ti.max(sums[SPINNING], turning)
                if farthest[b] - down.dot(motion.position[b]) > bottom:
                    sums[RELATIVE] = ti.max(sums[RELATIVE], fast / extent[b])
                for k in ti.static(range(3)):
                    sums[MOMENTUM + k] += momentum[k]
                    sums[EVERYTHING] += motion.position[b][k] + motion.velocity[b][k] + motion.spin[b][k]
                sums[EVERYTHING] += motion.rotation[b].sum()
