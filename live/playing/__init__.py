"""The run that is played: its thread, actions and events between its steps, its pace, its pictures, its past.

Knows nothing of the page that shows it.
"""
