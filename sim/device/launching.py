"""Kernels launched again with the same arrays, on a CPU.

Taichi looks at every argument of every call and packs it anew, which takes some ten microseconds an array: for a scene
of a few bodies or a small cloth longer than the work itself. What a call packs is kept here, and a later one with the
same arrays only says what has changed: the numbers.
"""

from __future__ import annotations

import functools
import weakref
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

TEMPLATE, REAL, WHOLE, NATURAL, ARRAY, PACK, MATRIX = range(7)
"""Kinds of arguments."""
MOST = 4096
"""Calls that are kept; beyond it all are forgotten."""


@dataclass(frozen=True)
class Packed:
    """A call as Taichi launches it; numbers: where each is among the arguments, and what sets it."""

    launch: Callable[[], None]
    numbers: tuple[tuple[int, Callable[[Any], None]], ...]
    told: Callable[[], Any]
    alive: tuple[weakref.ref, ...]


_packed: dict[tuple, Packed] = {}
_seen: set[tuple] = set()


def forget() -> None:
    """Forget all calls: Taichi has been started anew."""
    _packed.clear()
    _seen.clear()


@functools.cache
def install() -> None:
    """Launch calls of kernels from what is kept of them, from now on."""
    from sim.device.compiler import ti

    Kernel = ti.lang.kernel_impl.Kernel
    call = Kernel.__call__

    @functools.wraps(call)
    def launched(kernel: Any, *args: object, **options: object) -> object:
        key = None if options else _key(kernel, args)
        if key is None:
            return call(kernel, *args, **options)
        packed = _packed.get(key)
        if packed is not None:
            for place, change in packed.numbers:
                change(args[place])
            packed.launch()
            return packed.told()
        found = call(kernel, *args)
        if key in _seen:
            _keep(key, _pack(kernel, args, key))
        elif len(_seen) < MOST:
            _seen.add(key)
        return found

    Kernel.__call__ = launched


def _keep(key: tuple, packed: Packed) -> None:
    _seen.discard(key)
    if len(_packed) >= MOST:
        forget()
    _packed[key] = packed


def _key(kernel: Any, args: tuple) -> tuple | None:
    """What has to be the same for a call to be launched again; None where that cannot be told."""
    kinds = _kinds(kernel)
    if kinds is None or len(kinds) != len(args):
        return None
    found: list[object] = [id(kernel)]
    for kind, arg in zip(kinds, args, strict=True):
        if kind in (ARRAY, PACK):
            if not isinstance(arg, _held()) or not _lies_whole(arg):
                return None
            found.append(id(arg))
        elif kind == TEMPLATE:
            if not isinstance(arg, bool | int):
                return None
            found.append(arg)
        elif kind == MATRIX:
            if not hasattr(arg, "entries"):
                return None
            found.append(tuple(arg.entries))
        elif not isinstance(arg, _numbers()):
            return None
    return tuple(found)


@functools.cache
def _numbers() -> tuple[type, ...]:
    import numpy as np

    return int, float, np.integer, np.floating


@functools.cache
def _held() -> tuple[type, ...]:
    """Types of arguments that stay where they are."""
    import numpy as np

    from sim.device.compiler import ti

    return ti.Ndarray, ti.lang.argpack.ArgPack, np.ndarray


def _lies_whole(arg: Any) -> bool:
    """Whether Taichi would not copy an array first."""
    return not hasattr(arg, "flags") or arg.flags.c_contiguous


@functools.cache
def _kinds(kernel: Any) -> tuple[int, ...] | None:
    """Of all arguments of a kernel; None where one of them is of another kind, or a pack in which there is a pack."""
    from sim.device.compiler import ti

    ArgPackType = ti.lang.argpack.ArgPackType
    reals, integers = ti.types.primitive_types.real_type_ids, ti.types.primitive_types.integer_type_ids
    found = []
    for argument in kernel.arguments:
        needed = argument.annotation
        if isinstance(needed, ti.template) or needed is ti.template:
            found.append(TEMPLATE)
        elif isinstance(needed, ArgPackType):
            if any(isinstance(member, ArgPackType) for member in needed.members.values()):
                return None
            found.append(PACK)
        elif isinstance(needed, ti.types.ndarray_type.NdarrayType):
            found.append(ARRAY)
        elif isinstance(needed, ti.lang.matrix.MatrixType):
            found.append(MATRIX)
        elif id(needed) in reals:
            found.append(REAL)
        elif id(needed) in integers:
            found.append(WHOLE if ti.types.utils.is_signed(needed) else NATURAL)
        else:
            return None
    return tuple(found)


def _pack(kernel: Any, args: tuple, key: tuple) -> Packed:
    """What Taichi packs for a call that it has made already (`taichi.lang.kernel_impl.Kernel.launch_kernel`)."""
    from sim.device.compiler import ti

    program = ti.lang.impl.get_runtime().prog
    compiled = kernel.compiled_kernels[kernel.ensure_compiled(*args)]
    context = compiled.make_launch_context()
    numbers, arrays, alive, place = [], [], [], 0
    for position, (kind, arg) in enumerate(zip(_kinds(kernel) or (), args, strict=True)):
        if kind == TEMPLATE:
            continue
        index = (place,)
        place += 1
        if kind == ARRAY:
            _point(program, context, index, arg, kernel.arguments[position].annotation)
        elif kind == PACK:
            context.set_arg_argpack(index, arg._ArgPack__argpack)
            arrays += _members(arg)
        elif kind == MATRIX:
            needed = kernel.arguments[position].annotation
            needed.set_kernel_struct_args(needed(*arg.entries), context, index)
        else:
            numbers.append((position, _setter(context, kind, index)))
        if kind in (ARRAY, PACK):
            alive.append(weakref.ref(arg, lambda _: _packed.pop(key, None)))
    for offset, (array, needed) in enumerate(arrays):
        _point(program, context, (place + offset,), array, needed)
    data = program.compile_kernel(program.config(), program.get_device_caps(), compiled)
    return Packed(
        functools.partial(program.launch_kernel, data, context), tuple(numbers), _teller(kernel, context), tuple(alive)
    )


def _members(pack: Any) -> list[tuple[Any, Any]]:
    """All arrays of an argument pack and what is needed of them, in order."""
    members = zip(pack.items, pack._annotations, strict=True)
    return [(member, needed) for (_, member), needed in members if isinstance(member, _held())]


def _point(program: Any, context: Any, index: tuple[int, ...], array: Any, needed: Any) -> None:
    """Let an argument be where the array has its numbers."""
    if hasattr(array, "arr"):
        whole = array.arr
        start, size = program.get_ndarray_data_ptr_as_int(whole), whole.nelement() * whole.element_size()
        context.set_arg_external_array_with_shape(index, start, size, array.shape, 0)
    else:
        shape = array.shape[: array.ndim - getattr(needed.dtype, "ndim", 0)]
        context.set_arg_external_array_with_shape(index, int(array.ctypes.data), array.nbytes, shape, 0)


def _setter(context: Any, kind: int, index: tuple[int, ...]) -> Callable[[Any], None]:
    if kind == REAL:
        return lambda value: context.set_arg_float(index, float(value))
    change = context.set_arg_int if kind == WHOLE else context.set_arg_uint
    return lambda value: change(index, int(value))


def _teller(kernel: Any, context: Any) -> Callable[[], Any]:
    kinds = kernel.return_type
    if kinds is None:
        return lambda: None
    if len(kinds) == 1:
        return lambda: kernel.construct_kernel_ret(context, kinds[0], (0,))
    return lambda: [kernel.construct_kernel_ret(context, kind, (i,)) for i, kind in enumerate(kinds)]
