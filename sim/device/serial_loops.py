"""Loops that run in the thread which launches a kernel.

Taichi hands every outermost loop to its pool of threads and waits, also where that has a single one. That takes 30 to
50 us a loop, longer than most loops of a small scene run. Compiled as serial, they cost nothing but their work.
"""

from __future__ import annotations

import functools
from typing import Any

_wanted = False


def choose(*, serial: bool) -> None:
    """Compile loops as serial, or as Taichi does, from now on."""
    global _wanted
    _wanted = serial
    _install()


@functools.cache
def _install() -> None:
    from sim.device.compiler import ti

    transformer = ti.lang.ast.ast_transformer.ASTTransformer
    build = transformer.build_For

    def built(context: Any, node: Any) -> Any:
        if _wanted and transformer.get_decorator(context, node.iter) != "static":
            context.ast_builder.strictly_serialize()
        return build(context, node)

    transformer.build_For = staticmethod(built)
