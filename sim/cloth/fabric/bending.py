"""The angle between two triangles at their common edge."""

from typing import Any

from sim.device.compiler import ti
from sim.device.double import vec3

FLAT = 1e-12
"""A triangle with less of this share of its edge's length squared is too thin to have a normal."""

Hinge: Any = ti.types.struct(angle=ti.f64, p=vec3, q=vec3, r=vec3, s=vec3)
"""The angle [rad], 0 where flat, and its gradients by the ends p, q of the edge and by the third corners [1/m]."""


@ti.func
def fold(p: vec3, q: vec3, r: vec3, s: vec3) -> Hinge:
    """Of the triangles p, q, r and p, q, s (Bridson et al. 2003, sec. 4)."""
    edge = q - p
    length = edge.norm()
    one, other = (r - p).cross(r - q), (s - q).cross(s - p)
    squared = vec3(one.norm_sqr(), other.norm_sqr(), length * length)
    least = FLAT * squared[2] * squared[2]
    nothing = vec3(0.0, 0.0, 0.0)
    hinge = Hinge(angle=0.0, p=nothing, q=nothing, r=nothing, s=nothing)
    if squared[0] > least and squared[1] > least and squared[2] > 0.0:
        along = edge / length
        by_r, by_s = one / squared[0], other / squared[1]
        hinge.r = length * by_r
        hinge.s = length * by_s
        hinge.p = (r - q).dot(along) * by_r + (s - q).dot(along) * by_s
        hinge.q = -(r - p).dot(along) * by_r - (s - p).dot(along) * by_s
        hinge.angle = -ti.atan2(one.cross(other).dot(along), one.dot(other))
    return hinge


@ti.func
def turned(angle: ti.f64, from_angle: ti.f64) -> ti.f64:
    """The shorter way from one angle to the other [rad]."""
    displacement = angle - from_angle
    whole = ti.cast(2.0, ti.f64) * ti.acos(ti.cast(-1.0, ti.f64))
    return displacement - whole * ti.round(displacement / whole)
