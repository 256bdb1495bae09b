"""Foam, spray and air bubbles that a moving fluid makes (Ihmsen, Akinci, Akinci & Teschner 2012, "Unified Spray, Foam
and Air Bubbles for Particle-Based Fluids").

They follow the fluid and do not act on it, so they are found from its frames afterwards, and foam that is changed
repeats no simulation.
"""
