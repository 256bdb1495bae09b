"""Triangles and curvatures of a shell as constraints of extended position-based dynamics.

An energy k C^2 / 2 is the constraint C with the compliance 1 / k (Macklin et al. 2016). Of a triangle, C are the three
strains, which are solved for together, with the matrix of its stiffness; then its area, whose energy is not quadratic,
by its slope and curvature here. Around a point, C are the three kinds of curvature, each a vector.

Damping comes before, and changes velocities: by what each strain and curvature in turn would take from them in an
implicit step. That gives no energy, however strong it is; as a part of the constraints, or after them, it would, since
one sweep leaves them far from their solution. What damps so strongly that it creeps, creeps too fast.
"""

from typing import Any

from sim.cloth.contact.projection import mobility
from sim.cloth.fabric.layout import Drag, Points, StepMotion
from sim.cloth.integrators.xpbd_sums import predict_point
from sim.cloth.shell.elements import barrier, frame, normal_at, strain, strain_rate, widening
from sim.cloth.shell.layout import ShellRest
from sim.device.argument_packs import argpack
from sim.device.compiler import ti
from sim.device.double import Integers, Numbers, Vectors, mat3, vec3

ShellMultipliers: Any = argpack(
    stress_multiplier=Vectors,
    area_multiplier=Numbers,
    bend_multiplier=Vectors,
)
"""Multipliers of strains and areas of triangles, and of the three curvatures of each point."""


@ti.kernel
def predict(
    airy: ti.template(),
    triangles: ti.i32,
    points: ti.i32,
    dt: ti.f64,
    left: ti.i32,
    gravity: vec3,
    wind: vec3,
    p: Points,
    d: Drag,
    multipliers: ShellMultipliers,
    motion: StepMotion,
):
    """Begin a substep: take points to where they would go by themselves; `left`: substeps until held points are at
    their targets."""
    for t in range(triangles):
        multipliers.stress_multiplier[t] = vec3(0.0, 0.0, 0.0)
        multipliers.area_multiplier[t] = 0.0
    for i in range(points):
        for kind in ti.static(range(3)):
            multipliers.bend_multiplier[3 * i + kind] = vec3(0.0, 0.0, 0.0)
    for i in range(points):
        predict_point(airy, i, dt, left, gravity, wind, p, d, motion)


@ti.func
def _stiffness(t: ti.i32, shell: ti.template()) -> mat3:
    c, shear = shell.modulus[t], shell.shear_modulus[t]
    return mat3([[c[0], c[2], 0.0], [c[2], c[1], 0.0], [0.0, 0.0, shear]])


@ti.func
def _slopes(t: ti.i32, k: ti.template(), f: ti.template(), shell: ti.template()) -> mat3:
    """How the three strains grow as corner k of a triangle goes on, as rows [1/m]."""
    u, v = shell.warp_slope[t][k], shell.weft_slope[t][k]
    one, other, both = u * f.warp, v * f.weft, u * f.weft + v * f.warp
    return mat3([[one[0], one[1], one[2]], [other[0], other[1], other[2]], [both[0], both[1], both[2]]])


@ti.func
def _inverse_mass(t: ti.i32, f: ti.template(), p: ti.template(), shell: ti.template()) -> mat3:
    """How the three strains give way to impulses along them [1/(kg m^2)]."""
    found = ti.Matrix.zero(ti.f64, 3, 3)
    for k in ti.static(range(3)):
        rows, w = _slopes(t, k, f, shell), mobility(p, shell.shell_corner[3 * t + k])
        found += w * rows @ rows.transpose()
    return found


