"""What is near what: particles by compact hashing, boxes by sweep and prune, moving primitives by a tree of boxes.

Knows no material; all of them may import it.
"""
