"""Angular momentum of the fluid, and the highest point of a sheet."""

import numpy as np


def angular_momentum(probe, view):
    fluid = view.fluid
    total = fluid.mass * np.cross(fluid.points - probe.about, fluid.velocity).sum(axis=0)
    for axis, value in zip("xyz", total, strict=True):
        yield f"angular_momentum_{axis}", value, "kg m^2/s"


def highest(probe, view):
    if view.has_sheet(probe.sheet):
        yield "highest", view.world.cloth.vertices(probe.sheet)[0][:, 1].max(), "m"
