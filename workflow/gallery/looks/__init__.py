"""docs/looks.md: every look with a picture of it, both made from docs/gallery/looks.yaml.

Nothing imports it.
"""
