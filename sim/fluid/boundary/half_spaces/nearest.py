"""Which half-space a solid is to a particle: unit normal and distance of the nearest point of its surface.

Where a surface bulges, less of it is near than of a plane at the same distance: the distance is longer by what makes
the density right (`sim.fluid.boundary.calibration.curvature_shift`). A thin wall has two sides. Each particle sees the
one that it is on: with `near`, the half-space that it saw before, the other side does not count, and where there is
nothing else the half-space goes on as it was.
"""

from sim.device.arrays import real, vec4
from sim.device.compiler import ti
from sim.device.double import vec3 as vec3d
from sim.device.double import vec4 as vec4d
from sim.fluid.boundary.half_spaces.band import FAR, on_band
from sim.fluid.boundary.half_spaces.curvature import curvature_of, shift_of
from sim.fluid.boundary.half_spaces.of_mesh import mesh_half_space, mesh_half_spaces
from sim.geometry.distance.narrow_band import OPPOSITE
from sim.geometry.distance.sdf import (
    BOX,
    CAPSULE,
    CYLINDER,
    GRID,
    PLANE,
    SPHERE,
    TORUS,
    distance_to_box,
    distance_to_capsule,
    distance_to_cylinder,
    distance_to_plane,
    distance_to_sphere,
    distance_to_torus,
)

CURVED = sum(1 << kind for kind in (SPHERE, BOX, CAPSULE, CYLINDER, TORUS))
"""Bits of the primitives that end."""


@ti.func
def nearest_half_space(
    s: ti.i32,
    p: vec3d,
    near: vec4,
    hollow: bool,
    kinds: ti.template(),
    solids: ti.template(),
) -> vec4:
    """Unit normal and distance [m] of a solid at p, both in its own frame; `near`: normal and offset there of the
    half-space that it was before; kinds: a bit for each kind that there is."""
    found = vec4(0.0, 1.0, 0.0, FAR)
    if solids.kind[s] == GRID:
        if ti.static(kinds >> GRID & 1):
            if near.w < FAR:
                found = on_band(s, p, solids.size[s].w, near, hollow, solids)
    else:
        found = on_shape(s, p, kinds, solids)
        if solids.kind[s] != PLANE and found.xyz.dot(near.xyz) < OPPOSITE:
            found = plane_of(near, p)
    return found


@ti.func
def on_shape(
    s: ti.i32,
    p: vec3d,
    kinds: ti.template(),
    solids: ti.template(),
) -> vec4:
    """Unit normal and distance [m] of a plane or primitive at p, on whichever side that is."""
    found = vec4(0.0, 1.0, 0.0, FAR)
    if ti.static(kinds >> PLANE & 1):
        if solids.kind[s] == PLANE:
            found = ti.cast(distance_to_plane(p), real)
    if ti.static(kinds & CURVED):
        if solids.kind[s] != PLANE and solids.kind[s] != GRID:
            found = on_primitive(solids.kind[s], p, solids.size[s], kinds, solids.shift)
    return found


@ti.func
def half_spaces(
    s: ti.i32,
    p: vec3d,
    reach: real,
    kinds: ti.template(),
    solids: ti.template(),
):
    """Normals and offsets of up to three half-spaces that a solid is to p within `reach` [m], whatever it was before;
    FAR where it is none."""
    first, second, third = vec4(0.0, 1.0, 0.0, FAR), vec4(0.0, 1.0, 0.0, FAR), vec4(0.0, 1.0, 0.0, FAR)
    if solids.kind[s] == GRID:
        if ti.static(kinds >> GRID & 1):
            first, second, third = mesh_half_spaces(s, p, solids.size[s].w, reach, solids)
    else:
        first = plane_of(on_shape(s, p, kinds, solids), p)
    return first, second, third


@ti.func
def half_space(
    s: ti.i32,
    p: vec3d,
    kinds: ti.template(),
    solids: ti.template(),
) -> vec4:
    """The one of them that tells which side of the surface p is on."""
    found = vec4(0.0, 1.0, 0.0, FAR)
    if solids.kind[s] == GRID:
        if ti.static(kinds >> GRID & 1):
            found = mesh_half_space(s, p, solids.size[s].w, solids)[0]
    else:
        found = plane_of(on_shape(s, p, kinds, solids), p)
    return found


@ti.func
def plane_of(at: vec4, p: vec3d) -> vec4:
    """Unit normal and offset of the plane that p is this normal and distance from."""
    return vec4(at.xyz, at.xyz.dot(ti.cast(p, real)) - at.w)


@ti.func
def on_primitive(what: ti.i32, p: vec3d, half: vec4, kinds: ti.template(), shift: ti.types.vector(2, real)) -> vec4:
    """In closed form; only the kinds that a scene has are compiled."""
    first, second = ti.cast(half.x, ti.f64), ti.cast(half.y, ti.f64)
    found = vec4d(0.0)
    if ti.static(kinds >> SPHERE & 1):
        if what == SPHERE:
            found = distance_to_sphere(p, first)
    if ti.static(kinds >> BOX & 1):
        if what == BOX:
            found = distance_to_box(p, ti.cast(half.xyz, ti.f64))
    if ti.static(kinds >> CAPSULE & 1):
        if what == CAPSULE:
            found = distance_to_capsule(p, first, second)
    if ti.static(kinds >> CYLINDER & 1):
        if what == CYLINDER:
            found = distance_to_cylinder(p, first, second)
    if ti.static(kinds >> TORUS & 1):
        if what == TORUS:
            found = distance_to_torus(p, first, second)
    one = ti.cast(found, real)
    curvature = half.w * curvature_of(what, half, ti.cast(p, real), one.xyz, one.w)
    return vec4(half.w * one.xyz, half.w * one.w + shift_of(curvature, half.w * one.w, shift))
