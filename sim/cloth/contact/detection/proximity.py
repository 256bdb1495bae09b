"""Nearest points of a point and a triangle, and of two edges."""

from typing import Any

from sim.device.compiler import ti
from sim.device.double import vec3, vec4

Nearest: Any = ti.types.struct(weight=vec4, apart=vec3)
"""Weights of the four points, positive for the point or the first edge; and the way there from the other side [m]."""


@ti.func
def _share(part: ti.f64, whole: ti.f64) -> ti.f64:
    found = ti.cast(0.0, ti.f64)
    if whole > 0.0:
        found = ti.math.clamp(part / whole, 0.0, 1.0)
    return found


@ti.func
def point_triangle(x: vec3, a: vec3, b: vec3, c: vec3) -> Nearest:
    """Ericson 2005, sec. 5.1.5."""
    ab, ac, ax = b - a, c - a, x - a
    d1, d2 = ab.dot(ax), ac.dot(ax)
    bx, cx = x - b, x - c
    d3, d4 = ab.dot(bx), ac.dot(bx)
    d5, d6 = ab.dot(cx), ac.dot(cx)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    v, w = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
    if d1 <= 0.0 and d2 <= 0.0:
        pass
    elif d3 >= 0.0 and d4 <= d3:
        v = 1.0
    elif d6 >= 0.0 and d5 <= d6:
        w = 1.0
    elif vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        v = _share(d1, d1 - d3)
    elif vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        w = _share(d2, d2 - d6)
    elif va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        w = _share(d4 - d3, (d4 - d3) + (d5 - d6))
        v = 1.0 - w
    else:
        total = va + vb + vc
        v = _share(vb, total)
        w = _share(vc, total)
    u = 1.0 - v - w
    return Nearest(weight=vec4(1.0, -u, -v, -w), apart=x - (u * a + v * b + w * c))


@ti.func
def edge_edge(a: vec3, b: vec3, c: vec3, d: vec3) -> Nearest:
    """Ericson 2005, sec. 5.1.9."""
    u, v, r = b - a, d - c, a - c
    uu, vv, uv, ur, vr = u.dot(u), v.dot(v), u.dot(v), u.dot(r), v.dot(r)
    s = ti.cast(0.0, ti.f64)
    cross = uu * vv - uv * uv
    if cross > 1e-12 * uu * vv:
        s = ti.math.clamp((uv * vr - ur * vv) / cross, 0.0, 1.0)
    t = _share(uv * s + vr, vv)
    s = _share(uv * t - ur, uu)
    return Nearest(weight=vec4(1.0 - s, s, t - 1.0, -t), apart=a + s * u - (c + t * v))


@ti.func
def nearest(edges: ti.template(), p: vec3, q: vec3, r: vec3, s: vec3) -> Nearest:
    """Of the edges p q and r s, or of the point p and the triangle q r s."""
    found = Nearest()
    if ti.static(edges):
        found = edge_edge(p, q, r, s)
    else:
        found = point_triangle(p, q, r, s)
    return found
