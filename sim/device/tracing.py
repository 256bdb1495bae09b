"""What Taichi does in Python for a kernel before it compiles it or takes it from the cache, done once.

It reads the source of a function anew wherever one is called, and writes down where each expression stands, with its
lines wrapped for the screen and underlined; and it looks through all modules for the source around each definition, to
see whether that is in a class. Together that took longer than all else until a cached kernel runs.
"""

from __future__ import annotations

import functools
import sys
from types import ModuleType
from typing import Any


def memoize(ti: ModuleType) -> None:
    """Read each function once, describe places in full for errors alone, and ask the interpreter what is a class, from
    now on."""
    kernels = ti.lang.kernel_impl
    kernels.getsourcelines = functools.cache(kernels.getsourcelines)
    kernels.getsourcefile = functools.cache(kernels.getsourcefile)
    kernels._inside_class = _in_class
    context = ti.lang.ast.ast_transformer_utils.ASTTransformerContext
    context.get_pos_info = _in_full_for_errors(context.get_pos_info)


def _in_class(level_of_class_stackframe: int) -> bool:
    """Whether what is being defined is part of a class, whose statement is at this level of the stack."""
    return "__qualname__" in sys._getframe(level_of_class_stackframe - 1).f_locals


def _in_full_for_errors(describe: Any) -> Any:
    @functools.wraps(describe)
    def described(context: Any, node: Any) -> str:
        if sys.exc_info()[0] is not None:
            return describe(context, node)
        return f'File "{context.file}", line {node.lineno + context.lineno_offset}, in {context.func.func.__name__}\n'

    return described
