"""Arrays of particles, driven by one declaration: allocation, sorting, saving and the memory report."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import taichi as ti

vec2i = ti.types.vector(2, ti.i32)
vec3 = ti.types.vector(3, ti.f32)
vec4 = ti.types.vector(4, ti.f32)

Vec4Array = ti.types.ndarray(dtype=vec4, ndim=1)
Vec2iArray = ti.types.ndarray(dtype=vec2i, ndim=1)
IntArray = ti.types.ndarray(dtype=ti.i32, ndim=1)
IntTable = ti.types.ndarray(dtype=ti.i32, ndim=2)
DoubleTable = ti.types.ndarray(dtype=ti.f64, ndim=2)


@dataclass(frozen=True)
class Declared:
    """One array of a material: an element per particle.

    `sorted`: carried along when particles are reordered. `saved`: part of a checkpoint.
    """

    name: str
    element: Literal["vec4", "vec2i"]
    unit: str
    sorted: bool = True
    saved: bool = True


_ELEMENTS = {"vec4": (vec4, np.float32, 4), "vec2i": (vec2i, np.int32, 2)}


class Particles:
    """The declared arrays for `count` particles; an attribute for each, named as declared."""

    def __init__(self, declared: Sequence[Declared], count: int):
        self.declared = tuple(declared)
        self.count = count
        self._spare: dict[str, ti.Ndarray] = {}
        for field in self.declared:
            setattr(self, field.name, self._allocate(field))
            if field.sorted:
                self._spare[field.name] = self._allocate(field)

    def _allocate(self, field: Declared) -> ti.Ndarray:
        array = ti.ndarray(_ELEMENTS[field.element][0], max(self.count, 1))
        array.fill(0)
        return array

    def reorder(self, order: ti.Ndarray) -> None:
        """Bring the sorted arrays into `order`: element i comes from order[i]."""
        for field in self.declared:
            if field.sorted:
                source, target = getattr(self, field.name), self._spare[field.name]
                (_gather_vec4 if field.element == "vec4" else _gather_vec2i)(self.count, order, source, target)
                setattr(self, field.name, target)
                self._spare[field.name] = source

    def state(self) -> dict[str, np.ndarray]:
        """Copies of the saved arrays by name."""
        return {field.name: self.numpy(field.name) for field in self.declared if field.saved}

    def load(self, state: dict[str, np.ndarray]) -> None:
        """Fill arrays from copies that `state` made."""
        for name, values in state.items():
            if self.count:
                getattr(self, name).from_numpy(np.ascontiguousarray(values))

    def numpy(self, name: str) -> np.ndarray:
        """A copy of one array, shape [count, components]."""
        return getattr(self, name).to_numpy()[: self.count]

    @property
    def bytes(self) -> int:
        per_particle = sum(
            np.dtype(_ELEMENTS[field.element][1]).itemsize * _ELEMENTS[field.element][2] * (2 if field.sorted else 1)
            for field in self.declared
        )
        return per_particle * self.count


@ti.kernel
def _gather_vec4(count: ti.i32, order: IntArray, source: Vec4Array, target: Vec4Array):
    for i in range(count):
        target[i] = source[order[i]]


@ti.kernel
def _gather_vec2i(count: ti.i32, order: IntArray, source: Vec2iArray, target: Vec2iArray):
    for i in range(count):
        target[i] = source[order[i]]
