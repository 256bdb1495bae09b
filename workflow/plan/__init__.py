"""What is to be made: the jobs of a film, what each depends on, and what is there already.

It imports no stage but its settings, so that planning is quick; the Snakefile and the commands import it.
"""
