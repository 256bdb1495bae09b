"""Bodies that obey forces in the equations of implicit viscosity: a row of numbers for each, and the steps of conjugate
gradients on them, for kernels that do the same for particles."""

from sim.device.arrays import DoubleTable, vec3, vector
from sim.device.compiler import ti

RESIDUAL, SEARCH, IMAGE, CHANGE, INVERSE, CENTRE, MASS, INERTIA, COLUMNS = 0, 6, 12, 18, 24, 60, 63, 64, 73
"""Where the numbers of a body begin in its row: vectors of a velocity and an angular velocity, the preconditioner by
rows, centre of mass [m], mass and inertia [m^2] by rows over the mass of a particle."""


@ti.func
def search_velocity(bodies: DoubleTable, body: ti.i32, x: vec3) -> vec3:
    """Where the search of a body takes its motion at x."""
    arm = x - vector(bodies, body, CENTRE)
    return vector(bodies, body, SEARCH) + vector(bodies, body, SEARCH + 3).cross(arm)


@ti.func
def solved(bodies: DoubleTable, b: ti.i32, row: ti.template()) -> ti.f64:
    """A component of the preconditioned residual."""
    value = ti.cast(0.0, ti.f64)
    for column in ti.static(range(6)):
        value += bodies[b, INVERSE + 6 * row + column] * bodies[b, RESIDUAL + column]
    return value


@ti.func
def search_curvature(bodies: DoubleTable) -> ti.f64:
    """Search times image."""
    value = ti.cast(0.0, ti.f64)
    for b in range(bodies.shape[0]):
        for k in ti.static(range(6)):
            value += bodies[b, SEARCH + k] * bodies[b, IMAGE + k]
    return value


@ti.func
def advance(bodies: DoubleTable, length: ti.f64) -> ti.f64:
    """Go on by `length` along the search; returns the residual times the preconditioned one."""
    value = ti.cast(0.0, ti.f64)
    for b in range(bodies.shape[0]):
        for k in ti.static(range(6)):
            bodies[b, CHANGE + k] += length * bodies[b, SEARCH + k]
            bodies[b, RESIDUAL + k] -= length * bodies[b, IMAGE + k]
        for k in ti.static(range(6)):
            value += bodies[b, RESIDUAL + k] * solved(bodies, b, k)
    return value


@ti.func
def redirect(bodies: DoubleTable, turning: ti.f64):
    """Turn the search to the preconditioned residual."""
    for b in range(bodies.shape[0]):
        for k in ti.static(range(6)):
            bodies[b, SEARCH + k] = solved(bodies, b, k) + turning * bodies[b, SEARCH + k]
