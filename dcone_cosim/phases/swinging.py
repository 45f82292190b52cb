"""A capture's appendage that swings: with which phases it goes, and how a tow takes it over, which holds it fast."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from dcone_cosim import build
from dcone_cosim.appendage import ANGLE, APPENDAGE, SPEED
from dcone_cosim.handoff import require_rigid
from dcone_cosim.level import GROUP, POINT
from dcone_cosim.phases.phase import Document
from dcone_cosim.scene.data import PhaseScene
from dcone_cosim.scene.mistakes import Mistake

HINGE, HELD, TOW = "hinge", "appendage", "removal"
"""Table of a capture, and that of the tow which takes it over."""
SHOWN = '[removal.appendage], empty, and [removal.target] with a body that turns, such as body = "rigid"'


def faults(document: Document, capture: str) -> Iterator[Mistake]:
    """A phase before it or after it that knows one rigid target, and what the hand-off sets."""
    mine, before, after = document.mains[capture], document.before(capture), document.after(capture)
    if mine.fmu is not None or HINGE not in mine.terms or not (before or after):
        return
    if before or after != TOW:
        text = f"goes with no {before or after}: what is handed over to or from one is one rigid target"
        yield Mistake((capture, HINGE), None, text)
        return
    tow = document.mains[after]
    offered = set(APPENDAGE) <= set(tow.slots) if tow.fmu is not None else HELD in tow.terms and turns(tow.terms)
    if not offered:
        text = f"is held fast by the {after} that follows, which needs for it {SHOWN}"
        yield Mistake((capture, HINGE), None, text)
    given = document.tables[after].get(HELD)
    for key, value in given.items() if isinstance(given, dict) else ():
        if any(name.partition("[")[0] == f"{HELD}.{key}" for name in APPENDAGE):
            text = f"is set by the hand-off from the {capture}, which has [{capture}.{HINGE}]; leave it out"
            yield Mistake((after, HELD, key), value, text)


def turns(terms: Mapping[str, str]) -> bool:
    """Whether the target of a tow of ours turns, by its scene's own word."""
    return terms.get(GROUP, POINT) != POINT


def held(
    before: PhaseScene, tow: PhaseScene, values: Mapping[str, float], left: Mapping[str, float]
) -> dict[str, float]:
    """A capture's appendage as it is handed over, by the tow's names, places from the target's centre of mass; empty of
    one rigid target; `HandoffError` where it swings in a way that the tow cannot take over.

    values    parameters of the capture
    left      what it leaves

    Checked  tests/cosim/test_hinge_handed_over.py
    """
    if ANGLE not in left:
        return {}
    main = before.main
    found = build.appendage_held({**values, **main.made}, main.terms, left[ANGLE], left[SPEED])
    if not found:
        require_rigid(left, "of a capture FMU from elsewhere it is not known what swings")
    if any(name not in tow.main.defaults for name in APPENDAGE):
        require_rigid(left, f"the {tow.name} needs for it {SHOWN}")
    return found
