"""Cloth that is placed through something is moved apart before a run."""
