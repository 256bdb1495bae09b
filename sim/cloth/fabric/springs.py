"""One spring between two mass points, with a damper beside it."""

from sim.device.compiler import ti
from sim.device.double import vec3

SHORT = 1e-12
"""A spring shorter than this [m] has no direction, and pulls nowhere."""


@ti.func
def line(one: vec3, other: vec3):
    """Unit vector from the other end to the one, and the length [m]; zero without one."""
    apart = one - other
    length = apart.norm()
    along = vec3(0.0, 0.0, 0.0)
    if length > SHORT:
        along = apart / length
    return along, length


@ti.func
def block(stiffness: ti.f64, tension: ti.f64, length: ti.f64):
    """How the force changes along the spring and across it [N/m]: k along, tension / length across (Baraff & Witkin
    1998), without what a spring under pressure takes away, so that it stays positive (Choi & Ko 2002)."""
    across = ti.cast(0.0, ti.f64)
    if length > SHORT:
        across = ti.max(tension, 0.0) / length
    return stiffness, across
