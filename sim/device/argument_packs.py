"""Names of the members of argument packs.

Taichi 1.7.4 keeps the arrays of all packs of a kernel by the names of the members alone, until all arguments are
declared: of two packs with a member `size`, the first has none then, and all arrays after it are taken for others. And
no variable of a kernel may have the name of a member.
"""

from __future__ import annotations

import functools
import inspect
import textwrap

OWN_NAMES = (
    ('"__argpack_" + name', '"__argpack_" + arg.arg + "_" + name'),
    (
        "if not isinstance(annotation, primitive_types",
        "if arg_depth == 0 and not isinstance(annotation, primitive_types",
    ),
)
"""What `ASTTransformer.build_FunctionDef` of Taichi says, and what it has to say."""


@functools.cache
def tell_apart() -> None:
    """Take a member for one of its own pack alone, from now on.

    Raises RuntimeError where Taichi is another one than is known here.
    """
    from taichi.lang.ast import ast_transformer

    transformer = ast_transformer.ASTTransformer
    source = textwrap.dedent(inspect.getsource(transformer.build_FunctionDef))
    for old, new in OWN_NAMES:
        if old not in source:
            raise RuntimeError(f"this version of Taichi declares argument packs in another way: it has no {old}")
        source = source.replace(old, new)
    found: dict[str, object] = {}
    exec(compile(source, ast_transformer.__file__, "exec"), vars(ast_transformer), found)
    transformer.build_FunctionDef = found["build_FunctionDef"]
