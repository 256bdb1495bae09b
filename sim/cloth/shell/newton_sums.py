"""What a shell adds to the energy of a step of implicit Euler, to its forces and to their derivatives.

Damping stores (delay / dt) times what strain and curvature would store that differ by as much as they do from those
before the step: turning is not damped.
"""

from sim.cloth.fabric.layout import AlikeRows, BlockMatrix, Points
from sim.cloth.shell.elements import (
    barrier,
    bending_energy,
    bent,
    corner_block,
    curvature,
    frame,
    normal_at,
    pulling,
    set_moments,
    shell_force,
    strain,
    stress_of,
)
from sim.cloth.shell.layout import ShellRest, ShellTrial
from sim.device.compiler import ti
from sim.device.double import Integers, Numbers, Vectors, mat3, vec3


@ti.kernel
def begin(
    triangles: ti.i32, points: ti.i32, start: Vectors, place: Vectors, shell: ShellRest, trial: ShellTrial
) -> ti.i32:
    """Remember strains and curvatures before a step; returns whether an edge turns by more than a right angle."""
    turning = 0
    for t in range(triangles):
        f = frame(t, shell, start)
        trial.strain_before[t] = strain(f)
        for k in ti.static(range(3)):
            one, other = shell.shell_corner[3 * t + k], shell.shell_corner[3 * t + (k + 1) % 3]
            if (start[one] - start[other]).dot(place[one] - place[other]) < 0.0:
                ti.atomic_max(turning, 1)
    for i in range(points):
        trial.curvature_before[i] = curvature(i, shell, start)
    return turning


@ti.kernel
def assess(
    triangles: ti.i32,
    points: ti.i32,
    first: ti.i32,
    dt: ti.f64,
    place: Vectors,
    shell: ShellRest,
    trial: ShellTrial,
    energy_term: Numbers,
):
    """Stress and moments at the places tried; and energies [J], from the `first` term on: of triangles, then of
    points."""
    for t in range(triangles):
        f = frame(t, shell, place)
        e = strain(f)
        since, slow = e - trial.strain_before[t], shell.stretch_delay[t] / dt
        held, slowed = stress_of(t, e, shell), slow * stress_of(t, since, shell)
        law = shell.barrier[t] * barrier(f.spread)
        trial.along_warp[t] = f.warp
        trial.along_weft[t] = f.weft
        trial.shell_normal[t] = f.normal
        trial.stress[t] = held + slowed
        trial.pulling_stress[t] = pulling(held + slowed)
        trial.stiffening[t] = vec3(law[1], law[2], 1.0 + slow)
        energy_term[first + t] = shell.rest_area[t] * (0.5 * (held.dot(e) + slowed.dot(since)) + law[0])
    for i in range(points):
        kinds, normal = bent(i, shell, place), normal_at(i, shell, place)
        size, slow, rest = normal.norm(), shell.bend_delay[i] / dt, shell.rest_curvature[i]
        along, unit = vec3(0.0, 0.0, 0.0), vec3(0.0, 0.0, 0.0)
        if size > 0.0:
            unit = normal / size
            along = kinds @ unit
        since = along - trial.curvature_before[i]
        moment = (1.0 - shell.flat_at_rest[i]) * along + slow * since - rest
        set_moments(i, kinds, unit, size, moment, shell, trial)
        stored = bending_energy(i, kinds, along, shell)
        energy_term[first + triangles + i] = stored + 0.5 * slow * since.norm_sqr()


@ti.kernel
def differentiate(
    points: ti.i32,
    dt: ti.f64,
    place: Vectors,
    p: Points,
    shell: ShellRest,
    trial: ShellTrial,
    row_stiffness: Numbers,
    matrix: BlockMatrix,
    force: Vectors,
):
    """Add forces, and blocks of the diagonal; `row_stiffness`: those of bending [N/m]."""
    for i in range(points):
        if p.mobile[i]:
            force[i] += shell_force(i, shell, trial, place)
            found = ti.Matrix.zero(ti.f64, 3, 3)
            for entry in range(shell.first_corner[i], shell.first_corner[i + 1]):
                t, k = shell.of_corner[entry] // 3, shell.of_corner[entry] % 3
                found += corner_block(t, k, k, shell, trial)
            bending = (1.0 + shell.bend_delay[i] / dt) * row_stiffness[i]
            found += bending * mat3([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
            matrix.diagonal[i] += found


@ti.kernel
def fill_off_diagonal(
    points: ti.i32,
    pairs: ti.i32,
    dt: ti.f64,
    first_side: Integers,
    side: Integers,
    stiffness: Numbers,
    shell: ShellRest,
    trial: ShellTrial,
    matrix: BlockMatrix,
    rows: AlikeRows,
):
    """The blocks of the matrix beside the diagonal: of pairs of points, the sides of triangles that they are, as
    9 triangle + 3 corner of the first + corner of the other; and what bending adds [N/m], the same along all axes."""
    for pair in range(pairs):
        found = ti.Matrix.zero(ti.f64, 3, 3)
        for entry in range(first_side[pair], first_side[pair + 1]):
            found += corner_block(side[entry] // 9, side[entry] // 3 % 3, side[entry] % 3, shell, trial)
        matrix.off_diagonal[matrix.slot[2 * pair]] += found
        matrix.off_diagonal[matrix.slot[2 * pair + 1]] += found.transpose()
    for i in range(points):
        for entry in range(rows.first_alike[i], rows.first_alike[i + 1]):
            rows.alike[entry] = (1.0 + shell.bend_delay[i] / dt) * stiffness[entry]
