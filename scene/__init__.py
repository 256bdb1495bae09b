"""The scene file: YAML with the line of every key, quantities with units, presets, events, the names in it, and the
settings of all stages made from it.

`settings`, `units`, `notation` and `diagnostics.suggestions` import nothing of the project, and all may import them;
`load` combines the settings of the stages, of which it imports the specs alone.
"""
