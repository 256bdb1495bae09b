"""Broken input, made by Hypothesis: it is used or refused with a message, and nothing else escapes.

`pytest tests/fuzz` tries some dozens of each kind, `FUZZ=20 pytest tests/fuzz` twenty times as many.
"""
