"""From frames to what people look at: the film, a contact sheet, tables, plots and a summary.

`python -m workflow.film` imports it.
"""
