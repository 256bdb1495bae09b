"""Looks of water and foam, and of what attributes say of the fluid."""
