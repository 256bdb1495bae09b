"""What every package uses and what knows nothing of scenes or physics: commands, signals, files, times.

Imports none of the others; all may import it.
"""
