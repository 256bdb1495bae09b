"""What Taichi does in Python for a kernel before it compiles it or takes it from the cache, done once.

It reads the source of a function anew wherever one is called, and writes down where each expression stands, in lines
that are wrapped for the screen; and it looks through all modules for the source around each definition, to see whether
that is in a class. Together that took longer than all else until a cached kernel runs.
"""

from __future__ import annotations

import functools
import sys
from types import ModuleType
from typing import Any


def memoize(ti: ModuleType) -> None:
    """Read each function once, describe each place once, and ask the interpreter what is a class, from now on."""
    kernels = ti.lang.kernel_impl
    kernels.getsourcelines = functools.cache(kernels.getsourcelines)
    kernels.getsourcefile = functools.cache(kernels.getsourcefile)
    kernels._inside_class = _in_class
    context = ti.lang.ast.ast_transformer_utils.ASTTransformerContext
    context.get_pos_info = _described_once(context.get_pos_info)


def _in_class(level_of_class_stackframe: int) -> bool:
    """Whether what is being defined is part of a class, whose statement is at this level of the stack."""
    return "__qualname__" in sys._getframe(level_of_class_stackframe - 1).f_locals


def _described_once(describe: Any) -> Any:
    known: dict[tuple[object, ...], str] = {}

    @functools.wraps(describe)
    def described(context: Any, node: Any) -> str:
        place = node.lineno, node.col_offset, node.end_lineno, node.end_col_offset
        key = context.func.func, type(node), *place
        if key not in known:
            known[key] = describe(context, node)
        return known[key]

    return described
