"""Arrays of Taichi copied to and from NumPy's, on a CPU, where both lie in the same memory.

Taichi launches a kernel for every copy and every fill, which takes 0.1 to 0.7 ms, however small the array is, and has
to be compiled or loaded for each kind of array.
"""

from __future__ import annotations

import ctypes
import functools
import math
from typing import Any

import numpy as np


@functools.cache
def install() -> None:
    """Copy without kernels, from now on, wherever Taichi runs on a CPU."""
    from sim.device.compiler import ti

    Ndarray = ti.lang._ndarray.Ndarray
    for name, here in (
        ("_ndarray_to_numpy", _to_numpy),
        ("_ndarray_matrix_to_numpy", _to_numpy),
        ("_ndarray_from_numpy", _from_numpy),
        ("_ndarray_matrix_from_numpy", _from_numpy),
        ("fill", _fill),
        ("copy_from", _copy_from),
    ):
        setattr(Ndarray, name, _on_cpu(here, getattr(Ndarray, name)))


def _on_cpu(here: Any, elsewhere: Any) -> Any:
    from sim.device.compiler import ti

    @functools.wraps(elsewhere)
    def chosen(array: Any, *args: Any, **options: Any) -> Any:
        if ti.lang.impl.current_cfg().arch == ti.cpu:
            return here(array, *args, **options)
        return elsewhere(array, *args, **options)

    return chosen


def view(array: Any) -> np.ndarray:
    """What NumPy sees of an array's memory, as long as it lives: elements of vectors and matrices come last."""
    from sim.device.compiler import ti

    whole = array.arr
    shape = tuple(whole.total_shape())
    kind = np.dtype(ti.lang.util.to_numpy_type(array.dtype))
    start = ti.lang.impl.get_runtime().prog.get_ndarray_data_ptr_as_int(whole)
    memory = (ctypes.c_char * (kind.itemsize * math.prod(shape))).from_address(start)
    return np.frombuffer(memory, kind).reshape(shape)


def _to_numpy(array: Any, as_vector: int = 0) -> np.ndarray:
    return view(array).copy()


def _from_numpy(array: Any, values: Any, as_vector: int = 0) -> None:
    """Raises TypeError for what is no array of NumPy, and ValueError for one of another shape."""
    if not isinstance(values, np.ndarray):
        raise TypeError(f"an array of NumPy is needed, not {type(values)}")
    here = view(array)
    if here.shape != values.shape:
        raise ValueError(f"shape {here.shape} is needed, not {values.shape}")
    np.copyto(here, values, casting="unsafe")


def _fill(array: Any, value: Any) -> None:
    view(array)[...] = value


def _copy_from(array: Any, other: Any) -> None:
    np.copyto(view(array), view(other), casting="unsafe")
