"""The compiler of kernels, Taichi: its choice and start, arrays and argument packs, launching, caching, order of sums.

Imports nothing of `sim`; all of `sim` may import it.
"""
