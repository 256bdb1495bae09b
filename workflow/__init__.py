"""From a scene to its film: the commands of the stages beside the simulation, and others about films.

A file here is a command, `python -m workflow.reconstruct`; what they share is in the chapters. `sim` and `render` do
not import them.
"""
