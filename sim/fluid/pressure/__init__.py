"""Pressure solvers, one file each, and what those share that look for pressures.

`sim.fluid.load_solver` imports the chosen one.
"""
