"""How a shot stands: captured, settled, or one of the ways to fail.

`captured` has to last: once the cord still out is shorter than the target's smallest girth, the target counts as caught
when net and mouth have gone round most of it for a while (see `enclosure`), so that the mouth has passed its middle and
would have to pass it again. While it stands in the mouth nothing is decided; the shot has failed when nothing is inside
any more, and a capture is taken back when less than half is. Both must last for a while: the cap over a slack mouth is
a guess, and may cut through the target for a moment.
"""

from __future__ import annotations

from typing import Any

from fmu_src.net_capture.enclosure import make_share
from orbital.kernel import kernel

OUTCOMES = ("flying", "captured", "settled", "missed", "slipped_off", "not_closed", "tether_taut")

FLYING, CAPTURED, SETTLED, MISSED, SLIPPED_OFF, NOT_CLOSED, TETHER_TAUT = range(len(OUTCOMES))

CAUGHT = 8 / 9
"""Share of the target's sample points inside from which it is caught: all of a box but one edge. What hovers about less
may still come out (tests/net_capture/evidence)."""
CAUGHT_TIME = 0.25
"""For how long [s] before it counts as caught: some poorly aimed shots get there for an instant, on their way out."""
OUT = 0.5
"""Share inside below which a target that was caught is on its way out."""
OUT_TIME = 1.0
"""For how long [s] before it counts as out."""


@kernel
def start_enclosure(p):
    """Nothing looked at, nothing caught, nothing lost.

    Checked  tests/net_capture/test_outcome.py
    """
    p.enclosure_share = -1.0
    p.enclosure_at_capture = -1.0
    p.enclosure_least = -1.0
    p.mouth_margin_at_capture = -1.0
    p.t_lost = -1.0


def make_judge(composition: Any, quality: Any) -> Any:
    """Kernel `judge(p, work, time)` of the model with the composition's parts, of the nodes as shown."""
    has_target = composition.target is not None
    has_contact = composition.contact is not None
    has_closing = composition.closing is not None
    has_tether = composition.tether is not None
    has_settling = "settling" in composition.terms
    share_inside = make_share(composition) if has_target and has_closing else None
    towards_chaser = composition.tether.reach if has_tether else None
    beyond, measure_net, looks = quality.beyond, quality.measure_net, composition.clock.looks

    @kernel
    def judge_flight(p, work, time):
        """Capture, or one of the ways to fail.

        Checked  tests/net_capture/test_outcome.py
        """
        if has_target:
            if has_closing:
                if p.closing_t_start >= 0.0 and p.mouth_cord_length < p.girth:
                    look_inside(p, work, time, 0.0)
                    if p.enclosure_share < CAUGHT:
                        p.enclosure_since = time
                    if time >= p.enclosure_since + CAUGHT_TIME:
                        catch(p, time)
                    elif is_out(p, time):
                        p.outcome = fail(p)
                if p.outcome == FLYING and p.trigger_time >= 0.0 and time > p.trigger_time + p.closing_timeout:
                    p.outcome = NOT_CLOSED
            elif beyond(p, work, p.target_place) > max(p.mouth_width[0], p.mouth_width[1]):
                p.outcome = fail(p)
        if has_tether:
            if p.outcome == FLYING and towards_chaser(p, work) >= p.tether_length:
                p.outcome = TETHER_TAUT

    @kernel
    def look_inside(p, work, time, out):
        """Share of the target inside, and when it was last above `out`; the first look counts as if it were.

        Checked  tests/net_capture/test_outcome.py
        """
        share = share_inside(p, work)
        if p.enclosure_share < 0.0:
            p.enclosure_since = time
        if share > out or p.enclosure_share < 0.0:
            p.enclosure_last_in = time
        p.enclosure_share = share

    @kernel
    def is_out(p, time):
        """Whether too little of the target has been inside for long enough.

        Checked  tests/net_capture/test_outcome.py
        """
        return time >= p.enclosure_last_in + OUT_TIME

    @kernel
    def catch(p, time):
        """The target is caught: keep how that looked.

        Checked  tests/net_capture/test_outcome.py
        """
        p.outcome = CAPTURED
        p.captured = 1
        p.t_capture = time
        p.enclosure_at_capture = p.enclosure_share
        p.enclosure_least = p.enclosure_share
        p.mouth_margin_at_capture = p.girth - p.mouth_cord_length
        if has_settling:
            p.calm_since = time

    @kernel
    def fail(p):
        """Missed, or slipped off after a touch.

        Checked  tests/net_capture/test_outcome.py
        """
        if has_contact:
            return SLIPPED_OFF if p.contact_first_time >= 0.0 else MISSED
        return MISSED

    @kernel
    def judge_catch(p, work, time):
        """Whether a catch holds, and whether it has settled; without a target or a cord nothing is ever caught.

        Checked  tests/net_capture/test_outcome.py
        """
        if has_target and has_closing:
            if looks(p) % 10 == 0:
                look_inside(p, work, time, OUT)
                if p.enclosure_share < p.enclosure_least:
                    p.enclosure_least = p.enclosure_share
            if is_out(p, time):
                p.outcome = SLIPPED_OFF
                p.captured = 0
                p.settled = 0
                p.t_lost = time
            elif has_settling:
                measure_net(p, work)
                squared = 0.0
                for i in range(3):
                    relative = p.catch_velocity[i] - p.target_drift[i]
                    squared += relative * relative
                if squared > p.settling_speed * p.settling_speed:
                    p.calm_since = time
                elif time >= p.calm_since + p.settling_time and p.settled == 0:
                    p.settled = 1
                    p.outcome = SETTLED

    @kernel
    def judge(p, work, time):
        """Bring the outcome up to date; what has failed stays failed.

        Checked  tests/net_capture/test_outcome.py
        """
        if p.outcome == FLYING:
            judge_flight(p, work, time)
        elif p.outcome == CAPTURED or p.outcome == SETTLED:
            judge_catch(p, work, time)

    return judge
