"""Blender: as a package or installed beside, its settings for Cycles, and the loop over the frames of a job.

`python -m render` imports it; what is in the picture is in `render.content`.
"""
