"""Emitters and drains: fluid that comes in and goes out.

`sim.run` and `sim.coupling` import it.
"""
