"""A package that adds one of everything to Tidemill; `tests/unit/test_additions.py` installs it elsewhere."""
