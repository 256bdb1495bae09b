"""Foam, spray and air bubbles that a moving fluid makes (Ihmsen et al. 2012).

They follow the fluid and do not act on it, so they are found from its frames afterwards, and foam that is changed
repeats no simulation.
"""
