"""`tidemill doctor`: what of this machine and its packages would keep films from being made, each with its remedy.

Everything that may fail or crash is tried in a process of its own: the doctor speaks where nothing else runs.
"""
