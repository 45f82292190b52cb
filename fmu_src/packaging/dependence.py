"""What depends on what, by slot: read from the `rate` and `partials` of a table of variables, and checked."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from fmu_src.interface import Interface, Variable


@dataclass(frozen=True)
class Rate:
    """An input or output, and the slot that holds its time derivative."""

    slot: int
    rate: int
    is_input: bool


@dataclass(frozen=True)
class Partial:
    """An output, an input it depends on directly, and the slot that holds the derivative of one by the other."""

    output: int
    input: int
    slot: int


def first_slots(interface: Interface) -> dict[str, tuple[int, Variable]]:
    """First slot and row of every variable, by the name in its row."""
    found: dict[str, tuple[int, Variable]] = {}
    slot = 0
    for v in interface.variables:
        found[v.name] = (slot, v)
        slot += v.size
    return found


def rates(interface: Interface) -> list[Rate]:
    """Every scalar with a time derivative, in the order of their slots.

    ValueError if a row names a rate that is not in the table, or is no Real of its shape.

    Checked  tests/packaging/test_description.py
    """
    rows = first_slots(interface)
    found = []
    for v in interface.variables:
        if v.rate:
            slot, _ = rows[v.name]
            rate = _named(interface, v, v.rate)
            found += [Rate(slot + k, rate + k, v.causality == "input") for k in range(v.size)]
    return found


def partials(interface: Interface) -> list[Partial]:
    """Every pair of output and input that depend directly, in the order of their slots.

    ValueError if a row names something that is not in the table, or does not fit.

    Checked  tests/packaging/test_description.py
    """
    rows = first_slots(interface)
    found = []
    for v in interface.variables:
        for by, held in v.partials:
            source, first = _input(interface, v, by), _named(interface, v, held)
            found += [Partial(rows[v.name][0] + k, source, first + k) for k in range(v.size)]
    return sorted(found, key=lambda p: (p.output, p.input))


def inputs_of(interface: Interface) -> dict[int, list[int]]:
    """Slots of the inputs each output depends on directly, by the output's slot."""
    found: dict[int, list[int]] = {}
    for p in partials(interface):
        found.setdefault(p.output, []).append(p.input)
    return found


def inputs_at_start(interface: Interface) -> dict[int, list[int]]:
    """Slots of the inputs each output depends on at the start, in order: those it depends on directly, and more."""
    rows = first_slots(interface)
    found = inputs_of(interface)
    for v in interface.variables:
        more = [_input(interface, v, by) for by in v.at_start]
        for slot in range(rows[v.name][0], rows[v.name][0] + v.size) if more else ():
            found[slot] = sorted({*found.get(slot, ()), *more})
    return found


def names_by_slot(interface: Interface) -> Iterator[str]:
    """Name of every scalar, hidden ones too, in the order of their slots."""
    return (name.removeprefix("@") for name, _, _, _ in interface.scalars())


def _input(interface: Interface, v: Variable, by: str) -> int:
    """Slot of the scalar input `by`, which `v` names."""
    slot, row = first_slots(interface).get(by, (0, None))
    if row is None or row.causality != "input" or row.shape:
        raise ValueError(f"{v.name} is said to depend on {by}, which is no scalar input of this model")
    return slot


def _named(interface: Interface, v: Variable, other: str) -> int:
    """First slot of the row `other`, which holds Reals of the shape of `v`."""
    slot, row = first_slots(interface).get(other, (0, None))
    if row is None or row.kind != "Real" or row.shape != v.shape:
        raise ValueError(f"{v.name} names {other!r}: expected a Real of shape {v.shape} in the same table")
    return slot
