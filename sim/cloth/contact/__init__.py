"""Contacts of cloth with itself and with solids: found (`detection`), kept from step to step, and solved.

The integrators and the couplings of cloth import it.
"""
