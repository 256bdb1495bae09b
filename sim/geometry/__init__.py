"""Shapes: from their settings to placed solids with volume, inside, distance and mass.

Knows no material; all of them may import it.
"""
