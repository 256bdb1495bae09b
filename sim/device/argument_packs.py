"""Argument packs: several arguments of a kernel as one, declared by `argpack`, whatever the compiler has for that.

Taichi 1.7.4 keeps the arrays of all packs of a kernel by the names of the members alone, until all arguments are
declared: of two packs with a member `size`, the first has none then, and all arrays after it are taken for others. And
no variable of a kernel may have the name of a member. Taichi Forge has mended the first.

Quadrants has data classes in place of packs. It takes them apart by name, so that a function of a kernel has to know
the class of what it is given, where ours take packs of any class (`ti.template()`).
"""

from __future__ import annotations

import functools
import inspect
import textwrap
from dataclasses import is_dataclass, make_dataclass
from typing import Any

from sim.device.compiler import compiler, ti

BY_PACK = ('"__argpack_" + name', '"__argpack_" + arg.arg + "_" + name')
NO_VARIABLE = (
    "if not isinstance(annotation, primitive_types",
    "if arg_depth == 0 and not isinstance(annotation, primitive_types",
)
OWN_NAMES = {"taichi": (BY_PACK, NO_VARIABLE), "taichi_forge": (NO_VARIABLE,)}
"""What `ASTTransformer.build_FunctionDef` of a compiler says, and what it has to say."""


def argpack(**members: Any) -> Any:
    """A kind of argument packs with these members: their types by name.

    The kind has them as `members`, a pack of it has names and values as `items`, and `pack["name"]` is a value.
    """
    if compiler.packs == "argpack":
        return ti.types.argpack(**members)
    items = property(lambda pack: [(name, getattr(pack, name)) for name in members])
    beside = {"members": members, "items": items, "__getitem__": lambda pack, name: getattr(pack, name)}
    return make_dataclass("Pack", members.items(), namespace=beside, frozen=True, eq=False)


@functools.cache
def amend() -> None:
    """Let kernels take packs as ours need them, from now on.

    Raises RuntimeError where the compiler is another one than is known here.
    """
    if compiler.packs == "dataclass":
        _keep_together()
    else:
        _tell_apart()


def _tell_apart() -> None:
    """Take a member for one of its own pack alone."""
    ast_transformer = ti.lang.ast.ast_transformer
    transformer = ast_transformer.ASTTransformer
    source = textwrap.dedent(inspect.getsource(transformer.build_FunctionDef))
    for old, new in OWN_NAMES[compiler.module]:
        if old not in source:
            raise RuntimeError(
                f"this version of {compiler.package} declares argument packs in another way: it has no {old}"
            )
        source = source.replace(old, new)
    found: dict[str, object] = {}
    exec(compile(source, ast_transformer.__file__, "exec"), vars(ast_transformer), found)
    transformer.build_FunctionDef = found["build_FunctionDef"]


def _keep_together() -> None:
    """Let a pack be one thing in a kernel that can be handed on, and not its members alone."""
    transformers = ti.lang.ast.ast_transformers.function_def_transformer
    transformer = transformers.FunctionDefTransformer
    declare = transformer._transform_as_kernel

    def declared(context: Any, node: Any, args: Any) -> None:
        declare(context, node, args)
        scope = context.current_scope()
        for argument in context.func.arg_metas:
            if is_dataclass(argument.annotation):
                scope[argument.name] = Members(context, scope, argument.name, argument.annotation)

    transformer._transform_as_kernel = staticmethod(declared)


class Members:
    """Those of a pack within a kernel of Quadrants, which leaves out the ones that are not asked for."""

    def __init__(self, context: Any, scope: dict[str, Any], name: str, kind: Any):
        self._told = context, scope, name, kind

    def __getattr__(self, member: str) -> Any:
        context, scope, name, kind = self._told
        if member not in kind.members:
            raise AttributeError(member)
        flat = ti.lang._dataclass_util.create_flat_name(name, member)
        if is_dataclass(kind.members[member]):
            return Members(context, scope, flat, kind.members[member])
        pruning = context.global_context.pruning
        if not pruning.enforcing:
            pruning.mark_used(context.func.func_id, flat)
        return scope[flat]
