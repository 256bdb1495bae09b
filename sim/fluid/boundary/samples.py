"""What samples of sheets add to the density of a particle, and how hard it is pressed against them."""

from sim.device.arrays import Vec4Array, real, vec3, vec4
from sim.device.compiler import ti
from sim.fluid.kernel import cubic, cubic_norm, cubic_slope, slope_norm
from sim.fluid.layout import VOLUME


@ti.func
def sheet_share(
    x: vec3,
    row: ti.i32,
    samples: ti.template(),
    inverse_h: real,
) -> vec4:
    """Density at x over the rest density in w, and its gradient [1/m]; the samples are those listed in `row`."""
    norm = cubic_norm(inverse_h)
    share = ti.cast(0.0, real)
    gradient = vec3(0.0)
    for k in range(samples.size[row]):
        b = samples.sample[samples.index[samples.begin[row] + k]]
        d = x - b.xyz
        q = d.norm() * inverse_h
        share += norm * b[VOLUME] * cubic(q)
        gradient += norm * inverse_h * inverse_h * b[VOLUME] * cubic_slope(q) * d
    return vec4(gradient, share)


@ti.func
def approach(
    x: vec3,
    row: ti.i32,
    samples: ti.template(),
    inverse_h: real,
) -> real:
    """Rate [1/s] at which the motion of the samples alone raises the share of the solids at x."""
    rate = ti.cast(0.0, real)
    for k in range(samples.size[row]):
        b = samples.index[samples.begin[row] + k]
        d = x - samples.sample[b].xyz
        rate -= samples.sample[b][VOLUME] * cubic_slope(d.norm() * inverse_h) * d.dot(samples.velocity[b].xyz)
    return slope_norm(inverse_h) * rate


@ti.kernel
def remember_displacement(count: ti.i32, dt: real, pressure_acceleration: Vec4Array, pressed: Vec4Array):
    """Keep the way [m] by pressure, for the force on bodies."""
    for i in range(count):
        pressed[i] = vec4(dt * dt * pressure_acceleration[i].xyz, 0.0)
