"""Types of arrays that are always of double precision: of rigid bodies and of cloth, whose contacts need it.

Constants in kernels have to be exact in single precision, and sums have to begin as one of these types: Taichi takes
`0.0` for a number of single precision.
"""

from typing import Any

from sim.device.compiler import ti

vec2 = ti.types.vector(2, ti.f64)
vec3: Any = ti.types.vector(3, ti.f64)
vec4 = ti.types.vector(4, ti.f64)
vec5 = ti.types.vector(5, ti.f64)
mat3: Any = ti.types.matrix(3, 3, ti.f64)

Numbers = ti.types.ndarray(dtype=ti.f64, ndim=1)
Integers = ti.types.ndarray(dtype=ti.i32, ndim=1)
Vectors = ti.types.ndarray(dtype=vec3, ndim=1)
Quaternions = ti.types.ndarray(dtype=vec4, ndim=1)
Matrices = ti.types.ndarray(dtype=mat3, ndim=1)
Singles = ti.types.ndarray(dtype=ti.f32, ndim=1)


@ti.func
def cross_matrix(arm: vec3) -> mat3:
    """The matrix of the cross product with a vector."""
    return mat3([[0.0, -arm[2], arm[1]], [arm[2], 0.0, -arm[0]], [-arm[1], arm[0], 0.0]])
