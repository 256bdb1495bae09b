"""Where rigid bodies touch: shapes as contacts know them, narrow phase, contact manifolds, the table of all contacts.

`sim.rigid` and its couplings import it.
"""
