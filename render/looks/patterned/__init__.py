"""Looks whose colour differs from place to place: a module each, named in the registry of `render.looks`."""
