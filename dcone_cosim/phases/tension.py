"""The line's tension over the last orbit: mean, least and largest. One sample of a libration says nothing."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from dcone_cosim.recorder import Recorder
from dcone_cosim.results import PhaseResult
from orbital.constants import EARTH_MU
from orbital.plain import mean_motion


class Tension(NamedTuple):
    """Tension of the line [N] over the rows of a window.

    window     its length [s], from a row on
    is_orbit   it holds a whole orbit; the phase was shorter otherwise, and this is all of it
    orbits     how many it is long: more than one where rows are far apart               [1]
    mean       None where tugs fall between rows that are all there is
    sampled    which of mean, least and largest are those of the rows alone, since the FMU does not tell better
    until      what ended it before the end of the phase, "" for nothing
    """

    window: float
    is_orbit: bool
    orbits: float
    mean: float | None
    least: float
    largest: float
    sampled: frozenset[str]
    until: str = ""


PARTED = (("release.released", "release.time", "the line was cut"), ("break.broken", "break.time", "the line broke"))
"""Outputs that tell that a line has parted, and when since the phase began [s], and what that is called."""


def parting(recorder: Recorder) -> tuple[int, float, str]:
    """The first row of a line that has parted, the instant since the first row [s], and what it was; where it holds to
    the end the number of rows, infinite and ""."""
    first = len(recorder), math.inf, ""
    for flag, when, told in PARTED:
        if flag in recorder and recorder.last()[flag]:
            row = int(np.argmax(np.asarray(recorder[flag], dtype=bool)))
            first = min(first, (row, recorder.last().get(when, math.inf), told))
    return first


def orbital_period(axis: float) -> float:
    """Period [s] of an orbit about the Earth: 2 pi / n.

    axis          a   semi-major                                 [m]
    """
    return 2.0 * math.pi / mean_motion(axis, EARTH_MU)


def last_orbit(result: PhaseResult) -> Tension | None:
    """Tension from the last row that lies an orbit or more before the end; None when nothing is recorded of it.

        mean = (J(end) - J(begin)) / (end - begin),   J the integral of the tension

    The end is that of the phase, or when the line parted: what is no line has no tension to be told.

    The window begins at a row, so that nothing has to be guessed between rows. What the FMU tells of a macro step
    (least, peak, impulse) holds for all of it; without that, rows are samples, and their mean is by trapezoids.

    Checked  tests/cosim/test_tension.py
    """
    recorder = result.recorder
    if "tether.tension" not in recorder or len(recorder) < 2:
        return None
    time = recorder["time"] - recorder["time"][0]
    parted, instant, until = parting(recorder)
    stop = min(parted, len(time) - 1)
    end = float(min(time[stop], instant))
    if not end > time[0]:
        return None
    period = math.inf
    if "center.semi_major_axis" in recorder and recorder["center.semi_major_axis"][stop] > 0.0:
        period = orbital_period(float(recorder["center.semi_major_axis"][stop]))
    begin = int(np.searchsorted(time, end - period, side="right")) - 1
    is_orbit, begin = begin >= 0, max(begin, 0)
    rows, steps = slice(begin, max(parted, begin + 1)), slice(begin + 1, stop + 1)
    window, sampled = end - float(time[begin]), set()
    tugs = result.tugs.rows.values() if result.tugs is not None else ()
    peaks = [peak for begun, peak, _ in tugs if begun >= recorder["time"][begin]]
    tension = recorder["tether.tension"][rows]
    mean: float | None = None
    if "tether.impulse" in recorder:
        impulse = recorder["tether.impulse"]
        mean = float(impulse[stop] - impulse[begin]) / window
    else:
        sampled.add("mean")
        spanned = float(time[rows][-1] - time[begin])
        mean = float(np.trapezoid(tension, time[rows])) / spanned if spanned > 0.0 and not peaks else None
    extremes = []
    for what, output, extreme in (
        ("least", "tether.tension_least", np.min),
        ("largest", "tether.tension_peak", np.max),
    ):
        if output not in recorder:
            sampled.add(what)
        seen = recorder[output][steps] if output in recorder else tension
        if what == "least" and until and output in recorder and len(seen) > 1:
            seen = seen[:-1]  # in the step in which it parted it has been slack
        extremes.append(float(extreme(seen)))
    least, largest = extremes
    return Tension(window, is_orbit, window / period, mean, least, max([largest, *peaks]), frozenset(sampled), until)
