"""Probes: what a scene measures while it runs, one file each; `spec` has their settings, `sampling` their rows."""
