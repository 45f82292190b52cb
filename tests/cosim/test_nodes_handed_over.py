"""A capture handed over to a line of lumped nodes: their mass was the chaser's, and the line keeps its slack."""

import math
from typing import Any

import pytest

from dcone_cosim import build
from dcone_cosim.errors import HandoffError, InputError
from dcone_cosim.handoff import line_drawn, prepare
from dcone_cosim.line import SLACK, line_of
from dcone_cosim.loading import load
from dcone_cosim.transaction import HandoffRecord, close_ledger
from tests.cosim.raw_world import RATE, world
from tests.cosim.test_appendage import Removal
from tests.plain import plain

__all__ = ["plain"]
LENGTH, NODES = 40.0, 3


class Line(Removal):
    """That of a removal with a line of nodes, of this share of its density."""

    def __init__(self, record: HandoffRecord, denser: float = 1.0) -> None:
        super().__init__(record)
        if denser != 1.0:
            self.instance["lumped.density"] *= denser
            self.instance.initialise()


def handed_over() -> HandoffRecord:
    """A mission whose tow has such a line, the capture made of raw mass points."""
    length = f'tether.length="{LENGTH:g} m"'
    removal = load(
        "mission", ("removal.lumped.nodes=3", f"capture.{length}", f'removal.tether.rest_length="{LENGTH:g} m"')
    ).phases[1]
    found = line_drawn(prepare(world(3).outputs(), RATE), build.line_mass(removal.main.values, removal.main.terms))
    return HandoffRecord(10.0, 10.0, "told", removal, found, line_of(found, LENGTH))


def test_the_nodes_were_part_of_the_chaser(plain: None) -> None:
    made, record = world(3), handed_over()
    component: Any = Line(record)
    close_ledger(record, component)
    i = component.instance
    line = 1440.0 * 0.25 * math.pi * 1e-3**2 * LENGTH
    rows = {row.quantity: row for row in record.rows}
    booked = rows["mass, nodes of the line, from the chaser"]
    assert (booked.before, booked.accounted) == (pytest.approx(line * NODES / (NODES + 1)), 0.0)
    assert i["lumped.mass"] == booked.after
    before = prepare(made.outputs(), RATE)
    held = i["chaser.mass"] + i["target.mass"] + i["lumped.mass"]
    assert held == pytest.approx(before.chaser.mass + before.joint.mass, rel=1e-15)
    assert i["chaser.mass"] < before.chaser.mass
    assert rows[SLACK].closed
    assert i["lumped.most_tension"] == 0.0
    assert i["tether.length"] == pytest.approx(LENGTH - rows[SLACK].after, rel=1e-9)


def test_a_line_of_another_mass_is_seen(plain: None) -> None:
    record = handed_over()
    component: Any = Line(record, denser=1.0 + 1e-4)
    with pytest.raises(HandoffError, match="nodes of the line"):
        close_ledger(record, component)


@pytest.mark.parametrize("phase", ["removal", "second_tow"])
def test_a_second_tow_takes_no_such_line_over(phase: str) -> None:
    with pytest.raises(InputError, match=f"{phase}.lumped = a table: has mass, which is not handed over"):
        load("two-tows", (f"{phase}.lumped.nodes=3",))
