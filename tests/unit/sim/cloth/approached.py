"""A kernel for `test_ccd.py`: it cannot be in a file with postponed annotations."""

from sim.cloth.contact.detection.ccd import approach
from sim.cloth.contact.detection.proximity import nearest
from sim.device.compiler import ti
from sim.device.double import vec3

Places = ti.types.ndarray(dtype=ti.f64, ndim=3)
Rows = ti.types.ndarray(dtype=ti.f64, ndim=2)


@ti.func
def place(points: Places, k: ti.i32, corner: ti.i32) -> vec3:
    return vec3(points[k, corner, 0], points[k, corner, 1], points[k, corner, 2])


@ti.kernel
def find(
    edges: ti.template(),
    thickness: ti.f64,
    early: ti.f64,
    least: ti.f64,
    start: Places,
    way: Places,
    found: Rows,
    distance: Rows,
):
    """Of each pair start, time, narrow, and the vector and weights of the nearest points at the start and then; and the
    distance at as many times from 0 to 1 as there is room for."""
    for k in range(found.shape[0]):
        p, q, r, s = place(start, k, 0), place(start, k, 1), place(start, k, 2), place(start, k, 3)
        dp, dq, dr, ds = place(way, k, 0), place(way, k, 1), place(way, k, 2), place(way, k, 3)
        met = approach(edges, p, q, r, s, dp, dq, dr, ds, thickness, early, least)
        found[k, 0], found[k, 1], found[k, 2] = met.start, met.time, ti.cast(met.narrow, ti.f64)
        for axis in ti.static(range(3)):
            found[k, 3 + axis], found[k, 10 + axis] = met.start_apart[axis], met.apart[axis]
        for corner in ti.static(range(4)):
            found[k, 6 + corner], found[k, 13 + corner] = met.start_weight[corner], met.weight[corner]
        for n in range(distance.shape[1]):
            t = ti.cast(n, ti.f64) / ti.cast(distance.shape[1] - 1, ti.f64)
            distance[k, n] = nearest(edges, p + t * dp, q + t * dq, r + t * dr, s + t * ds).apart.norm()
