"""Solids that stand or move as the scene prescribes: bodies, walls of containers, planes.

Knows no material; `sim.coupling`, `sim.run` and the materials import it.
"""
