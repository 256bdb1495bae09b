"""Strain and stress of triangles, and the curvature around points, at places that are tried."""

from typing import Any

from sim.device.compiler import ti
from sim.device.double import mat3, vec3

COLLAPSED = 0.125
"""Below this share of the area at rest, the barrier goes on as a parabola: it stays finite."""
THIN = 1e-12
"""A triangle whose area is less than this share of that at rest has no normal."""

Frame: Any = ti.types.struct(warp=vec3, weft=vec3, normal=vec3, spread=ti.f64)
"""Where warp and weft of unit length at rest are; the normal of both, and the area over that at rest."""


@ti.func
def frame(t: ti.i32, shell: ti.template(), place: ti.template()):
    a, b, c = shell.shell_corner[3 * t], shell.shell_corner[3 * t + 1], shell.shell_corner[3 * t + 2]
    u, v = shell.warp_slope[t], shell.weft_slope[t]
    one, other = place[b] - place[a], place[c] - place[a]
    found = Frame(warp=u[1] * one + u[2] * other, weft=v[1] * one + v[2] * other)
    across = found.warp.cross(found.weft)
    found.spread = across.norm()
    if found.spread > THIN:
        found.normal = across / found.spread
    return found


@ti.func
def strain(f: ti.template()) -> vec3:
    """Green's: along warp and weft, and the angle between both."""
    return vec3(0.5 * (f.warp.norm_sqr() - 1.0), 0.5 * (f.weft.norm_sqr() - 1.0), f.warp.dot(f.weft))


@ti.func
def stress_of(t: ti.i32, e: vec3, shell: ti.template()) -> vec3:
    """By strain, without the barrier [N/m]."""
    c = shell.modulus[t]
    return vec3(c[0] * e[0] + c[2] * e[1], c[2] * e[0] + c[1] * e[1], shell.shear_modulus[t] * e[2])


@ti.func
def barrier(spread: ti.f64) -> vec3:
    """Of J - 1 - ln J: that, and its first and second derivatives."""
    found = vec3(spread - 1.0 - ti.log(ti.max(spread, COLLAPSED)), 0.0, 0.0)
    if spread >= COLLAPSED:
        found[1], found[2] = 1.0 - 1.0 / spread, 1.0 / (spread * spread)
    else:
        beyond, slope, bend = spread - COLLAPSED, -1.0 / COLLAPSED, 1.0 / (COLLAPSED * COLLAPSED)
        found[0] += beyond * (slope + 0.5 * bend * beyond)
        found[1], found[2] = 1.0 + slope + bend * beyond, bend
    return found


@ti.func
def pulling(s: vec3) -> vec3:
    """The part of a stress whose principal values are positive: what pushes would make the energy bend down (Teran et
    al. 2005)."""
    middle, half = 0.5 * (s[0] + s[1]), 0.5 * (s[0] - s[1])
    radius = ti.sqrt(half * half + s[2] * s[2])
    high, low = middle + radius, middle - radius
    found = s
    if high <= 0.0:
        found = vec3(0.0, 0.0, 0.0)
    elif low < 0.0:
        # high v v^T, v along the greater principal value
        found = 0.5 * high * vec3(1.0 + half / radius, 1.0 - half / radius, s[2] / radius)
    return found


@ti.func
def widening(u: ti.f64, v: ti.f64, warp: vec3, weft: vec3, normal: vec3) -> vec3:
    """How the area over that at rest grows as a corner goes on whose slopes are u and v [1/m]."""
    return u * weft.cross(normal) + v * normal.cross(warp)


@ti.func
def corner_force(t: ti.i32, k: ti.i32, shell: ti.template(), trial: ti.template()) -> vec3:
    """What a triangle does to one of its corners by stretching [N]."""
    u, v, s = shell.warp_slope[t][k], shell.weft_slope[t][k], trial.stress[t]
    warp, weft, normal = trial.along_warp[t], trial.along_weft[t], trial.shell_normal[t]
    pull = u * (s[0] * warp + s[2] * weft) + v * (s[2] * warp + s[1] * weft)
    return -shell.rest_area[t] * (pull + trial.stiffening[t][0] * widening(u, v, warp, weft, normal))


