"""What the commands of the stages do, beside simulating and rendering.

Only these commands import it.
"""
