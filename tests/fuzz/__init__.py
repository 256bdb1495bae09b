"""Broken input, made by Hypothesis: it is used or refused with a message, and nothing else escapes.

`pytest tests/fuzz` tries a hundred or so of each kind, `FUZZ=20 pytest tests/fuzz` twenty times as many.
"""
