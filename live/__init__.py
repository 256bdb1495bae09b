"""A simulation that runs while it is watched and changed, in a browser."""
