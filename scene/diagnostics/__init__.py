"""What is wrong with a scene, or may not be what was meant, in the words of whoever wrote it, and what would be right.

`scene` and the specs of the stages import it.
"""
