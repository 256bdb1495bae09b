"""Studies: what accuracy a setting costs. A scene is simulated with every combination of some settings, and the error
of one quantity is set against the time that it took."""
