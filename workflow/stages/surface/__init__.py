"""From particles to a surface: whole layers, lone drops, splashsurf, and ends that are flush with walls.

`python -m workflow.reconstruct` imports it.
"""
