"""How a case came out, in one word, from its row; and whether that is success."""

from __future__ import annotations

import math
from dataclasses import replace

from dcone_cosim.campaign.spec import Spec, Success
from dcone_cosim.cases.rows import Row
from dcone_cosim.contract import FLOWN, NEVER
from dcone_cosim.errors import CAPTURE_FAILED, HANDOFF_FAILED, OVERLOADED, SUCCESS
from dcone_cosim.scene.data import Scene

LOST_AGAIN = "no:"
"""How `capture.lasted` begins of a target that came out again."""
CAPTURE_OUTCOME, LASTED = "capture.outcome", "capture.lasted"
TOLD_BY = (CAPTURE_OUTCOME, LASTED)
"""Figures that say how a case came out; they are always kept."""
BROKE, OUT_AGAIN, DONE, NOT_HANDED_OVER = "broke", "out again", "completed", "not handed over"
FLYING, UNDECIDED = "flying", "undecided at the end"
"""What the FMU says of a net that is neither caught nor lost by the end of the phase, and what that is called."""
CAUGHT = ("captured", "settled")
"""Outcomes of a capture that has come to its hand-over."""
FAILED = ("missed", "slipped off", "not closed", "tether taut")
"""Outcomes of a capture that failed, as the FMU says; `tether taut`: the line stopped the net on its way."""
WORDS = (CAUGHT[0], *FAILED, UNDECIDED, OUT_AGAIN, BROKE, NOT_HANDED_OVER, FLOWN, DONE)
"""Every outcome of a case that gives an answer."""


def settled(spec: Spec, base: Scene) -> Spec:
    """The same with what counts as success, where it does not say that: a capture; where nothing can be caught, a net
    that is flown to its end; in a scene without a capture, that it comes to its end."""
    capture = next((phase for phase in base.phases if phase.name == "capture"), None)
    if spec.success != Success() or (capture is not None and capture.options.hand_over != NEVER):
        return spec
    if capture is None:
        return replace(spec, success=Success(DONE, text=DONE))
    return spec if "closing" in capture.main.terms else replace(spec, success=Success(FLOWN, text=FLOWN))


def answered(row: Row) -> bool:
    """Whether the case says anything of the scene: not where values did not go together, an FMU or a worker failed."""
    return row.exit_code in (SUCCESS, CAPTURE_FAILED, HANDOFF_FAILED, OVERLOADED)


def outcome(row: Row) -> str:
    """The word for it: one of a capture's outcomes, `broke`, `out again`, `completed`, or the status of what gave no
    answer.

    A line that bore more than it can has broken, whatever the run made of it. A target that was out of the net again by
    the end of the phase was captured, and did not stay so.

    Checked  tests/campaign/test_outcomes.py
    """
    if not answered(row):
        return row.status
    if row.exit_code == OVERLOADED:
        return BROKE
    if row.exit_code == HANDOFF_FAILED:
        return NOT_HANDED_OVER
    told = row.figures.get(CAPTURE_OUTCOME)
    if not isinstance(told, str):
        return DONE
    if row.exit_code == CAPTURE_FAILED:
        return UNDECIDED if told == FLYING else told
    if str(row.figures.get(LASTED, "")).startswith(LOST_AGAIN):
        return OUT_AGAIN
    return CAUGHT[0] if told in CAUGHT else told


def succeeded(row: Row, success: Success) -> bool | None:
    """Whether it came out as is wanted; None where the case gives no answer.

    Checked  tests/campaign/test_outcomes.py
    """
    if not answered(row):
        return None
    if success.figure:
        value = margin(row, success)
        return None if math.isnan(value) else value > 0.0
    word = outcome(row)
    return word == success.outcome or (success.outcome == "captured" and word in (*CAUGHT, DONE))


def margin(row: Row, success: Success) -> float:
    """How far a case is on the good side of the bound, in the figure's unit; NaN where it does not have the figure."""
    value = row.figures.get(success.figure)
    return success.margin(float(value)) if isinstance(value, int | float) else math.nan
