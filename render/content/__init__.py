"""What is in the picture: water, foam, bodies, sheets, containers, ground, lights, camera, and how they move.

`render.blender` imports it. All of it runs within Blender, which may come without NumPy.
"""
