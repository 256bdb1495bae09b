"""Accuracy: the cheapest settings that studies found exact enough."""