@ti.func
def corner_block(t: ti.i32, k: ti.i32, m: ti.i32, shell: ti.template(), trial: ti.template()) -> mat3:
    """How the force on corner k of a triangle falls as corner m goes on [N/m], without what is negative."""
    uk, vk, um, vm = shell.warp_slope[t][k], shell.weft_slope[t][k], shell.warp_slope[t][m], shell.weft_slope[t][m]
    warp, weft, normal = trial.along_warp[t], trial.along_weft[t], trial.shell_normal[t]
    law, p = trial.stiffening[t], trial.pulling_stress[t]
    c = law[2] * shell.modulus[t]
    found = c[0] * uk * um * warp.outer_product(warp) + c[1] * vk * vm * weft.outer_product(weft)
    found += c[2] * (uk * vm * warp.outer_product(weft) + vk * um * weft.outer_product(warp))
    found += law[2] * shell.shear_modulus[t] * (uk * weft + vk * warp).outer_product(um * weft + vm * warp)
    pull = p[0] * uk * um + p[1] * vk * vm + p[2] * (uk * vm + vk * um)
    found += pull * mat3([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    one, other = widening(uk, vk, warp, weft, normal), widening(um, vm, warp, weft, normal)
    found += law[1] * one.outer_product(other)
    return shell.rest_area[t] * found


@ti.func
def normal_at(i: ti.i32, shell: ti.template(), place: ti.template()) -> vec3:
    """Twice the area of the triangles around a point [m^2], along its normal."""
    found = vec3(0.0, 0.0, 0.0)
    for entry in range(shell.first_corner[i], shell.first_corner[i + 1]):
        t = shell.of_corner[entry] // 3
        a = place[shell.shell_corner[3 * t]]
        b, c = place[shell.shell_corner[3 * t + 1]], place[shell.shell_corner[3 * t + 2]]
        found += (b - a).cross(c - a)
    return found


@ti.func
def bent(i: ti.i32, shell: ti.template(), place: ti.template()) -> mat3:
    """The three kinds of curvature around a point as rows, each a vector [J^0.5]."""
    found = ti.Matrix.zero(ti.f64, 3, 3)
    for entry in range(shell.first_beside[i], shell.first_beside[i + 1]):
        found += shell.bend_weight[entry].outer_product(place[shell.beside[entry]] - place[i])
    return found


@ti.func
def curvature(i: ti.i32, shell: ti.template(), place: ti.template()) -> vec3:
    """The three kinds of curvature around a point along its normal [J^0.5]."""
    normal = normal_at(i, shell, place)
    size = normal.norm()
    found = vec3(0.0, 0.0, 0.0)
    if size > 0.0:
        found = bent(i, shell, place) @ (normal / size)
    return found


@ti.func
def bending_energy(i: ti.i32, kinds: mat3, along: vec3, shell: ti.template()) -> ti.f64:
    """Of the curvatures around a point, as vectors and along its normal [J].

    Where sheets are flat at rest, all of the vectors count: they have a direction where the cloth is folded so sharply
    that its normal has none. Of a mesh that is curved at rest they have parts along it, too, that are no curvature.
    """
    flat, rest = shell.flat_at_rest[i], shell.rest_curvature[i]
    squares = flat * (kinds * kinds).sum() + (1.0 - flat) * along.norm_sqr()
    return 0.5 * (squares + rest.norm_sqr()) - rest.dot(along)


@ti.func
def set_moments(
    i: ti.i32, kinds: mat3, unit: vec3, size: ti.f64, moment: vec3, shell: ti.template(), trial: ti.template()
):
    """Keep the moments around a point: `moment` [J^0.5] along its normal, which is `unit`, or 0 where `size` is, the
    length of `normal_at`; and what turns the normal."""
    whole = shell.flat_at_rest[i] * kinds + moment.outer_product(unit)
    trial.warp_moment[i] = vec3(whole[0, 0], whole[0, 1], whole[0, 2])
    trial.weft_moment[i] = vec3(whole[1, 0], whole[1, 1], whole[1, 2])
    trial.twist_moment[i] = vec3(whole[2, 0], whole[2, 1], whole[2, 2])
    trial.normal_push[i] = vec3(0.0, 0.0, 0.0)
    if size > 0.0:
        lean = kinds.transpose() @ moment
        trial.normal_push[i] = (lean - unit.dot(lean) * unit) / size


@ti.func
def normal_rate_at(i: ti.i32, shell: ti.template(), place: ti.template(), velocity: ti.template()) -> vec3:
    """The rate of `normal_at` [m^2/s]."""
    found = vec3(0.0, 0.0, 0.0)
    for entry in range(shell.first_corner[i], shell.first_corner[i + 1]):
        t = shell.of_corner[entry] // 3
        a, b, c = shell.shell_corner[3 * t], shell.shell_corner[3 * t + 1], shell.shell_corner[3 * t + 2]
        one, other = place[b] - place[a], place[c] - place[a]
        found += (velocity[b] - velocity[a]).cross(other) + one.cross(velocity[c] - velocity[a])
    return found


@ti.func
def strain_rate(t: ti.i32, f: ti.template(), shell: ti.template(), velocity: ti.template()) -> vec3:
    """The rate of `strain` [1/s]."""
    a, b, c = shell.shell_corner[3 * t], shell.shell_corner[3 * t + 1], shell.shell_corner[3 * t + 2]
    u, v = shell.warp_slope[t], shell.weft_slope[t]
    one, other = velocity[b] - velocity[a], velocity[c] - velocity[a]
    warp, weft = u[1] * one + u[2] * other, v[1] * one + v[2] * other
    return vec3(f.warp.dot(warp), f.weft.dot(weft), f.warp.dot(weft) + f.weft.dot(warp))


@ti.func
def shell_force(i: ti.i32, shell: ti.template(), trial: ti.template(), place: ti.template()) -> vec3:
    """What stretching and bending do to a point [N], by stress and moments."""
    found = vec3(0.0, 0.0, 0.0)
    for entry in range(shell.first_corner[i], shell.first_corner[i + 1]):
        t, k = shell.of_corner[entry] // 3, shell.of_corner[entry] % 3
        found += corner_force(t, k, shell, trial)
        a, b = shell.shell_corner[3 * t + (k + 1) % 3], shell.shell_corner[3 * t + (k + 2) % 3]
        push = trial.normal_push[i] + trial.normal_push[a] + trial.normal_push[b]
        found -= (place[a] - place[b]).cross(push)
    for entry in range(shell.first_beside[i], shell.first_beside[i + 1]):
        j, w, mirror = shell.beside[entry], shell.bend_weight[entry], shell.bend_weight[shell.mirrored[entry]]
        found += w[0] * trial.warp_moment[i] + w[1] * trial.weft_moment[i] + w[2] * trial.twist_moment[i]
        found -= mirror[0] * trial.warp_moment[j] + mirror[1] * trial.weft_moment[j] + mirror[2] * trial.twist_moment[j]
    return found
