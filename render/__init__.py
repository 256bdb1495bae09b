"""The render stage: simulated bodies and the water's surface become pictures, by Blender's Cycles.

Imports no Taichi. Inside an installed Blender only the standard library and bpy are needed.
"""
