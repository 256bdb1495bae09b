"""How rigid bodies move: free motion, and the impulses of contacts with friction and restitution.

`sim.rigid` and its couplings import it.
"""