@ti.kernel
def project_strains(
    first: ti.i32,
    last: ti.i32,
    dt: ti.f64,
    order: Integers,
    p: Points,
    shell: ShellRest,
    multipliers: ShellMultipliers,
):
    """Solve the triangles of one colour, `first` up to, without, `last` of the order."""
    for entry in range(first, last):
        t = order[entry]
        f = frame(t, shell, p.position)
        e = strain(f)
        soft = 1.0 / (dt * dt)
        stiff = shell.rest_area[t] * _stiffness(t, shell)
        unit = mat3([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        push = stiff @ e + soft * multipliers.stress_multiplier[t]
        change = -(stiff @ _inverse_mass(t, f, p, shell) + soft * unit).inverse() @ push
        multipliers.stress_multiplier[t] += change
        for k in ti.static(range(3)):
            i = shell.shell_corner[3 * t + k]
            p.position[i] += mobility(p, i) * (_slopes(t, k, f, shell).transpose() @ change)
        f = frame(t, shell, p.position)
        law = shell.rest_area[t] * shell.barrier[t] * barrier(f.spread)
        over = ti.cast(0.0, ti.f64)
        for k in ti.static(range(3)):
            u, v, w = shell.warp_slope[t][k], shell.weft_slope[t][k], mobility(p, shell.shell_corner[3 * t + k])
            over += w * widening(u, v, f.warp, f.weft, f.normal).norm_sqr()
        spread = -(law[1] + soft * multipliers.area_multiplier[t]) / (law[2] * over + soft)
        multipliers.area_multiplier[t] += spread
        for k in ti.static(range(3)):
            u, v, i = shell.warp_slope[t][k], shell.weft_slope[t][k], shell.shell_corner[3 * t + k]
            p.position[i] += mobility(p, i) * spread * widening(u, v, f.warp, f.weft, f.normal)


@ti.kernel
def project_curvatures(
    first: ti.i32,
    last: ti.i32,
    dt: ti.f64,
    order: Integers,
    p: Points,
    shell: ShellRest,
    multipliers: ShellMultipliers,
):
    """Solve the curvatures of the points of one colour, `first` up to, without, `last` of the order."""
    for entry in range(first, last):
        i = order[entry]
        soft = 1.0 / (dt * dt)
        normal = normal_at(i, shell, p.position)
        size = normal.norm()
        if size > 0.0:
            normal = normal / size
        for kind in ti.static(range(3)):
            bend, own, inverse_mass = vec3(0.0, 0.0, 0.0), ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
            for k in range(shell.first_beside[i], shell.first_beside[i + 1]):
                weight, j = shell.bend_weight[k][kind], shell.beside[k]
                bend += weight * (p.position[j] - p.position[i])
                own += weight
                inverse_mass += weight * weight * mobility(p, j)
            inverse_mass += own * own * mobility(p, i)
            flat, along = shell.flat_at_rest[i], bend.dot(normal)
            push = flat * bend + ((1.0 - flat) * along - shell.rest_curvature[i][kind]) * normal
            push += soft * multipliers.bend_multiplier[3 * i + kind]
            change = -push / (inverse_mass + soft)
            multipliers.bend_multiplier[3 * i + kind] += change
            for k in range(shell.first_beside[i], shell.first_beside[i + 1]):
                j = shell.beside[k]
                p.position[j] += mobility(p, j) * shell.bend_weight[k][kind] * change
            p.position[i] -= mobility(p, i) * own * change


@ti.kernel
def damp_strains(first: ti.i32, last: ti.i32, dt: ti.f64, order: Integers, p: Points, shell: ShellRest):
    """Slow the strains of the triangles of one colour, `first` up to, without, `last` of the order."""
    for entry in range(first, last):
        t = order[entry]
        f = frame(t, shell, p.position)
        unit = mat3([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        slow = dt * shell.stretch_delay[t] * shell.rest_area[t] * _stiffness(t, shell)
        impulse = -(unit + slow @ _inverse_mass(t, f, p, shell)).inverse() @ (
            slow @ strain_rate(t, f, shell, p.velocity)
        )
        for k in ti.static(range(3)):
            i = shell.shell_corner[3 * t + k]
            p.velocity[i] += mobility(p, i) * (_slopes(t, k, f, shell).transpose() @ impulse)


@ti.kernel
def damp_curvatures(first: ti.i32, last: ti.i32, dt: ti.f64, order: Integers, p: Points, shell: ShellRest):
    """Slow the curvatures around the points of one colour, `first` up to, without, `last` of the order."""
    for entry in range(first, last):
        i = order[entry]
        slow, normal = dt * shell.bend_delay[i], normal_at(i, shell, p.position)
        size = normal.norm()
        if size > 0.0:
            normal = normal / size
            for kind in ti.static(range(3)):
                rate, own, inverse_mass = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
                for k in range(shell.first_beside[i], shell.first_beside[i + 1]):
                    weight, j = shell.bend_weight[k][kind], shell.beside[k]
                    rate += weight * (p.velocity[j] - p.velocity[i]).dot(normal)
                    own += weight
                    inverse_mass += weight * weight * mobility(p, j)
                inverse_mass += own * own * mobility(p, i)
                impulse = -slow * rate / (1.0 + slow * inverse_mass)
                for k in range(shell.first_beside[i], shell.first_beside[i + 1]):
                    j = shell.beside[k]
                    p.velocity[j] += mobility(p, j) * shell.bend_weight[k][kind] * impulse * normal
                p.velocity[i] -= mobility(p, i) * own * impulse * normal
