"""Accelerations of particles other than by pressure: one file a force, registered in `registry`.

Pressure solvers and couplings of the fluid import it.
"""
