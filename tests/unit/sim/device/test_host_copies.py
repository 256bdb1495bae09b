"""Arrays of Taichi copied without kernels hold what kernels see."""

from __future__ import annotations

import numpy as np
import pytest

from sim.device.compiler_choice import chosen

pytestmark = pytest.mark.skipif(not chosen().relaunch, reason="not with this compiler")
COUNT = 7


def arrays(taichi):
    """Of numbers, vectors and matrices, and the shape that NumPy has of each."""
    return [
        (taichi.ndarray(taichi.f32, COUNT), (COUNT,), np.float32),
        (taichi.ndarray(taichi.i32, (COUNT, 3)), (COUNT, 3), np.int32),
        (taichi.Vector.ndarray(3, taichi.f64, COUNT), (COUNT, 3), np.float64),
        (taichi.Vector.ndarray(2, taichi.i32, COUNT), (COUNT, 2), np.int32),
        (taichi.Matrix.ndarray(3, 3, taichi.f64, COUNT), (COUNT, 3, 3), np.float64),
    ]


def test_what_is_written_is_read_back_as_by_kernels(taichi):
    kernels = taichi._kernels
    for array, shape, kind in arrays(taichi):
        values = np.arange(np.prod(shape)).reshape(shape).astype(kind)
        array.from_numpy(values)
        copy = array.to_numpy()
        assert copy.dtype == kind and copy.tolist() == values.tolist()
        by_kernel = np.zeros(shape, kind)
        if len(array.element_shape):
            kernels.ndarray_matrix_to_ext_arr(array, by_kernel, 1, int(len(array.element_shape) == 1))
        else:
            kernels.ndarray_to_ext_arr(array, by_kernel)
        assert by_kernel.tolist() == values.tolist()


def test_copies_stay_as_they_are_when_arrays_change(taichi):
    for array, shape, kind in arrays(taichi):
        array.fill(2)
        copy = array.to_numpy()
        array.fill(3)
        assert (copy == 2).all() and (array.to_numpy() == 3).all() and copy.shape == shape
        values = np.full(shape, 5, kind)
        array.from_numpy(values)
        values[:] = 7
        assert (array.to_numpy() == 5).all()


def test_arrays_take_over_others(taichi):
    for (array, shape, kind), (other, *_) in zip(arrays(taichi), arrays(taichi), strict=True):
        other.from_numpy(np.arange(np.prod(shape)).reshape(shape).astype(kind))
        array.copy_from(other)
        assert array.to_numpy().tolist() == other.to_numpy().tolist()


def test_numbers_of_another_kind_are_converted(taichi):
    array = taichi.ndarray(taichi.f32, COUNT)
    array.from_numpy(np.linspace(0, 1, COUNT))
    assert array.to_numpy() == pytest.approx(np.linspace(0, 1, COUNT), abs=1e-7)


@pytest.mark.parametrize(("values", "error"), [([1.0] * COUNT, TypeError), (np.zeros(COUNT + 1), ValueError)])
def test_what_does_not_fit_is_refused(taichi, values, error):
    with pytest.raises(error):
        taichi.ndarray(taichi.f64, COUNT).from_numpy(values)
