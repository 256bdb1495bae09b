"""What the fluid meets: to a particle every solid is the half-space beyond the nearest point of its surface, and sheets
are samples (Akinci et al. 2013b).

Chapters of the fluid and the couplings of the fluid import it.
"""
