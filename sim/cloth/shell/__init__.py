"""Cloth as a thin shell of finite elements: triangles resist stretching, the curvature around points bending.

Only with `model: fem` is it loaded. `sim.cloth.fabric.mesh` and the integrators import it.
"""
