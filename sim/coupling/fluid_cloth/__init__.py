"""Fluid and cloth: samples of sheets, the forces of both, and particles that do not go through.

Only `sim.coupling` and `sim.run` import it.
"""

MATERIALS = ("fluid", "cloth")
"""Of a scene, for this to be loaded."""
