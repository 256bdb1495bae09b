"""Triangles of a cone."""

SECTIONS = 64
