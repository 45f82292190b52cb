"""Vectors of three numbers inside kernels: the result goes into `out`, which comes first.

Kernels may not allocate, so every operation writes into memory the caller owns. `out` may be one of the operands.
Scalars are returned. Matrices are (3, 3), row first. Plain sums are kept on purpose: numpy's own dot product would
reach for a BLAS library, which a model's binary cannot carry.
"""

import math

import numpy as np
from numpy.typing import NDArray

from orbital.kernel import kernel

Array = NDArray[np.float64]


@kernel
def dot(a: Array, b: Array) -> float:
    """Inner product of two vectors [unit of a times unit of b].

        a . b = a1 b1 + a2 b2 + a3 b3

    Valid    any finite values whose products stay below 1.8e308
    Checked  tests/orbital/test_vectors.py
    """
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@kernel
def norm(a: Array) -> float:
    """Length of a vector [unit of a].

        |a| = sqrt(a . a)

    Valid    lengths between 1e-150 and 1e150: the square is formed unscaled, and a shorter vector counts as zero
    Checked  tests/orbital/test_vectors.py
    """
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@kernel
def distance(a: Array, b: Array) -> float:
    """Distance between two points [unit of a].

        |a - b|

    Valid    as `norm`; the difference is exact to rounding of a and b themselves
    Checked  tests/orbital/test_vectors.py
    """
    x = a[0] - b[0]
    y = a[1] - b[1]
    z = a[2] - b[2]
    return math.sqrt(x * x + y * y + z * z)


@kernel
def is_finite(a: Array) -> bool:
    """True if none of the three components is infinite or not a number.

    Checked  tests/orbital/test_vectors.py
    """
    return math.isfinite(a[0]) and math.isfinite(a[1]) and math.isfinite(a[2])


@kernel
def fill(out: Array, value: float) -> None:
    """Give all three components one value.

    Checked  tests/orbital/test_vectors.py
    """
    out[0] = value
    out[1] = value
    out[2] = value


@kernel
def copy(out: Array, a: Array) -> None:
    """out = a.

    Checked  tests/orbital/test_vectors.py
    """
    out[0] = a[0]
    out[1] = a[1]
    out[2] = a[2]


@kernel
def add(out: Array, a: Array, b: Array) -> None:
    """out = a + b.

    Checked  tests/orbital/test_vectors.py
    """
    out[0] = a[0] + b[0]
    out[1] = a[1] + b[1]
    out[2] = a[2] + b[2]


@kernel
def subtract(out: Array, a: Array, b: Array) -> None:
    """out = a - b.

    Checked  tests/orbital/test_vectors.py
    """
    out[0] = a[0] - b[0]
    out[1] = a[1] - b[1]
    out[2] = a[2] - b[2]


@kernel
def scale(out: Array, factor: float, a: Array) -> None:
    """out = factor a.

    Checked  tests/orbital/test_vectors.py
    """
    out[0] = factor * a[0]
    out[1] = factor * a[1]
    out[2] = factor * a[2]


@kernel
def add_scaled(out: Array, a: Array, factor: float, b: Array) -> None:
    """out = a + factor b; with out = a it accumulates.

    Checked  tests/orbital/test_vectors.py
    """
    out[0] = a[0] + factor * b[0]
    out[1] = a[1] + factor * b[1]
    out[2] = a[2] + factor * b[2]


@kernel
def cross(out: Array, a: Array, b: Array) -> None:
    """out = a x b, right-handed [unit of a times unit of b].

    Valid    out may be a or b
    Checked  tests/orbital/test_vectors.py
    """
    x = a[1] * b[2] - a[2] * b[1]
    y = a[2] * b[0] - a[0] * b[2]
    z = a[0] * b[1] - a[1] * b[0]
    out[0] = x
    out[1] = y
    out[2] = z


@kernel
def unit(out: Array, a: Array) -> float:
    """Length of `a` [unit of a]; out becomes the direction of `a` [-].

        out = a / |a|

    A vector without length has no direction: out is then zero and so is the value returned, never a NaN.

    Valid    as `norm`; a NaN in `a` stays one
    Checked  tests/orbital/test_vectors.py
    """
    length = norm(a)
    if length == 0.0:
        fill(out, 0.0)
    else:
        out[0] = a[0] / length
        out[1] = a[1] / length
        out[2] = a[2] / length
    return length


@kernel
def matrix_vector(out: Array, matrix: Array, a: Array) -> None:
    """out = M a.

    Valid    out may be a
    Checked  tests/orbital/test_vectors.py
    """
    x = matrix[0, 0] * a[0] + matrix[0, 1] * a[1] + matrix[0, 2] * a[2]
    y = matrix[1, 0] * a[0] + matrix[1, 1] * a[1] + matrix[1, 2] * a[2]
    z = matrix[2, 0] * a[0] + matrix[2, 1] * a[1] + matrix[2, 2] * a[2]
    out[0] = x
    out[1] = y
    out[2] = z


@kernel
def transposed_matrix_vector(out: Array, matrix: Array, a: Array) -> None:
    """out = M^T a, the inverse of `matrix_vector` when M is a rotation.

    Valid    out may be a
    Checked  tests/orbital/test_vectors.py
    """
    x = matrix[0, 0] * a[0] + matrix[1, 0] * a[1] + matrix[2, 0] * a[2]
    y = matrix[0, 1] * a[0] + matrix[1, 1] * a[1] + matrix[2, 1] * a[2]
    z = matrix[0, 2] * a[0] + matrix[1, 2] * a[1] + matrix[2, 2] * a[2]
    out[0] = x
    out[1] = y
    out[2] = z
