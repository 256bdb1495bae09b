"""Files of a whole animation for other programs, a module a format: USD and Alembic, glTF, and .blend.

`render.blender` imports it. All of it runs within Blender.
"""
