"""Coefficients of collocation: integrals and differences of the polynomials through given nodes.

They are formed in forty decimal digits and then rounded once, so that they are the same on every platform.
"""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Context, Decimal, localcontext
from functools import wraps
from typing import Any

import numpy as np
import numpy.typing as npt

DIGITS = 40
Nodes = Sequence[Decimal]
Floats = npt.NDArray[np.float64]


def exact(function: Any) -> Any:
    """A function whose Decimals have forty digits, whatever the caller's context."""

    @wraps(function)
    def inner(*arguments: Any) -> Any:
        with localcontext(Context(prec=DIGITS)):
            return function(*arguments)

    return inner


def _basis(nodes: Nodes, which: int) -> list[Decimal]:
    """Coefficients, of 1, t, t^2, ..., of the polynomial that is 1 at one node and 0 at all others."""
    found = [Decimal(1)]
    for other, node in enumerate(nodes):
        if other == which:
            continue
        apart = nodes[which] - node
        grown = [Decimal(0)] * (len(found) + 1)
        for power, coefficient in enumerate(found):
            grown[power] -= coefficient * node / apart
            grown[power + 1] += coefficient / apart
        found = grown
    return found


@exact
def integrals(nodes: Nodes, ends: Nodes) -> Floats:
    """Integral from 0 to each end of each node's polynomial, (ends, nodes): a_ij where ends are the nodes, b_j at 1.

    Source   Hairer, Norsett and Wanner (1993), section II.7, eq. 7.16
    """
    rows = [
        [
            float(sum(c * end ** (power + 1) / (power + 1) for power, c in enumerate(_basis(nodes, j))))
            for j in range(len(nodes))
        ]
        for end in ends
    ]
    return np.array(rows)


@exact
def difference(nodes: Nodes) -> Floats:
    """Weights (nodes,) of the divided difference: coefficient of the highest power of the polynomial through all."""
    return np.array([float(_basis(nodes, j)[-1]) for j in range(len(nodes))])


@exact
def inverse(matrix: Sequence[Sequence[Any]]) -> Floats:
    """Inverse of a small matrix of Decimals, by elimination with pivots."""
    size = len(matrix)
    rows = [[Decimal(x) for x in row] + [Decimal(int(i == j)) for j in range(size)] for i, row in enumerate(matrix)]
    for i in range(size):
        best = max(range(i, size), key=lambda k: abs(rows[k][i]))
        rows[i], rows[best] = rows[best], rows[i]
        rows[i] = [x / rows[i][i] for x in rows[i]]
        for k in range(size):
            if k != i:
                rows[k] = [x - rows[k][i] * y for x, y in zip(rows[k], rows[i], strict=True)]
    return np.array([[float(x) for x in row[size:]] for row in rows])


@exact
def nested_slopes(nodes: Nodes, rows: Sequence[int]) -> list[list[Decimal]]:
    """Slopes (nodes, rows) at the nodes of the terms that rows d_i have in the polynomial of `nested.make_nested`.

    term of d_i:   s^ceil((i + 1)/2) (1 - s)^floor((i + 1)/2)
    """

    def slope(s: Decimal, i: int) -> Decimal:
        up, down = (i + 2) // 2, (i + 1) // 2
        first = up * s ** (up - 1) * (1 - s) ** down if up > 1 else (1 - s) ** down
        second = down * s**up * (1 - s) ** (down - 1) if down > 1 else (s**up if down else Decimal(0))
        return first - second

    return [[slope(s, i) for i in rows] for s in nodes]
