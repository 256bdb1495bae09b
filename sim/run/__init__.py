"""A run: the world of a scene, its steps from frame to frame, what it writes, its checkpoints, and how it fails.

It knows all materials. Only the commands, `sim.checks` and `live` import it.
"""
