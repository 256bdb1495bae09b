"""Light that comes through to the other side of what is thin."""

from __future__ import annotations

from typing import Any

from render.content.nodes import Graph


def lit_through(graph: Graph, share: float, surface: Any, color: Any) -> Any:
    """A surface through which a share of the light comes, scattered.

    Of a sheet that is drawn with a thickness, light leaves by the far side as it comes: the near one scattered it.
    """
    both = graph.mix(share, surface, graph.node("BsdfTranslucent", {"Color": color}).outputs[0])
    if not graph.thick:
        return both
    inside = graph.node("NewGeometry").outputs["Backfacing"]
    return graph.mix(inside, both, graph.node("BsdfTransparent", {"Color": (1.0,) * 4}).outputs[0])
