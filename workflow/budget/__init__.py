"""Budgets: the finest detail of a film that is predicted to be done in a given time."""
