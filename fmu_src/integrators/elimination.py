"""Small systems of linear equations, real and complex, in the caller's memory."""

from __future__ import annotations

from orbital.kernel import kernel
from orbital.vectors import Array


@kernel
def factor(matrix: Array, pivots: Array, size: int) -> None:
    """Triangular factors of a matrix, in its place, with partial pivoting.

    matrix        in C order, overwritten                        (size * size,)
    pivots        out    which row stood in for each             (size,)

    A matrix without an inverse gives infinities, and no more is asked of it.

    Source   Golub and Van Loan, Matrix computations (2013), algorithm 3.4.1
    Checked  tests/tethered_deorbit/test_integrator.py: against numpy's
    """
    for k in range(size):
        best = k
        for i in range(k + 1, size):
            if abs(matrix[i * size + k]) > abs(matrix[best * size + k]):
                best = i
        pivots[k] = best
        if best != k:
            for j in range(size):
                kept = matrix[k * size + j]
                matrix[k * size + j] = matrix[best * size + j]
                matrix[best * size + j] = kept
        scale = 1.0 / matrix[k * size + k]
        for i in range(k + 1, size):
            share = matrix[i * size + k] * scale
            matrix[i * size + k] = share
            if share != 0.0:
                for j in range(k + 1, size):
                    matrix[i * size + j] -= share * matrix[k * size + j]


@kernel
def solve(matrix: Array, pivots: Array, size: int, right: Array) -> None:
    """right <- solution of the factored equations.

    right         right-hand side on entry                       (size,)

    Source   as `factor`
    Checked  tests/tethered_deorbit/test_integrator.py: against numpy's
    """
    for k in range(size):
        best = int(pivots[k])
        kept = right[k]
        right[k] = right[best]
        right[best] = kept
    for i in range(size):
        for j in range(i):
            right[i] -= matrix[i * size + j] * right[j]
    for back in range(size):
        i = size - 1 - back
        for j in range(i + 1, size):
            right[i] -= matrix[i * size + j] * right[j]
        right[i] /= matrix[i * size + i]


@kernel
def factor_complex(real: Array, imaginary: Array, pivots: Array, size: int) -> None:
    """As `factor`, of a complex matrix whose parts lie apart.

    real, imaginary      overwritten                             (size * size,)

    Source   as `factor`
    Checked  tests/tethered_deorbit/test_integrator.py: against numpy's
    """
    for k in range(size):
        best, largest = k, -1.0
        for i in range(k, size):
            a, b = real[i * size + k], imaginary[i * size + k]
            if a * a + b * b > largest:
                best, largest = i, a * a + b * b
        pivots[k] = best
        if best != k:
            for j in range(size):
                kept = real[k * size + j]
                real[k * size + j] = real[best * size + j]
                real[best * size + j] = kept
                kept = imaginary[k * size + j]
                imaginary[k * size + j] = imaginary[best * size + j]
                imaginary[best * size + j] = kept
        u, v = real[k * size + k] / largest, -imaginary[k * size + k] / largest
        for i in range(k + 1, size):
            a, b = real[i * size + k], imaginary[i * size + k]
            x, y = a * u - b * v, a * v + b * u
            real[i * size + k] = x
            imaginary[i * size + k] = y
            if x != 0.0 or y != 0.0:
                for j in range(k + 1, size):
                    a, b = real[k * size + j], imaginary[k * size + j]
                    real[i * size + j] -= x * a - y * b
                    imaginary[i * size + j] -= x * b + y * a


@kernel
def solve_complex(real: Array, imaginary: Array, pivots: Array, size: int, right: Array, beside: Array) -> None:
    """As `solve`: real and imaginary part of the right-hand side become those of the solution.

    right, beside        real and imaginary part                 (size,)

    Source   as `factor`
    Checked  tests/tethered_deorbit/test_integrator.py: against numpy's
    """
    for k in range(size):
        best = int(pivots[k])
        kept = right[k]
        right[k] = right[best]
        right[best] = kept
        kept = beside[k]
        beside[k] = beside[best]
        beside[best] = kept
    for i in range(size):
        for j in range(i):
            a, b = real[i * size + j], imaginary[i * size + j]
            x, y = right[j], beside[j]
            right[i] -= a * x - b * y
            beside[i] -= a * y + b * x
    for back in range(size):
        i = size - 1 - back
        for j in range(i + 1, size):
            a, b = real[i * size + j], imaginary[i * size + j]
            x, y = right[j], beside[j]
            right[i] -= a * x - b * y
            beside[i] -= a * y + b * x
        a, b = real[i * size + i], imaginary[i * size + i]
        square = a * a + b * b
        x, y = right[i], beside[i]
        right[i] = (x * a + y * b) / square
        beside[i] = (y * a - x * b) / square
