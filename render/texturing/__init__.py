"""Images on bodies: where they lie, and what of a material they give.

`render.looks` and `render.content` import it.
"""

MARK = "tidemill-unreadable:"
"""Begins the line on standard output that says which images cannot be read; all else is Blender's own."""
WHOLE = "-"
"""Instead of the number of an image in a file: the file is the image."""
