"""Signed distances (SDF): closest points on meshes, a narrow band around them, and closed forms on the device.

`sim.geometry` and whatever meets solids import it.
"""
