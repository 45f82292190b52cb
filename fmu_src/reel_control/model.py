"""The reel control: one law, a motor behind it or none, rates and derivatives; the one entry that an FMU calls."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from fmu_src.interface import DIFFERENTIATE, INITIALISE, REFRESH, SIZE, STEP, check_implemented
from fmu_src.limits import make_limits
from fmu_src.reel_control.interface import BAD_PARAMETER, MODEL, NO_COMMAND, NOT_FINITE
from orbital.kernel import entry, kernel
from orbital.vectors import Array

IMPLEMENTED = {"motor": ("lag",)}
"""Terms that are composed here."""


def make_entry(terms: Mapping[str, str]) -> Any:
    """The compiled entry `(command, record, work, time, step) -> status` of the law with the given terms.

        asked = max(0, T_ff + k_p (l - l_c) + k_d l'),   0 while l = 0
        T = asked, or with a motor's lag  dT/dt = (asked - T) / tau

    terms         {} or {"motor": "lag"}

    Valid    any
    Source   fmu_src/reel_control/README.md, What is computed
    Checked  tests/reel_control/test_law.py
    """
    check_implemented(MODEL, IMPLEMENTED, terms)
    interface = MODEL.interface(terms)
    has_lag = "motor" in terms
    limits = make_limits(
        interface, "reel.length", "gain.proportional", "gain.derivative", "feed_forward", "motor.time_constant"
    )
    length_slot = interface.references["length"]

    @kernel
    def fail(record: Any, code: int, index: int, value: float, time: float) -> int:
        """The code, with what, its value and when [s] put in the record; a value that is no number is shown as zero.

        index         value reference of what is at fault
        value         SI

        Checked  tests/reel_control/test_law.py: refusals
        """
        r = record[0]
        r.fault_code = code
        r.fault_index = index
        r.fault_value = value if math.isfinite(value) else 0.0
        r.fault_time = time
        return code

    @kernel
    def wanted(record: Any) -> float:
        """What the law asks for [N], before it is held above zero.

            T_ff + k_p (l - l_c) + k_d l'

        Checked  tests/reel_control/test_law.py
        """
        r = record[0]
        stretch = r.length - r.reel_length
        force: float = r.feed_forward + r.gain_proportional * stretch + r.gain_derivative * r.length_rate
        return force

    @kernel
    def asked(record: Any) -> float:
        """What the law asks for [N] with the inputs of now; nothing while no length is measured.

        Checked  tests/reel_control/test_law.py
        """
        r = record[0]
        return max(0.0, wanted(record)) if r.length != 0.0 else 0.0

    @kernel
    def publish(record: Any, time: float) -> int:
        """Write the tension [N] of a motor that gives what is asked at once; one with a lag has its tension already.

        Returns 0 or a fault.

        Checked  tests/reel_control/test_law.py: an output follows its inputs at once
        """
        r = record[0]
        if not math.isfinite(wanted(record)):
            return fail(record, NOT_FINITE, length_slot, r.length, time)
        if not has_lag:
            r.tension = asked(record)
        return 0

    @kernel
    def follow(record: Any, begin: float, slope: float, step: float) -> None:
        """Let a lagging motor follow what is asked while that moves at a constant rate, exactly.

            T(t) = a + b (t - tau) + (T_0 - a + b tau) exp(-t / tau)

        begin         a, asked at the begin                          [N]
        slope         b, its rate                                    [N/s]
        step          t                                              [s]

        Source   solution of tau dT/dt = a + b t - T
        Checked  tests/reel_control/test_law.py: a motor follows held and moving inputs
        """
        r = record[0]
        lag = r.motor_time_constant
        r.tension = begin + slope * (step - lag) + (r.tension - begin + slope * lag) * math.exp(-step / lag)

    @kernel
    def remember(record: Any, drift: float, rate_drift: float) -> None:
        """Keep the inputs as a step leaves them, and the rates it had [m/s], [m/s^2].

        Checked  tests/reel_control/test_law.py: derivatives after a step
        """
        r = record[0]
        r.state_length = r.length
        r.state_length_rate = r.length_rate
        r.state_drift[0] = drift
        r.state_drift[1] = rate_drift

    @kernel
    def follow_asked(record: Any, begin: float, slope: float, step: float, measured: bool) -> None:
        """Follow what the law asks for over a step, cut where it crosses zero.

        begin, slope  asked before it is held above zero, and its rate   [N], [N/s]
        step                                                         [s]
        measured      there is a length; else nothing is asked

        Source   `follow` on either side of the zero
        Checked  tests/reel_control/test_law.py: also where it comes to zero or leaves it within the step
        """
        if not measured:
            follow(record, 0.0, 0.0, step)
            return
        end = begin + slope * step
        if begin >= 0.0 and end >= 0.0:
            follow(record, begin, slope, step)
        elif begin <= 0.0 and end <= 0.0:
            follow(record, 0.0, 0.0, step)
        else:
            crossing = -begin / slope
            if begin > 0.0:
                follow(record, begin, slope, crossing)
                follow(record, 0.0, 0.0, step - crossing)
            else:
                follow(record, 0.0, 0.0, crossing)
                follow(record, 0.0, slope, step - crossing)

    @kernel
    def step_by(record: Any, time: float, step: float) -> int:
        """Advance by a step [s], the inputs moving at their rates; returns 0 or a fault.

        Checked  tests/reel_control/test_law.py: moving inputs
        """
        r = record[0]
        drift, rate_drift = r.rate_length, r.rate_length_rate
        begin, measured = wanted(record), r.length != 0.0
        if drift != 0.0:
            r.length += drift * step
        if rate_drift != 0.0:
            r.length_rate += rate_drift * step
        remember(record, drift, rate_drift)
        if has_lag:
            slope = r.gain_proportional * drift + r.gain_derivative * rate_drift
            follow_asked(record, begin, slope, step, measured or r.length != 0.0)
        return int(publish(record, time + step))

    @kernel
    def differentiate(record: Any) -> None:
        """Fill the rate of the tension [N/s] and its derivatives by the inputs [N/m], [N s/m].

            T' = k_p l' + k_d l'',   with a motor's lag  (asked - T)/tau and no direct derivatives

        Checked  tests/reel_control/test_law.py: derivatives
        """
        r = record[0]
        drift, rate_drift = r.rate_length, r.rate_length_rate
        if drift == 0.0 and r.length == r.state_length:
            drift = r.state_drift[0]
        if rate_drift == 0.0 and r.length_rate == r.state_length_rate:
            rate_drift = r.state_drift[1]
        force = wanted(record)
        slope = r.gain_proportional * drift + r.gain_derivative * rate_drift
        pulls = r.length != 0.0 and (force > 0.0 or (force == 0.0 and slope > 0.0))
        if has_lag:
            r.rate_tension = (asked(record) - r.tension) / r.motor_time_constant
            return
        r.rate_tension = slope if pulls else 0.0
        r.partial_length = r.gain_proportional if pulls else 0.0
        r.partial_length_rate = r.gain_derivative if pulls else 0.0

    @entry(interface.dtype)
    def model_entry(command: int, record: Any, work: Array, time: float, step: float) -> int:
        """The entry of `fmu_src.interface`, by command; returns a status.

        Checked  tests/reel_control/test_law.py
        """
        r = record[0]
        r.fault_code = 0
        if command == SIZE:
            r.work_size = 0
            return 0
        if command == INITIALISE:
            remember(record, 0.0, 0.0)
            slot, value = limits(record)
            if slot >= 0:
                return fail(record, BAD_PARAMETER, slot, value, time)
            r.tension = asked(record)
            return publish(record, time)
        if command == STEP:
            return step_by(record, time, step)
        if command == REFRESH:
            return publish(record, time)
        if command == DIFFERENTIATE:
            differentiate(record)
            return 0
        return fail(record, NO_COMMAND, 0, float(command), time)

    return model_entry
