"""Kernels launched again with the same arrays, on a CPU.

Taichi looks at every argument of every call and packs it anew, which takes some ten microseconds an array: for a scene
of a few bodies or a small cloth longer than the work itself. What a call packs is kept here, and a later one with the
same arrays only says what has changed: the numbers.
"""

from __future__ import annotations

import functools
import operator
import weakref
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

TEMPLATE, REAL, WHOLE, NATURAL, ARRAY, PACK, MATRIX = range(7)
"""Kinds of arguments."""
MOST = 4096
"""Calls that are kept, and as many that were made once; beyond it all are forgotten."""


@dataclass(frozen=True)
class Packed:
    """A call as Taichi launches it; numbers: where each is among the arguments, and what sets it."""

    launch: Callable[[], None]
    numbers: tuple[tuple[int, Callable[[Any], None]], ...]
    told: Callable[[], Any]
    alive: tuple[weakref.ref, ...]


@dataclass(frozen=True)
class Signature:
    """Kinds of a kernel's arguments, and which have to be the same for a call to be launched again: its arrays and
    packs, taken from all of them by `held`; and where values and matrices are that have to be equal."""

    kinds: tuple[int, ...]
    held: Callable[[tuple], tuple]
    equal: tuple[int, ...]
    matrices: tuple[int, ...]


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
    def launched(kernel: Any, *args: Any, **options: object) -> object:
        signature = None if options else _signature(kernel)
        key = _key(kernel, signature, args) if signature else None
        if signature is None or key is None:
            return call(kernel, *args, **options)
        packed = _packed.get(key)
        if packed is not None:
            for place, change in packed.numbers:
                change(args[place])
            packed.launch()
            return packed.told()
        found = call(kernel, *args)
        if key not in _seen:
            if len(_seen) >= MOST:
                _seen.clear()
            _seen.add(key)
        elif _stays(signature, args):
            _keep(key, _pack(kernel, signature, args, key))
        return found

    Kernel.__call__ = launched


def _keep(key: tuple, packed: Packed) -> None:
    _seen.discard(key)
    if len(_packed) >= MOST:
        forget()
    _packed[key] = packed


def _key(kernel: Any, signature: Signature, args: tuple) -> tuple | None:
    """What has to be the same for a call to be launched again; None where that cannot be told."""
    if len(args) != len(signature.kinds):
        return None
    same = id(kernel), *map(id, signature.held(args))
    if not signature.equal and not signature.matrices:
        return same
    equal = [args[place] for place in signature.equal]
    if not all(isinstance(value, bool | int) for value in equal):
        return None
    return *same, *equal, *(tuple(getattr(args[place], "entries", ())) for place in signature.matrices)


def _stays(signature: Signature, args: tuple) -> bool:
    """Whether what Taichi packs of a call serves another one with the same key."""
    for kind, arg in zip(signature.kinds, args, strict=True):
        if kind in (ARRAY, PACK):
            if not isinstance(arg, _held()) or not _lies_whole(arg):
                return False
        elif kind == MATRIX:
            if not hasattr(arg, "entries"):
                return False
        elif kind != TEMPLATE and not isinstance(arg, _numbers()):
            return False
    return True


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
def _signature(kernel: Any) -> Signature | None:
    """Of a kernel; None where one of its arguments is of another kind, or a pack in which there is a pack."""
    kinds: list[int] = []
    for argument in kernel.arguments:
        kind = _kind(argument.annotation)
        if kind is None:
            return None
        kinds.append(kind)
    held, equal, matrices = (
        tuple(place for place, kind in enumerate(kinds) if kind in wanted)
        for wanted in ((ARRAY, PACK), (TEMPLATE,), (MATRIX,))
    )
    return Signature(tuple(kinds), _picker(held), equal, matrices)


def _picker(places: tuple[int, ...]) -> Callable[[tuple], tuple]:
    """What takes those of a tuple that are in these places."""
    if len(places) > 1:
        return operator.itemgetter(*places)
    return lambda args: tuple(args[place] for place in places)


def _kind(needed: Any) -> int | None:
    """Of an argument that is declared like this."""
    from sim.device.compiler import ti

    ArgPackType = ti.lang.argpack.ArgPackType
    if isinstance(needed, ti.template) or needed is ti.template:
        return TEMPLATE
    if isinstance(needed, ArgPackType):
        return None if any(isinstance(member, ArgPackType) for member in needed.members.values()) else PACK
    if isinstance(needed, ti.types.ndarray_type.NdarrayType):
        return ARRAY
    if isinstance(needed, ti.lang.matrix.MatrixType):
        return MATRIX
    if id(needed) in ti.types.primitive_types.real_type_ids:
        return REAL
    if id(needed) in ti.types.primitive_types.integer_type_ids:
        return WHOLE if ti.types.utils.is_signed(needed) else NATURAL
    return None


def _pack(kernel: Any, signature: Signature, args: tuple, key: tuple) -> Packed:
    """What Taichi packs for a call that it has made already (`taichi.lang.kernel_impl.Kernel.launch_kernel`)."""
    from sim.device.compiler import ti

    program = ti.lang.impl.get_runtime().prog
    compiled = kernel.compiled_kernels[kernel.ensure_compiled(*args)]
    context = compiled.make_launch_context()
    numbers, arrays, alive, place = [], [], [], 0
    for position, (kind, arg) in enumerate(zip(signature.kinds, args, strict=True)):
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
        return functools.partial(context.set_arg_float, index)
    return functools.partial(context.set_arg_int if kind == WHOLE else context.set_arg_uint, index)


def _teller(kernel: Any, context: Any) -> Callable[[], Any]:
    """What tells a kernel's return value."""
    kinds = kernel.return_type
    if kinds is None:
        return _nothing
    tell = [_member(kernel, context, kind, (place,)) for place, kind in enumerate(kinds)]
    return tell[0] if len(tell) == 1 else lambda: [one() for one in tell]


def _member(kernel: Any, context: Any, kind: Any, place: tuple[int]) -> Callable[[], Any]:
    """What tells one of a kernel's return values: of vectors a list, since Taichi takes 30 us to make one."""
    from sim.device.compiler import ti

    if kind in (ti.f32, ti.f64):
        return functools.partial(context.get_struct_ret_float, place)
    if kind == ti.i32:
        return functools.partial(context.get_struct_ret_int, place)
    if isinstance(kind, ti.lang.matrix.VectorType) and kind.dtype in (ti.f32, ti.f64):
        places, read = [(*place, k) for k in range(kind.n)], context.get_struct_ret_float
        return lambda: list(map(read, places))
    return functools.partial(kernel.construct_kernel_ret, context, kind, place)


def _nothing() -> None:
    """Of a kernel that returns nothing."""
