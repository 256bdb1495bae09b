"""Newton's method for a step of implicit Euler: the energy, its linear system, and where it is least.

Only `sim.cloth.integrators.implicit_euler` imports it.
"""
