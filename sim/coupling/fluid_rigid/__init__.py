"""Fluid and bodies that obey forces: pressures, friction and lubrication between them.

Only `sim.coupling` and `sim.run` import it.
"""

MATERIALS = ("fluid", "rigid")
"""Of a scene, for this to be loaded."""
