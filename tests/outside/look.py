"""A light of its own."""


def build(graph, look, size):
    return graph.node("Emission", {"Color": (1.0, 0.0, 1.0, 1.0), "Strength": look.strength}).outputs[0], None
