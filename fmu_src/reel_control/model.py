"""The reel control: one law, its rate and its derivatives; the one entry that an FMU calls."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numba
from numba import njit

from fmu_src.interface import DIFFERENTIATE, INITIALISE, REFRESH, SIZE, STEP
from fmu_src.reel_control.interface import BAD_PARAMETER, MODEL, NO_COMMAND, NOT_FINITE
from orbital.kernel import OPTIONS, kernel
from orbital.vectors import Array


def make_entry(terms: Mapping[str, str]) -> Any:
    """The compiled entry `(command, record, work, time, step) -> status`; there are no terms to choose.

        T = max(0, T_ff + k_p (l - l_c) + k_d l'),   0 while l = 0

    Valid    any
    Source   physics.md, section 2
    Checked  tests/reel_control/test_law.py
    """
    interface = MODEL.interface(terms)
    names = ("reel.length", "gain.proportional", "gain.derivative", "feed_forward")
    slots = tuple(interface.references[name] for name in names)
    length_slot = interface.references["length"]

    @kernel
    def fail(record: Any, code: int, index: int, value: float, time: float) -> int:
        r = record[0]
        r.fault_code = code
        r.fault_index = index
        r.fault_value = value if math.isfinite(value) else 0.0
        r.fault_time = time
        return code

    @kernel
    def check(record: Any, time: float) -> int:
        r = record[0]
        if not 0.0 < r.reel_length < math.inf:
            return fail(record, BAD_PARAMETER, slots[0], r.reel_length, time)
        if not 0.0 <= r.gain_proportional < math.inf:
            return fail(record, BAD_PARAMETER, slots[1], r.gain_proportional, time)
        if not 0.0 <= r.gain_derivative < math.inf:
            return fail(record, BAD_PARAMETER, slots[2], r.gain_derivative, time)
        if not 0.0 <= r.feed_forward < math.inf:
            return fail(record, BAD_PARAMETER, slots[3], r.feed_forward, time)
        return 0

    @kernel
    def wanted(record: Any) -> float:
        """What the law asks for [N], before it is held above zero."""
        r = record[0]
        stretch = r.length - r.reel_length
        force: float = r.feed_forward + r.gain_proportional * stretch + r.gain_derivative * r.length_rate
        return force

    @kernel
    def publish(record: Any, time: float) -> int:
        r = record[0]
        force = wanted(record)
        if not math.isfinite(force):
            return fail(record, NOT_FINITE, length_slot, r.length, time)
        r.tension = max(0.0, force) if r.length != 0.0 else 0.0
        return 0

    @kernel
    def remember(record: Any, drift: float, rate_drift: float) -> None:
        r = record[0]
        r.state_length = r.length
        r.state_length_rate = r.length_rate
        r.state_drift[0] = drift
        r.state_drift[1] = rate_drift

    @kernel
    def step_by(record: Any, time: float, step: float) -> int:
        r = record[0]
        drift, rate_drift = r.rate_length, r.rate_length_rate
        if drift != 0.0:
            r.length += drift * step
        if rate_drift != 0.0:
            r.length_rate += rate_drift * step
        remember(record, drift, rate_drift)
        return int(publish(record, time + step))

    @kernel
    def differentiate(record: Any) -> None:
        r = record[0]
        drift, rate_drift = r.rate_length, r.rate_length_rate
        if drift == 0.0 and r.length == r.state_length:
            drift = r.state_drift[0]
        if rate_drift == 0.0 and r.length_rate == r.state_length_rate:
            rate_drift = r.state_drift[1]
        force = wanted(record)
        slope = r.gain_proportional * drift + r.gain_derivative * rate_drift
        pulls = r.length != 0.0 and (force > 0.0 or (force == 0.0 and slope > 0.0))
        r.rate_tension = slope if pulls else 0.0
        r.partial_length = r.gain_proportional if pulls else 0.0
        r.partial_length_rate = r.gain_derivative if pulls else 0.0

    record_type = numba.from_dtype(interface.dtype)[::1]
    signature = numba.int32(numba.int64, record_type, numba.float64[::1], numba.float64, numba.float64)

    @njit(signature, **OPTIONS)
    def entry(command: int, record: Any, work: Array, time: float, step: float) -> int:
        r = record[0]
        r.fault_code = 0
        if command == SIZE:
            r.work_size = 0
            return 0
        if command == INITIALISE:
            remember(record, 0.0, 0.0)
            code = check(record, time)
            return code if code != 0 else publish(record, time)
        if command == STEP:
            return step_by(record, time, step)
        if command == REFRESH:
            return publish(record, time)
        if command == DIFFERENTIATE:
            differentiate(record)
            return 0
        return fail(record, NO_COMMAND, 0, float(command), time)

    return entry
