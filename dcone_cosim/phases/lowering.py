"""How far a tow has lowered the orbit of the pair, or raised it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from dcone_cosim.findings import Finding
from dcone_cosim.phases.tension import orbital_period, parting
from dcone_cosim.results import PhaseResult, RunResult
from dcone_cosim.scene.data import ComponentScene
from orbital.constants import EARTH_MU

NEAR = 1e-3
"""Largest distance of the pair over its radius up to which its centre of mass moves as one body does [1]."""
CLEAR = 10.0
"""How many times what an axis swings by it has to have moved for that to be told."""


def _main(run: RunResult, phase: str) -> ComponentScene:
    return next(one.main for one in run.scene.phases if one.name == phase)


def axis_of(run: RunResult, phase: str, result: PhaseResult) -> npt.NDArray[np.float64]:
    """Semi-major axis of the pair (rows,) [m]: osculating, or where the Earth is flattened, by the orbit's energy.

        a = -mu M/(2 E),   E with the potential of the flattening in it

    The osculating one breathes by kilometres there, twice a revolution, and two samples of it tell nothing. Of an FMU
    from elsewhere the two say whether its gravity is another than a sphere's.
    """
    recorder = result.recorder
    main = _main(run, phase)
    values = run.parameters.get(phase, {})
    osculating = recorder["center.semi_major_axis"]
    if not ({"chaser.mass", "target.mass"} <= values.keys() and "energy.orbital" in recorder):
        return osculating
    falls = "engine" in main.terms or (main.fmu is not None and "engine.propellant_left" in recorder)
    used = recorder["chaser.propellant"] if falls else 0.0
    mass = values["chaser.mass"] + values["target.mass"]
    by_energy = np.asarray(-0.5 * EARTH_MU * (mass - used) / recorder["energy.orbital"])
    if main.fmu is None:
        return by_energy if "oblateness" in main.terms else osculating
    held, _ = _while_held(result)  # far apart, two bodies' axis is no orbit's
    breathes = np.ptp((by_energy - osculating)[held]) > _noise(recorder["separation"][held], osculating)
    return by_energy if breathes else osculating


def _noise(separation: npt.NDArray[np.float64], axis: npt.NDArray[np.float64]) -> float:
    """What the pair's own motion moves the osculating axis by, at most [m]."""
    share = float(np.max(separation)) / float(np.min(axis))
    return (3.0 * share**2 + 1e-9) * float(axis[0])


def _breath(time: npt.NDArray[np.float64], axis: npt.NDArray[np.float64]) -> float:
    """By how much an axis goes up and down beside its course, in half a revolution [m]."""
    to_and_fro = float(np.abs(np.diff(axis)).sum()) - abs(float(axis[-1] - axis[0]))
    turns = max(1.0, 4.0 * float(time[-1] - time[0]) / orbital_period(float(axis[0])))
    return to_and_fro / turns


def _while_held(result: PhaseResult) -> tuple[npt.NDArray[np.intp], str]:
    """Rows in which a line holds the two bodies together, and what ended that, "" for nothing."""
    time = result.recorder["time"] - result.recorder["time"][0]
    _, end, told = parting(result.recorder)
    return np.flatnonzero(time <= end), told


def findings(run: RunResult, phase: str, result: PhaseResult) -> Iterator[Finding]:
    """How far the semi-major axis of the pair fell, where that is an orbit's.

    Gravity on the pair is not that on its mass at the centre: it differs by (3/2) (s/r)^2 at most, and moves the
    osculating axis by some of that. What is smaller than this is not told, nor, of an FMU whose gravity is not
    known, what is less than ten times what the axis goes up and down by, and nothing when the pair is far apart; a rate
    per day needs a whole revolution.
    """
    recorder = result.recorder
    if not {"center.semi_major_axis", "separation", "altitude"} <= set(recorder.names) or len(recorder) < 2:
        return
    axis = axis_of(run, phase, result)
    rows, until = _while_held(result)
    if len(rows) < 2:
        yield Finding(phase, "lowered", "orbit lowered by", f"not reported: too few rows before {until}")
        return
    time, axis, until = recorder["time"][rows], axis[rows], f", until {until}" if until else ""
    share = float(np.max(recorder["separation"][rows])) / float(np.min(axis))
    if not 0.0 <= share <= NEAR:
        text = f"not reported: chaser and target are up to {share:.2g} of the orbit's radius apart, more than {NEAR:g}"
        yield Finding(phase, "lowered", f"orbit lowered by{until}", text)
        return
    lowered, elapsed = float(axis[0] - axis[-1]), result.end - result.start
    if until:
        elapsed = float(time[-1] - time[0])
    noise = _noise(recorder["separation"][rows], axis)
    if not abs(lowered) > noise:
        yield Finding(phase, "lowered", f"orbit lowered by{until}", "too little to tell from the pair's own motion")
        return
    breath = _breath(time, axis) if _main(run, phase).fmu is not None else 0.0
    if breath > noise and abs(lowered) < CLEAR * breath:
        text = f"not reported: its osculating axis goes up and down by about {breath:.2g} m by itself"
        yield Finding(phase, "lowered", f"orbit lowered by{until}", text)
        return
    key, rate = ("lowered", "lowering_rate") if lowered > 0.0 else ("raised", "raising_rate")
    yield Finding(phase, key, f"orbit {key} by{until}", abs(lowered), "m")
    if elapsed >= orbital_period(float(axis[0])):
        yield Finding(phase, rate, f"orbit {key} by, per day", abs(lowered) / elapsed, "m/s", shown_in="m/day")
