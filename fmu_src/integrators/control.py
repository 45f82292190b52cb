"""The size of the next step, for estimates of the error of eighth and of fourth order in the step."""

from __future__ import annotations

import math

from orbital.kernel import kernel

SAFETY = 0.9
LARGEST_GROWTH = 5.0
LARGEST_CUT = 0.2


@kernel
def next_step_8(step: float, error: float, previous_error: float) -> float:
    """Step [s] after a success, by a proportional-integral rule.

        h' = h * 0.9 e^(-3/32) e_old^(1/32),   held between h/5 and 5 h

    The powers are taken by repeated square roots, which round alike everywhere.

    error, previous_error  in units of the tolerance             [-]

    Valid    estimates that fall with the eighth power of the step
    Source   Gustafsson (1991): exponents 0.75/k and 0.25/k, k = 8
    Checked  tests/tethered_deorbit/test_estimated_error.py
    """
    now = math.sqrt(math.sqrt(math.sqrt(math.sqrt(math.sqrt(max(error, 1.0e-12))))))
    before = math.sqrt(math.sqrt(math.sqrt(math.sqrt(math.sqrt(max(previous_error, 1.0e-4))))))
    return step * min(LARGEST_GROWTH, max(LARGEST_CUT, SAFETY * before / (now * now * now)))


@kernel
def shorter_step_8(step: float, error: float) -> float:
    """Step [s] after a rejection.

        h' = h * max(0.2, 0.9 e^(-1/8)),   h/5 when the error is not a number

    error        in units of the tolerance, above 1              [-]

    Valid    estimates that fall with the eighth power of the step
    Source   Hairer, Norsett and Wanner, Solving ordinary differential equations I (1993), section II.4
    Checked  tests/tethered_deorbit/test_estimated_error.py
    """
    if not error < 1.0e6:
        return step * LARGEST_CUT
    return step * max(LARGEST_CUT, SAFETY / math.sqrt(math.sqrt(math.sqrt(error))))


@kernel
def next_step_4(step: float, error: float, previous_error: float) -> float:
    """Step [s] after a success: as `next_step_8`.

        h' = h * 0.9 e^(-3/16) e_old^(1/16),   held between h/5 and 5 h

    error, previous_error  in units of the tolerance             [-]

    Valid    estimates that fall with the fourth power of the step
    Source   Gustafsson (1991): exponents 0.75/k and 0.25/k, k = 4
    Checked  tests/tethered_deorbit/test_estimated_error.py
    """
    now = math.sqrt(math.sqrt(math.sqrt(math.sqrt(max(error, 1.0e-12)))))
    before = math.sqrt(math.sqrt(math.sqrt(math.sqrt(max(previous_error, 1.0e-4)))))
    return step * min(LARGEST_GROWTH, max(LARGEST_CUT, SAFETY * before / (now * now * now)))


@kernel
def shorter_step_4(step: float, error: float) -> float:
    """Step [s] after a rejection: as `shorter_step_8`.

        h' = h * max(0.2, 0.9 e^(-1/4)),   h/5 when the error is not a number

    error        in units of the tolerance, above 1              [-]

    Valid    estimates that fall with the fourth power of the step
    Source   Hairer, Norsett and Wanner (1993), section II.4
    Checked  tests/tethered_deorbit/test_estimated_error.py
    """
    if not error < 1.0e6:
        return step * LARGEST_CUT
    return step * max(LARGEST_CUT, SAFETY / math.sqrt(math.sqrt(error)))
