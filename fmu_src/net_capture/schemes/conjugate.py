"""The taut threads as one matrix, and its equations solved by conjugate gradients.

    (M + g D + g2 K) a = M b,   K = sum over threads of k n n' + T/r (1 - n n'),   D = sum of d n n'

K and D act on the difference of a thread's two ends, and their parts are positive or zero: so the matrix is symmetric
and positive definite, and no smaller than M. Only nodes at which one of its threads ends take part. They and these
threads are listed anew in every substep, and the vectors are as long as that list, in double precision.

The gradients are conjugate in the product by masses, (u, w) = sum m u.w, in which the eigenvalues lie between 1 and
1 + g c + g2 w (c and w as for the leapfrog's bound): half the root of the latter times ln(2/tolerance) iterations are
enough. As the matrix is no smaller than M, the error of `a` is no larger than the residual, both by mass.

A common motion is no thread's affair: the residual of all nodes together is taken out first, and none comes back. So
the momentum holds to rounding, wherever the iteration stops.

Source   Hestenes and Stiefel, J. Res. Natl. Bur. Stand. 49 (1952) 409
Checked  tests/net_capture/test_stiff.py
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fmu_src.net_capture.schemes.held import (
    ACROSS,
    ALONG,
    DASHPOT,
    DIRECTION,
    END_A,
    END_B,
    END_WORDS,
    IMAGE,
    INVERSE,
    NX,
    NY,
    NZ,
    RESIDUAL,
    SOLUTION,
    THREAD_NUMBERS,
    WEIGHT,
)
from orbital.kernel import kernel

TOLERANCE = 1e-6
"""Of the residual, over the right-hand side, both by mass. 1e-4 would save a third of the iterations, and spoil the
order at small steps."""
MOST_ITERATIONS = 2000
"""Of one solution."""


def make_solver(composition: Any, held: Any) -> tuple[Any, Any]:
    """Kernels `strain` and `solve` of the matrix of the threads in a list.

    strain(p, work, plane)   subtract g K w / m from the residual, w the velocities in these planes
    solve(p, work, g)        `a` into the solution for the `b` in the residual, beginning from what stands in the
                             solution; whether it has met the tolerance
    """
    node_plane, nodes, ends, numbers, vector = (
        composition.memory.node_plane,
        held.nodes,
        held.ends,
        held.numbers,
        held.vector,
    )
    from fmu_src.lanes import peek, poke

    @kernel
    def pull_ends(target, a, b, thread, j, along, across, wx, wy, wz):
        """Add a thread's part of the matrix times the difference w of its ends to both; returns its product with w.

        along, across    factors of the matrix along the thread and of all three directions

        Checked  tests/net_capture/test_stiff.py
        """
        nx, ny, nz = peek(thread, j + NX), peek(thread, j + NY), peek(thread, j + NZ)
        rate = along * (nx * wx + ny * wy + nz * wz)
        qx = rate * nx + across * wx
        qy = rate * ny + across * wy
        qz = rate * nz + across * wz
        poke(target, a, peek(target, a) - qx)
        poke(target, a + 1, peek(target, a + 1) - qy)
        poke(target, a + 2, peek(target, a + 2) - qz)
        poke(target, b, peek(target, b) + qx)
        poke(target, b + 1, peek(target, b + 1) + qy)
        poke(target, b + 2, peek(target, b + 2) + qz)
        return qx * wx + qy * wy + qz * wz

    @kernel
    def strain(p, work, plane):
        """Subtract g K w / m from the residual, w the velocities in these planes.

        Checked  tests/net_capture/test_stiff.py
        """
        slot, end, thread = nodes(p, work), ends(p, work), numbers(p, work)
        residual, inverse, image = vector(p, work, RESIDUAL), vector(p, work, INVERSE), vector(p, work, IMAGE)
        x, y, z = node_plane(p, work, plane), node_plane(p, work, plane + 1), node_plane(p, work, plane + 2)
        for i in range(3 * p.matrix_nodes):
            image[i] = 0.0
        for t in range(p.matrix_threads):
            a, b = peek(end, END_WORDS * t + END_A), peek(end, END_WORDS * t + END_B)
            i, k = slot[a], slot[b]
            j = THREAD_NUMBERS * t
            wx = np.float64(peek(x, k)) - np.float64(peek(x, i))
            wy = np.float64(peek(y, k)) - np.float64(peek(y, i))
            wz = np.float64(peek(z, k)) - np.float64(peek(z, i))
            along, across = peek(thread, j + ALONG), peek(thread, j + ACROSS)
            pull_ends(image, 3 * a, 3 * b, thread, j, along, across, wx, wy, wz)
        for i in range(3 * p.matrix_nodes):
            residual[i] -= inverse[i] * image[i]

    @kernel
    def apply(p, work, which, g):
        """The matrix without M times a vector, into the image [N]; returns the product of both [N m/s2].

        Checked  tests/net_capture/test_stiff.py
        """
        end, thread = ends(p, work), numbers(p, work)
        source, image = vector(p, work, which), vector(p, work, IMAGE)
        for i in range(3 * p.matrix_nodes):
            poke(image, i, 0.0)
        product = 0.0
        for t in range(p.matrix_threads):
            a, b = 3 * peek(end, END_WORDS * t + END_A), 3 * peek(end, END_WORDS * t + END_B)
            j = THREAD_NUMBERS * t
            wx = peek(source, b) - peek(source, a)
            wy = peek(source, b + 1) - peek(source, a + 1)
            wz = peek(source, b + 2) - peek(source, a + 2)
            along, across = g * (peek(thread, j + ALONG) + peek(thread, j + DASHPOT)), g * peek(thread, j + ACROSS)
            product += pull_ends(image, a, b, thread, j, along, across, wx, wy, wz)
        return product

    @kernel
    def square_of(p, work, which):
        """(u, u) of a vector, by mass.

        Checked  tests/net_capture/test_stiff.py
        """
        weight, u = vector(p, work, WEIGHT), vector(p, work, which)
        found = 0.0
        for i in range(3 * p.matrix_nodes):
            found += peek(weight, i) * peek(u, i) * peek(u, i)
        return found

    @kernel
    def take_out_common(p, work):
        """Give all listed nodes the mean of their residuals, in which no thread has a part.

        Checked  tests/net_capture/test_stiff.py
        """
        weight, residual, solution = vector(p, work, WEIGHT), vector(p, work, RESIDUAL), vector(p, work, SOLUTION)
        for axis in range(3):
            total = 0.0
            moment = 0.0
            for i in range(axis, 3 * p.matrix_nodes, 3):
                total += weight[i]
                moment += weight[i] * residual[i]
            for i in range(axis, 3 * p.matrix_nodes, 3):
                residual[i] -= moment / total
                solution[i] += moment / total

    @kernel
    def solve(p, work, g):
        """Whether the residual has come down to the tolerance.

        Checked  tests/net_capture/test_stiff.py
        """
        if p.matrix_threads == 0:
            return True
        solution, residual = vector(p, work, SOLUTION), vector(p, work, RESIDUAL)
        direction, image, inverse = vector(p, work, DIRECTION), vector(p, work, IMAGE), vector(p, work, INVERSE)
        size = 3 * p.matrix_nodes
        enough = TOLERANCE * TOLERANCE * square_of(p, work, RESIDUAL)
        apply(p, work, SOLUTION, g)
        for i in range(size):
            residual[i] -= solution[i] + inverse[i] * image[i]
        take_out_common(p, work)
        square = square_of(p, work, RESIDUAL)
        for i in range(size):
            direction[i] = residual[i]
        for _ in range(MOST_ITERATIONS):
            if not square > enough:
                return True
            p.solver_iterations += 1
            onward = square / (apply(p, work, DIRECTION, g) + square_of(p, work, DIRECTION))
            for i in range(size):
                along = peek(direction, i)
                poke(solution, i, peek(solution, i) + onward * along)
                poke(residual, i, peek(residual, i) - onward * (along + peek(inverse, i) * peek(image, i)))
            before = square
            square = square_of(p, work, RESIDUAL)
            for i in range(size):
                poke(direction, i, peek(residual, i) + square / before * peek(direction, i))
        return False

    return strain, solve
