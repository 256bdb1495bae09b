"""Wedges: one scene at every combination of some values, as films of their own and as one sheet and one table."""
