"""What is known of a scene before it runs: what it models, what would be refused, what may not be what was meant.

Only `python -m sim` and what plans films import it.
"""
