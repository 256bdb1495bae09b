"""The contacts of one pair of bodies while they are being found: few, well spread, the deepest always among them, and
the same ones from step to step while bodies rest."""

from sim.device.argument_packs import argpack
from sim.device.compiler import ti
from sim.device.double import Numbers, Vectors, vec3

MOST = 8
"""Contacts of a pair that are kept."""
FEW = 4
"""Of a pair of convex bodies: what a face needs to stand on."""
SAME_PLACE = 0.01
"""Contacts nearer to one another than this share of the smaller body are one."""
CLOSED = 1e-5
"""Gaps that differ by less than this share of the smaller body are the same: else bodies at rest would for ever close
what rounding opens, and rounding would choose anew in every step which contacts of two flat faces are kept."""
NEARER = 0.999999
"""Two contacts are more alike than two others where their squared difference is less than this share of theirs."""


Found = argpack(at=Vectors, out=Vectors, apart=Numbers, bend=Numbers)
"""Contacts as they are found, MOST places for each pair: place [m], normal, gap [m] and bend [m/s^2]."""


@ti.func
def _apart(place: vec3, normal: vec3, other_place: vec3, other_normal: vec3, size: ti.f64) -> ti.f64:
    """Squared difference of two contacts, as a share of `size` [m]: one of direction weighs as one of place."""
    return (place - other_place).norm_sqr() / (size * size) + (normal - other_normal).norm_sqr()


@ti.func
def add(
    first: ti.i32,
    count: ti.i32,
    most: ti.i32,
    size: ti.f64,
    place: vec3,
    normal: vec3,
    gap: ti.f64,
    bend: ti.f64,
    found: ti.template(),
) -> ti.i32:
    """Keep a contact among the `count` from index `first` on, or drop the one that tells least; returns their number.

    size [m]: of the smaller body; place [m] and normal of the contact, the gap [m] negative in overlap; bend: how fast
    the turning of the body takes its point off the other one [m/s^2], beyond what its velocity does.
    """
    same = -1
    for k in range(count):
        near = _apart(place, normal, found.at[first + k], found.out[first + k], size)
        if same < 0 and near < SAME_PLACE * SAME_PLACE:
            same = k
    dropped, kept = -1, count
    if same >= 0:
        dropped = count if gap >= found.apart[first + same] else same
    elif count < most:
        dropped, kept = count, count + 1
    else:
        # Of the two that are most alike, the new one being the last, the shallower one goes, or the later one.
        least = ti.cast(ti.math.inf, ti.f64)
        deeper = CLOSED * size
        for i in range(count):
            near = _apart(place, normal, found.at[first + i], found.out[first + i], size)
            if near < NEARER * least:
                least = near
                dropped = i if gap < found.apart[first + i] - deeper else count
            for j in range(i):
                near = _apart(
                    found.at[first + j], found.out[first + j], found.at[first + i], found.out[first + i], size
                )
                if near < NEARER * least:
                    least = near
                    dropped = j if found.apart[first + i] < found.apart[first + j] - deeper else i
    if dropped < kept:
        found.at[first + dropped], found.out[first + dropped] = place, normal
        found.apart[first + dropped], found.bend[first + dropped] = gap, bend
    return kept
