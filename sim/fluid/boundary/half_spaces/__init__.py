"""Which half-spaces a solid is to a particle: the nearest point of a primitive or mesh, its normal and its curvature.

Imports `sim.device` and `sim.geometry`; `sim.fluid.boundary` and couplings import it.
"""
