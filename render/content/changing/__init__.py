"""Objects that have another shape in every frame: water, sheets of cloth, foam.

`render.content.scene` imports it.
"""
