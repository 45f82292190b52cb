"""What a scene has to say so that its captured net is pulled, and by how much it gives handed over."""

from __future__ import annotations

from collections.abc import Iterator

from dcone_cosim.phases.phase import Document
from dcone_cosim.pulled import GIVEN, HOW, KEY, TAKES
from dcone_cosim.scene.mistakes import Mistake
from dcone_cosim.scene.toml_lines import given_at


def faults(document: Document, own: str) -> Iterator[Mistake]:
    """What a scene lacks that wants its net pulled, and what it gives although that is handed over.

    own           name of the removal
    """
    wanted = document.tables.get("handoff", {})
    how = wanted.get(KEY, GIVEN) if isinstance(wanted, dict) else GIVEN
    if how == GIVEN or how not in HOW:
        return
    path, before = ("handoff", KEY), document.before(own)
    if not before:
        yield Mistake(path, how, "there is no capture to hand over in this scene")
        return
    capture, removal = document.mains[before], document.mains[own]
    if capture.fmu is None and "pull_off" not in capture.terms:
        yield Mistake(path, how, f"needs the table [{before}.pull_off]: force, delay, ramp and duration of the pull")
    elif capture.fmu is None:
        when = document.tables[before].get("hand_over", "captured")
        after = document.tables[before]["pull_off"].get("after", "captured")
        if after != when:
            text = f'must be {before}.hand_over, "{when}": the net is pulled when all has been handed over'
            yield Mistake((before, "pull_off", "after"), after, text)
    if removal.fmu is None and not {"net", "lumped"} & removal.terms.keys():
        yield Mistake(path, how, f"needs the table [{own}.net], or [{own}.lumped]: a line with a net in series")
    for name in TAKES:
        if name in removal.given:
            given = removal.given[name]
            yield Mistake(given, given_at(document.tables, given), f"is handed over by handoff.{KEY}; leave it out")
