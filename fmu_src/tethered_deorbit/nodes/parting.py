"""How a line of nodes parts: the piece that bears the most breaks, or the one at the chaser is cut."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.idle import always, nothing
from fmu_src.tethered_deorbit.nodes.pieces import part
from orbital.kernel import kernel
from orbital.vectors import Array


class Parting(NamedTuple):
    """Kernels; as they stand, of a line of one piece, which is judged by its tension.

    bears(record, state, since) -> bool     whether no piece pulls harder than break.strength; the state as it is,
                                            `since` [s] after the inputs in force began to move
    tear(record, state)                     part the piece that pulls hardest
    cut(record, state)                      part the one at the chaser
    pieces                                  whether there are any
    """

    bears: Callable[..., Any] = always
    tear: Callable[..., Any] = nothing
    cut: Callable[..., Any] = nothing
    pieces: bool = False


def make_parting(span: Callable[..., Any], find_ends: Callable[..., Any], hardest: Callable[..., Any]) -> Parting:
    """The kernels for a line of nodes.

    span, find_ends, hardest   kernels of pieces, attachments and `Books`
    """

    @kernel
    def bears(record: Any, state: Array, since: float) -> bool:
        """See `Parting`.

        Checked  tests/tethered_deorbit/test_nodes_parted.py
        """
        find_ends(record, state)
        most, _ = hardest(record, state, since)
        return bool(most <= record[0].break_strength)

    @kernel
    def tear(record: Any, state: Array) -> None:
        """See `Parting`.

        Checked  tests/tethered_deorbit/test_nodes_parted.py
        """
        find_ends(record, state)
        _, piece = hardest(record, state, 0.0)
        length, _ = span(record, state, piece - 1)
        part(record, piece - 1, length, 0.0)

    @kernel
    def cut(record: Any, state: Array) -> None:
        """See `Parting`.

        Checked  tests/tethered_deorbit/test_nodes_parted.py
        """
        find_ends(record, state)
        length, _ = span(record, state, 0)
        part(record, 0, length, 0.0)

    return Parting(bears, tear, cut, True)
