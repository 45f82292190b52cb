"""How a shot stands: captured, settled, or one of the ways to fail."""

from fmu_src.net_capture import quality
from fmu_src.net_capture.interface import OUTCOMES
from orbital.kernel import kernel

FLYING, CAPTURED, SETTLED, MISSED, SLIPPED_OFF, NOT_CLOSED, TETHER_TAUT = range(len(OUTCOMES))


def make_judge(terms, towards_chaser):
    """Kernel `judge(p, work, time)` of the model built with these terms.

    towards_chaser   kernel (p, work) -> distance from vertex to chaser [m]
    """
    has_target = "target" in terms
    has_contact = "contact" in terms
    has_closing = "closing" in terms
    has_tether = "tether" in terms
    has_settling = "settling" in terms

    @kernel
    def judge_flight(p, work, time):
        """Capture, or one of the ways to fail."""
        if has_target:
            beyond = quality.least_depth_beyond(p, work, p.target_place)
            if has_closing:
                if p.closing_t_start >= 0.0 and p.mouth_cord_length < p.girth:
                    if beyond > 0.0 and quality.encloses(p, work, p.target_place):
                        p.outcome = CAPTURED
                        p.captured = 1
                        p.t_capture = time
                        if has_settling:
                            p.calm_since = time
                    else:
                        p.outcome = fail(p)
                elif p.trigger_time >= 0.0 and time > p.trigger_time + p.closing_timeout:
                    p.outcome = NOT_CLOSED
            elif beyond > p.net_side:
                p.outcome = fail(p)
        if has_tether:
            if p.outcome == FLYING and towards_chaser(p, work) >= p.tether_length:
                p.outcome = TETHER_TAUT

    @kernel
    def fail(p):
        """Missed, or slipped off after a touch."""
        if has_contact:
            return SLIPPED_OFF if p.contact_first_time >= 0.0 else MISSED
        return MISSED

    @kernel
    def judge_catch(p, work, time):
        """Whether a catch holds, and whether it has settled."""
        if has_target:
            if p.grid % (10 * p.measure_every) == 0 and not quality.encloses(p, work, p.target_place):
                p.outcome = SLIPPED_OFF
                p.captured = 0
                p.settled = 0
            elif has_settling:
                quality.measure_net(p, work, 0.0)
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
        """Bring the outcome up to date; what has failed stays failed."""
        if p.outcome == FLYING:
            judge_flight(p, work, time)
        elif p.outcome == CAPTURED or p.outcome == SETTLED:
            judge_catch(p, work, time)

    return judge
