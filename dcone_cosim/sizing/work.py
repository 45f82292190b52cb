"""One run of a tow for the sizing: its loads as plain data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from dcone_cosim.cases.case import Case
from dcone_cosim.cases.rows import Row, of_summary
from dcone_cosim.cases.work import run_case
from dcone_cosim.reports import summary
from dcone_cosim.results import PhaseResult, RunResult

COLUMNS = (
    *("tether.length_rate", "tether.wrapped", "reel.rate", "reel.power", "engine.power", "plume.share"),
    *("plume.force", "thrust.force", "aocs.deviation"),
)
"""Outputs whose extremes are kept."""


@dataclass(frozen=True)
class Load(Case):
    """A run whose loads are asked for.

    history    whether the turning points of the taut line are kept too
    """

    history: bool = False


def loads_of(result: PhaseResult, history: bool) -> dict[str, Any]:
    """Loads of a tow.

    tugs       time [s], peak [N] and speed [m/s] of each
    angles     of the line from the vertical at each tug, between rows [rad], and its rate [rad/s]
    peak       largest tension [N]
    taut       least and largest tension [N] of every macro step in which the line was taut all the time
    extremes   least, mean and largest of each of `COLUMNS`, over the rows
    """
    recorder, tugs = result.recorder, result.tugs
    rows = [] if tugs is None else [list(tugs.rows[number]) for number in sorted(tugs.rows)]
    missed = 0 if tugs is None else tugs.missed
    peaks = [row[1] for row in rows]
    for name in ("tether.tension_peak", "tether.tension"):
        if name in recorder and len(recorder):
            peaks.append(float(np.max(recorder[name])))
    extremes = {
        name: [float(f(recorder[name])) for f in (np.min, np.mean, np.max)]
        for name in COLUMNS
        if name in recorder and len(recorder)
    }
    angles = _angles(result, [row[0] for row in rows])
    found: dict[str, Any] = {
        "tugs": rows,
        "angles": angles,
        "missed": missed,
        "peak": max(peaks, default=0.0),
        "extremes": extremes,
    }
    if history and {"tether.tension_peak", "tether.tension_least"} <= set(recorder.names):
        least, most = recorder["tether.tension_least"][1:], recorder["tether.tension_peak"][1:]
        times = recorder["time"][1:]
        taut = least > 0.0
        found["taut"] = np.column_stack([times[taut], least[taut], most[taut]]).tolist()
    return found


def _angles(result: PhaseResult, times: list[float]) -> list[list[float]]:
    """Angle of the line [rad] and its rate [rad/s] at times [s], by cubic splines through the rows; none where there is
    no
    such output."""
    recorder = result.recorder
    if not times or "tether.angle" not in recorder or len(recorder) < 4:
        return []
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(recorder["time"], np.unwrap(recorder["tether.angle"]))
    return [[float(angle), float(rate)] for angle, rate in zip(spline(times), spline(times, 1), strict=True)]


def tell(case: Case, result: RunResult, timings: Mapping[str, float]) -> Row:
    """The row of a run with its summary and its loads."""
    row = of_summary(case.key, summary.as_dict(result), timings)
    assert isinstance(case, Load)
    samples = {name: loads_of(phase, case.history) for name, phase in result.phases.items()}
    return Row(row.key, row.status, row.exit_code, row.message, row.figures, row.units, row.timings, samples)


def run(case: Case) -> Row:
    """Run a case in this process, whose FMUs stay loaded for the next."""
    return run_case(case, tell)
