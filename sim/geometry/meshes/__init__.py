"""Triangle meshes: read, examined, and repaired until they are closed surfaces of solids.

`sim.geometry` and whatever meets meshes import it.
"""
