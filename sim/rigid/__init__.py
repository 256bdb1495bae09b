"""Rigid bodies that obey forces: a step of theirs is in `model`.

Only `sim.coupling` and `sim.run` import it.
"""

MATERIALS = ("rigid",)
"""Of a scene, for this to be loaded."""
