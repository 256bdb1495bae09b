"""Where cloth and solids come near each other: trees of boxes, distances, and continuous collision detection (CCD).

Of `sim.cloth` only `contact` imports it; `sim.coupling.fluid_cloth` looks for particles with the same trees.
"""
