"""Contacts of cloth with itself and with solids: found with continuous collision detection (CCD), kept, and solved.

The integrators and the couplings of cloth import it.
"""
