"""Where fluid has wetted bodies, cloth, containers and the floor, and how far it has dried since.

`workflow.wet` is its command.
"""
