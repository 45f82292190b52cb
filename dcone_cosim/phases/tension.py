"""The line's tension over the last orbit: mean, least and largest. One sample of a libration says nothing."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from dcone_cosim.results import PhaseResult
from orbital.constants import EARTH_MU
from orbital.plain import mean_motion


class Tension(NamedTuple):
    """Tension of the line [N] over the rows of a window.

    window     its length [s], a whole number of macro steps
    is_orbit   it holds a whole orbit; the phase was shorter otherwise, and this is all of it
    orbits     how many it is long: more than one where rows are far apart               [1]
    mean       None where tugs fall between rows that are all there is
    sampled    which of mean, least and largest are those of the rows alone, since the FMU does not tell better
    """

    window: float
    is_orbit: bool
    orbits: float
    mean: float | None
    least: float
    largest: float
    sampled: frozenset[str]


def orbital_period(axis: float) -> float:
    """Period [s] of an orbit about the Earth: 2 pi / n.

    axis          a   semi-major                                 [m]
    """
    return 2.0 * math.pi / mean_motion(axis, EARTH_MU)


def last_orbit(result: PhaseResult) -> Tension | None:
    """Tension from the last row that lies an orbit or more before the end; None when nothing is recorded of it.

        mean = (J(end) - J(begin)) / (end - begin),   J the integral of the tension

    The window begins at a row, so that nothing has to be guessed between rows. What the FMU tells of a macro step
    (least, peak, impulse) holds for all of it; without that, rows are samples, and their mean is by trapezoids.

    Checked  tests/cosim/test_tension.py
    """
    recorder = result.recorder
    if "tether.tension" not in recorder or len(recorder) < 2:
        return None
    time = recorder["time"] - recorder["time"][0]
    period = math.inf
    if "center.semi_major_axis" in recorder and recorder["center.semi_major_axis"][-1] > 0.0:
        period = orbital_period(float(recorder["center.semi_major_axis"][-1]))
    begin = int(np.searchsorted(time, time[-1] - period, side="right")) - 1
    is_orbit, begin = begin >= 0, max(begin, 0)
    rows, steps = slice(begin, None), slice(begin + 1, None)
    window, sampled = float(time[-1] - time[begin]), set()
    tugs = result.tugs.rows.values() if result.tugs is not None else ()
    peaks = [peak for begun, peak, _ in tugs if begun >= recorder["time"][begin]]
    tension = recorder["tether.tension"][rows]
    mean: float | None = None
    if "tether.impulse" in recorder:
        impulse = recorder["tether.impulse"]
        mean = float(impulse[-1] - impulse[begin]) / window
    else:
        sampled.add("mean")
        mean = float(np.trapezoid(tension, time[rows])) / window if not peaks else None
    extremes = []
    for what, output, extreme in (
        ("least", "tether.tension_least", np.min),
        ("largest", "tether.tension_peak", np.max),
    ):
        if output not in recorder:
            sampled.add(what)
        extremes.append(float(extreme(recorder[output][steps] if output in recorder else tension)))
    least, largest = extremes
    return Tension(window, is_orbit, window / period, mean, least, max([largest, *peaks]), frozenset(sampled))
