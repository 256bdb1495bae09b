"""Time integration of cloth: implicit Euler by Newton's method, symplectic Euler, XPBD.

`sim.cloth.load_integrator` imports the chosen one.
"""
