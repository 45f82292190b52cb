"""The rows of a record against the longest state that a scene's terms make."""

from __future__ import annotations

import pytest

from fmu_src.tethered_deorbit.interface import MODEL
from fmu_src.tethered_deorbit.layout import layout_of
from fmu_src.tethered_deorbit.reel import LAWS, WINCHES, components

LONGEST = {
    "target": "rigid",
    "chaser": "rigid",
    "aocs": "wheels",
    "thrust": "along_track",
    "engine": "electric",
    "burn": "arcs",
}


def room_and_size(law: str, **terms: str) -> tuple[int, int]:
    """Components that `state.seen` has room for, and those of the state."""
    interface = MODEL.interface({"reel": law} | LONGEST | terms)
    rows = {v.name: v.shape for v in interface.variables}
    assert rows["state.seen[#]"] == rows["state.seen_rate[#]"]
    return rows["state.seen[#]"][0], layout_of(interface.terms, *components(law)).size


@pytest.mark.parametrize("law", [*LAWS, *WINCHES])
def test_a_state_fits_what_is_seen_of_it(law: str) -> None:
    room, size = room_and_size(law)
    assert size <= room


def test_the_longest_states_fill_it() -> None:
    assert max(size - room for room, size in map(room_and_size, [*LAWS, *WINCHES])) == 0


def test_so_does_that_of_a_line_of_nodes() -> None:
    room, size = room_and_size("locked", lumped="nodes")
    assert size <= room
