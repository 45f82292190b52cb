"""How a case came out, in one word, from its row; and whether that is success."""

from __future__ import annotations

import math
from dataclasses import replace

from dcone_cosim.campaign.spec import Judged, Spec, Success
from dcone_cosim.cases.rows import Row
from dcone_cosim.contract import FLOWN, NEVER
from dcone_cosim.errors import CAPTURE_FAILED, HANDOFF_FAILED, OVERLOADED, SUCCESS, InputError
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene.mistakes import Mistake, SceneError
from dcone_cosim.units import NO_UNIT, PURE, by_name, spoken

AT_THE_END = Judged()
ROUNDING = 1e-6
"""By which an instant that is told may be early [s]."""
LOST_AGAIN = "no:"
"""How `capture.lasted` begins of a target that came out again."""
OUTCOME, LASTED, LOST_AFTER, FOLLOWED, APPROACH = ".outcome", ".lasted", ".lost_after", ".followed", ".approach"
SHOTS = ("capture", "second_shot", "third_shot", "next_capture")
"""Phases that shoot, in their order: the last one that came says how a case came out."""
NEAR = (*SHOTS, "removal", "second_tow", "next_removal")
"""Phases that tell how near the target came to the chaser."""
TOLD_BY = (
    *(f"{shot}{what}" for shot in SHOTS for what in (OUTCOME, LASTED, LOST_AFTER, FOLLOWED)),
    *(f"{phase}{APPROACH}" for phase in NEAR),
)
"""Figures that say how a case came out; they are always kept."""
BROKE, OUT_AGAIN, DONE, NOT_HANDED_OVER = "broke", "out again", "completed", "not handed over"
TOO_NEAR = "too near the chaser"
OVERDRAWN = "propellant overdrawn"
"""Status of a run whose tow took more propellant than the chaser had."""
FLYING, UNDECIDED = "flying", "undecided at the end"
"""What the FMU says of a net that is neither caught nor lost by the end of the phase, and what that is called."""
CAUGHT = ("captured", "settled")
"""Outcomes of a capture that has come to its hand-over."""
FAILED = ("missed", "slipped off", "not closed", "tether taut")
"""Outcomes of a capture that failed, as the FMU says; `tether taut`: the line stopped the net on its way."""
WORDS = (CAUGHT[0], *FAILED, UNDECIDED, OUT_AGAIN, TOO_NEAR, BROKE, NOT_HANDED_OVER, OVERDRAWN, FLOWN, DONE)
"""Every outcome of a case that gives an answer."""


def possible(base: Scene) -> tuple[str, ...]:
    """Outcomes that cases of a scene can have, the one first that counts as success where a campaign does not say: a
    capture; where nothing can be caught, a net that is flown to its end; without a capture, that it comes to its end.

    Checked  tests/campaign/test_outcomes.py
    """
    capture = next((phase for phase in base.phases if phase.name == "capture"), None)
    if capture is None:
        return DONE, TOO_NEAR, BROKE
    if capture.options.hand_over != NEVER:
        without = (FLOWN, DONE) if math.isfinite(base.handoff.propellant) else (FLOWN, DONE, OVERDRAWN)
        return tuple(word for word in WORDS if word not in without)
    words = tuple(word for word in WORDS if word not in (FLOWN, DONE, NOT_HANDED_OVER, OVERDRAWN, UNDECIDED))
    if "closing" in capture.main.terms:
        return (*words, FLOWN)
    needs_closing = () if capture.main.fmu is not None else (CAUGHT[0], "not closed", OUT_AGAIN)
    return (FLOWN, *(word for word in words if word not in needs_closing))


def settled(spec: Spec, base: Scene) -> Spec:
    """The same with what counts as success, where it does not say that; `SceneError` for an outcome that no case of the
    scene can have, whose probability would be told all the same.

    Checked  tests/campaign/test_outcomes.py
    """
    words, success = possible(base), spec.success
    _followed(spec, base)
    if success.figure and not success.outcome:
        return spec
    if not success.said:
        return replace(spec, success=Success(words[0], text=words[0], judged=success.judged))
    if success.outcome not in words:
        text = f"no case of {base.name} can come out so: expected one of {', '.join(words)}, or a figure with a bound"
        raise SceneError([Mistake(("success",), success.outcome, text)], spec.places)
    return spec


