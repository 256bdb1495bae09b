"""Arrays of particles, driven by one declaration: allocation, sorting, saving and the memory report."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from sim.device import precision
from sim.device.compiler import ti

real = ti.f64 if precision.chosen == "double" else ti.f32
"""The type of positions, velocities and all that follows from them."""
numpy_real = np.float64 if precision.chosen == "double" else np.float32

vec2i = ti.types.vector(2, ti.i32)
vec2 = ti.types.vector(2, real)
vec3: Any = ti.types.vector(3, real)
vec4 = ti.types.vector(4, real)
mat3 = ti.types.matrix(3, 3, real)

Vec4Array: Any = ti.types.ndarray(dtype=vec4, ndim=1)
Vec2iArray: Any = ti.types.ndarray(dtype=vec2i, ndim=1)
RealArray: Any = ti.types.ndarray(dtype=real, ndim=1)
IntArray: Any = ti.types.ndarray(dtype=ti.i32, ndim=1)
IntTable = ti.types.ndarray(dtype=ti.i32, ndim=2)
DoubleTable: Any = ti.types.ndarray(dtype=ti.f64, ndim=2)

GROWTH = 1.25
"""Arrays that are too short are made this much longer than needed."""


@dataclass(frozen=True)
class Declared:
    """One array of a material: an element per particle.

    `sorted`: carried along when particles are reordered. `saved`: part of a checkpoint.
    """

    name: str
    element: Literal["vec4", "vec2i", "real"]
    unit: str
    sorted: bool = True
    saved: bool = True


_ELEMENTS = {"vec4": (vec4, numpy_real, 4), "vec2i": (vec2i, np.int32, 2), "real": (real, numpy_real, 1)}


def integer_array(values: np.ndarray) -> ti.Ndarray:
    """The same integers on the device."""
    array = ti.ndarray(ti.i32, values.shape)
    array.from_numpy(np.ascontiguousarray(values, dtype=np.int32))
    return array


class Particles:
    """The declared arrays for `count` particles, with room for `capacity`; an attribute for each, named as declared.

    Raises ValueError where two declare the same name: each would write into what the other keeps.
    """

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...

    def __init__(self, declared: Sequence[Declared], count: int):
        self.declared = tuple(declared)
        names = [field.name for field in self.declared]
        if len(set(names)) < len(names):
            raise ValueError(f"declared twice: {', '.join(sorted({name for name in names if names.count(name) > 1}))}")
        self.count = count
        self.capacity = max(count, 1)
        self._allocate()

    def _allocate(self) -> None:
        self._bundles: dict[tuple[int, ...], Any] = {}
        self._spare: dict[str, ti.Ndarray] = {}
        """One array of each element beside those declared, to sort into: what is sorted from is the next."""
        for field in self.declared:
            setattr(self, field.name, self._array(field))
            if field.sorted and field.element not in self._spare:
                self._spare[field.element] = self._array(field)

    def _array(self, field: Declared) -> ti.Ndarray:
        array = ti.ndarray(_ELEMENTS[field.element][0], self.capacity)
        array.fill(0)
        return array

    def bundle(self, kind: Any, **elsewhere: str) -> Any:
        """The arrays that an argument pack of this `kind` (`argpack`) has as members: of the same names, or of
        those that are given for them `elsewhere`.

        Taichi takes a third of a millisecond to make one, and sorting swaps arrays in turn, so each is kept.
        """
        arrays = [getattr(self, elsewhere.get(name, name)) for name in kind.members]
        key = (id(kind), *map(id, arrays))
        if key not in self._bundles:
            self._bundles[key] = kind(*arrays)
        return self._bundles[key]

    def reorder(self, order: ti.Ndarray | np.ndarray, count: int | None = None) -> None:
        """Bring the sorted arrays into `order`: element i comes from order[i]; `count` keeps the first of them only."""
        self.count = self.count if count is None else count
        for field in self.declared:
            if field.sorted:
                source, target = getattr(self, field.name), self._spare[field.element]
                _GATHER[field.element](self.count, order, source, target)
                setattr(self, field.name, target)
                self._spare[field.element] = source

    def leave_out(self, gone: np.ndarray) -> int:
        """Hold all but those that are `gone`, shape [count], in their order; how many those were."""
        number = int(gone.sum())
        if number:
            self.reorder(np.argsort(gone, kind="stable").astype(np.int32), self.count - number)
        return number

    def state(self) -> dict[str, np.ndarray]:
        """Copies of the saved arrays by name."""
        return {field.name: self.numpy(field.name) for field in self.declared if field.saved}

    def load(self, state: dict[str, np.ndarray]) -> None:
        """Hold what `state` made, with room to grow where that is more than there was."""
        self.count = len(next(iter(state.values()), ()))
        if self.count > self.capacity:
            self.capacity = int(GROWTH * self.count)
            self._allocate()
        for field in self.declared:
            if (field.saved or field.name in state) and self.count:
                kind, width = _ELEMENTS[field.element][1:]
                whole = np.zeros((self.capacity, width), kind)
                whole[: self.count] = state[field.name].reshape(self.count, width)
                getattr(self, field.name).from_numpy(whole[:, 0] if width == 1 else whole)

    def extend(self, fresh: dict[str, np.ndarray]) -> None:
        """Hold more after those there are: the values of the saved arrays by name, shape [n, components]. What else is
        carried along is zero for them."""
        first, number = self.count, len(next(iter(fresh.values())))
        for field in self.declared:
            if field.sorted and not field.saved:
                _, kind, width = _ELEMENTS[field.element]
                fresh = fresh | {field.name: np.zeros((number, width) if width > 1 else number, kind)}
        if first + number > self.capacity:
            self.load({name: np.concatenate((self.numpy(name), values)) for name, values in fresh.items()})
            return
        self.count += number
        for field in self.declared:
            if field.name in fresh:
                _PUT[field.element](first, number, fresh[field.name], getattr(self, field.name))

    def forget(self) -> None:
        """Set to zero what is carried along and not saved, so that a run that goes on from a checkpoint does the
        same."""
        for field in self.declared:
            if field.sorted and not field.saved:
                getattr(self, field.name).fill(0)

    def numpy(self, name: str) -> np.ndarray:
        """A copy of one array, shape [count, components], or [count] of numbers."""
        return getattr(self, name).to_numpy()[: self.count]

    @property
    def bytes(self) -> int:
        """Memory of all arrays, with room for `capacity` particles [bytes]."""
        elements = [field.element for field in self.declared] + list(self._spare)
        kinds = [_ELEMENTS[element][1:] for element in elements]
        return sum(np.dtype(kind).itemsize * width for kind, width in kinds) * self.capacity


@ti.kernel
def _gather_vec4(count: ti.i32, order: IntArray, source: Vec4Array, target: Vec4Array):
    for i in range(count):
        target[i] = source[order[i]]


@ti.kernel
def _gather_vec2i(count: ti.i32, order: IntArray, source: Vec2iArray, target: Vec2iArray):
    for i in range(count):
        target[i] = source[order[i]]


@ti.kernel
def _gather_real(count: ti.i32, order: IntArray, source: RealArray, target: RealArray):
    for i in range(count):
        target[i] = source[order[i]]


@ti.kernel
def _put_vec4(first: ti.i32, number: ti.i32, source: Vec4Array, target: Vec4Array):
    for i in range(number):
        target[first + i] = source[i]


@ti.kernel
def _put_vec2i(first: ti.i32, number: ti.i32, source: Vec2iArray, target: Vec2iArray):
    for i in range(number):
        target[first + i] = source[i]


@ti.kernel
def _put_real(first: ti.i32, number: ti.i32, source: RealArray, target: RealArray):
    for i in range(number):
        target[first + i] = source[i]


_PUT = {"vec4": _put_vec4, "vec2i": _put_vec2i, "real": _put_real}
_GATHER = {"vec4": _gather_vec4, "vec2i": _gather_vec2i, "real": _gather_real}


@ti.func
def vector(table: DoubleTable, row: ti.i32, first: ti.template()) -> vec3:
    """Three numbers of a row as a vector."""
    return vec3([ti.cast(table[row, first + axis], real) for axis in ti.static(range(3))])
