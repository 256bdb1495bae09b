"""Rotations on the device: unit quaternions (w, x, y, z), and bodies that turn with constant angular momentum."""

from sim.device.compiler import ti
from sim.device.double import mat3, vec3, vec4

MOST_ROUNDS = 30
"""Of the midpoint's fixed-point iteration; at steps of 0.1 rad it is done after about ten."""


@ti.func
def rotation_of(q: vec4) -> mat3:
    """The rotation matrix of a unit quaternion."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    return mat3(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )


@ti.func
def turned(q: vec4, turn: vec3) -> vec4:
    """`q`, then a turn about the axis `turn` by its length [rad]: the exponential map."""
    half = 0.5 * turn.norm()
    # sin(half) / half, by its series where the quotient would lose digits.
    quotient = 1.0 - half * half / 6.0
    if half > 1e-4:
        quotient = ti.sin(half) / half
    c, s = ti.cos(half), 0.5 * quotient * turn
    u = vec3(q[1], q[2], q[3])
    real, rest = c * q[0] - s.dot(u), c * u + q[0] * s + s.cross(u)
    return vec4(real, rest[0], rest[1], rest[2]).normalized()


@ti.func
def beyond(turn: vec3, arm: vec3) -> vec3:
    """(R - 1) arm - turn x arm for the turn R about the axis `turn` by its length [rad]: how far the arc leads away
    from its tangent (Rodrigues 1840)."""
    angle = turn.norm()
    # (sin(angle) - angle) / angle^3 and (1 - cos(angle)) / angle^2, by their series where digits would be lost.
    odd, even = -1.0 / 6.0 + angle * angle / 120.0, 0.5 - angle * angle / 24.0
    if angle > 1e-2:
        odd = (ti.sin(angle) - angle) / (angle * angle * angle)
        even = (1.0 - ti.cos(angle)) / (angle * angle)
    once = turn.cross(arm)
    return odd * angle * angle * once + even * turn.cross(once)


@ti.func
def angular_velocity(q: vec4, momentum: vec3, inverse_inertia: mat3) -> vec3:
    """R I^-1 R^T L [rad/s] of a body with the inverse inertia in its own axes [1/(kg m^2)]."""
    rotation = rotation_of(q)
    return rotation @ (inverse_inertia @ (rotation.transpose() @ momentum))


@ti.func
def spun(q: vec4, momentum: vec3, inverse_inertia: mat3, dt: ti.f64) -> vec4:
    """The rotation after dt [s] without torque, by the implicit midpoint rule on the rotation group.

    The angular velocity is that of the rotation half-way: the rule is symmetric in time and of second order, so that
    energy stays bounded while the momentum is exact (Hairer et al. 2006, sec. IV.9 and XI.1).
    """
    velocity = angular_velocity(q, momentum, inverse_inertia)
    for _ in range(MOST_ROUNDS):
        last = velocity
        velocity = angular_velocity(turned(q, 0.5 * dt * last), momentum, inverse_inertia)
        if (velocity - last).norm_sqr() <= 1e-28 * velocity.norm_sqr():
            break
    return turned(q, dt * velocity)