def _followed(spec: Spec, base: Scene) -> None:
    """`SceneError` where no case can be followed until the instant after the capture at which it is to be judged."""
    after = spec.success.judged.after
    if not math.isfinite(after):
        return
    text = f"{base.name} has no capture"
    for phase in base.phases:
        if phase.name in SHOTS:
            options = phase.options
            text = "" if phase is base.phases[-1] else f"the {phase.name} ends as it hands over"
            if not text and options.after_capture < after:
                text = f"{phase.name}.after_capture is {options.after_capture:g} s, and must not be less"
    if text:
        raise SceneError([Mistake(("judged_after",), f"{after:g} s", text)], spec.places)


def answered(row: Row) -> bool:
    """Whether the case says anything of the scene: not where values did not go together, an FMU or a worker failed."""
    return row.exit_code in (SUCCESS, CAPTURE_FAILED, HANDOFF_FAILED, OVERLOADED)


def outcome(row: Row, judged: Judged = AT_THE_END) -> str:
    """The word for it: one of a capture's outcomes, `broke`, `out again`, `completed`, or the status of what gave no
    answer.

    A line that bore more than it can has broken, whatever the run made of it, and a target that came too near is told
    before what else came of it. One that was out of the net again by the instant at which it is judged was captured,
    and did not stay so; one that was not followed until then is undecided.

    Checked  tests/campaign/test_outcomes.py
    """
    if not answered(row):
        return row.status
    if row.exit_code == OVERLOADED:
        return BROKE
    if any(_number(row, f"{phase}{APPROACH}", math.inf) < judged.too_near for phase in NEAR):
        return TOO_NEAR
    if row.exit_code == HANDOFF_FAILED:
        return OVERDRAWN if row.status == OVERDRAWN else NOT_HANDED_OVER
    last = next((shot for shot in reversed(SHOTS) if isinstance(row.figures.get(f"{shot}{OUTCOME}"), str)), "")
    if not last:
        return DONE
    told = str(row.figures[f"{last}{OUTCOME}"])
    if row.exit_code == CAPTURE_FAILED:
        return UNDECIDED if told == FLYING else told
    if str(row.figures.get(f"{last}{LASTED}", "")).startswith(LOST_AGAIN):
        return OUT_AGAIN if _number(row, f"{last}{LOST_AFTER}", 0.0) <= judged.after else CAUGHT[0]
    followed = _number(row, f"{last}{FOLLOWED}", 0.0)
    if told in CAUGHT and math.isfinite(judged.after) and followed < judged.after - ROUNDING:
        return UNDECIDED
    return CAUGHT[0] if told in CAUGHT else told


def _number(row: Row, name: str, otherwise: float) -> float:
    value = row.figures.get(name, otherwise)
    return otherwise if isinstance(value, str) else float(value)


def succeeded(row: Row, success: Success) -> bool | None:
    """Whether it came out as is wanted; None where the case gives no answer, or has not the figure that is asked for.

    Checked  tests/campaign/test_outcomes.py
    """
    if not answered(row):
        return None
    came = not success.outcome or outcome(row, success.judged) == success.outcome
    if success.figure and came:
        value = margin(row, success)
        return None if math.isnan(value) else value > 0.0
    return came


def margin(row: Row, success: Success) -> float:
    """How far a case is on the good side of the bound, SI; NaN where it does not have the figure.

    `InputError` where the figure is in another unit than its bound.

    Checked  tests/campaign/test_outcomes.py
    """
    value = row.figures.get(success.figure)
    if isinstance(value, str) or value is None:
        return math.nan
    wrong = unlike(success, row.units.get(success.figure))
    if wrong:
        raise InputError(f"success = {success.text}: {wrong}")
    return success.margin(float(value))


def unlike(success: Success, unit: str | None) -> str:
    """Why a figure in this unit cannot be held against the bound, or "".

    Checked  tests/campaign/test_outcomes.py
    """
    if unit is None:
        return ""
    bound, figure = by_name(success.unit), by_name(unit)
    there, here = (PURE if one.name == NO_UNIT.name else one.dimension for one in (figure, bound))
    if there is None or there == here:
        return ""
    given = f"in {spoken(bound.name)}" if here != PURE else "a pure number"
    if there == PURE:
        return f"{success.figure} is a pure number, its bound is {given}; expected a bare number"
    told = spoken(unit)
    return f'{success.figure} is in {told}, its bound is {given}; expected one with its unit such as "10 {told}"'
