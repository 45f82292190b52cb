"""Outputs per node and per thread: terms for any number of them, since an FMU's variables are counted at its build."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from fmu_src.interface import Term, Variable
from fmu_src.net_capture.nets import LARGEST_MESH

MOST_NODES = (LARGEST_MESH + 1) ** 2
"""Nodes of the largest net there is, one of uncut threads: each brings three outputs, so more would be of no use."""
MOST_THREADS = 3 * MOST_NODES
"""Threads that so many nodes of a net without crossings can have: 3 n - 6 (Euler)."""


class Family(Mapping[str, Term]):
    """A term for any number of one thing: `{"nodes": "625"}` gives an FMU with outputs for up to 625 nodes.

    rows(capacity)    the variables of so many
    excludes          groups with which none of its terms goes together
    """

    def __init__(
        self,
        what: str,
        summary: str,
        most: int,
        rows: Callable[[int], tuple[Variable, ...]],
        excludes: tuple[str, ...] = (),
    ) -> None:
        self.what, self.summary, self.most, self.rows, self.excludes = what, summary, most, rows, excludes

    def __getitem__(self, capacity: str) -> Term:
        if capacity not in self:
            raise KeyError(capacity)
        summary = f"{self.summary}, up to {capacity} {self.what}"
        return Term(summary, self.rows(int(capacity)), excludes=self.excludes)

    def __contains__(self, capacity: object) -> bool:
        return (
            isinstance(capacity, str)
            and capacity.isascii()
            and capacity.isdecimal()
            and len(capacity) <= len(str(self.most))
            and 1 <= int(capacity) <= self.most
        )

    def __iter__(self) -> Iterator[str]:
        return iter((f"a whole number of {self.what}, from 1 to {self.most}",))

    def __len__(self) -> int:
        return 1


def node_rows(capacity: int) -> tuple[Variable, ...]:
    """Position of every node."""
    position = Variable(
        "node[#].position[#]",
        "m",
        "output",
        "node of the net, orbital frame, row by row of the flat net (knots first, then the inner nodes of the threads)",
        shape=(capacity, 3),
    )
    return (position,)


def thread_rows(capacity: int) -> tuple[Variable, ...]:
    """Tension of every thread, its two nodes, and where in the net's memory it stands."""
    return (
        Variable(
            "thread[#].tension",
            "N",
            "output",
            "what the thread bears now, its dashpot's share included; 0 when slack or broken",
            shape=(capacity,),
        ),
        Variable(
            "thread[#].node[#]",
            "1",
            "output",
            "numbers of its two nodes, as the outputs of the nodes count them from 1; 0: there is no such thread",
            0,
            kind="Integer",
            shape=(capacity, 2),
            minimum=0,
            discrete=True,
        ),
        Variable("thread_strip[#]", "1", "state", "strip that the thread is of", 0, kind="Integer", shape=(capacity,)),
        Variable("thread_lane[#]", "1", "state", "and its lane there", 0, kind="Integer", shape=(capacity,)),
    )


FAMILIES: Mapping[str, Family] = {
    "nodes": Family("nodes", "position of every node", MOST_NODES, node_rows),
    # a thread that lies round an edge is longer than the straight way that is measured here
    "threads": Family(
        "threads", "tension of every thread, and between which nodes it runs", MOST_THREADS, thread_rows, ("wrap",)
    ),
}
"""Groups with a term for any number, by name."""
