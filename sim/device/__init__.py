"""Taichi: its start, precision, arrays and their declaration, launching and caching of kernels, sums in a fixed order.

Imports nothing of `sim`; all of `sim` may import it.
"""
