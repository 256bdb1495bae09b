"""Cloth as masses, springs and hinges, where it is pinned, and its energies.

All of `sim.cloth` and its couplings import it.
"""
