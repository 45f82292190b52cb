"""What becomes of the two bodies once their line is cut: how near they come again, and where each of them goes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np
import numpy.typing as npt

from dcone_cosim import build
from dcone_cosim.findings import SHOWN_IN, Finding
from dcone_cosim.phases.passive import Nearest
from dcone_cosim.results import PhaseResult, RunResult
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.decay import lifetime, mean_orbit

Vectors = npt.NDArray[np.float64]
EACH = tuple(f"[{i}]" for i in (1, 2, 3))
LOW = 120e3
"""Altitude at which a re-entry is taken to begin, by convention [m]."""
YEAR = 365.25 * 86400.0
LONGEST = 200.0 * YEAR
"""Longest lifetime that is told: nobody knows the air of a later century."""


def nearest_return(time: Vectors, position: Vectors, velocity: Vectors) -> Nearest | None:
    """Least distance at which two bodies that came apart turn back and pass, and when; None where they never do.

    Between two rows the relative motion is the cubic through both ends' places and velocities.

    time                 (n,) [s]
    position, velocity   relative, velocity that of the components  (n, 3) [m], [m/s]

    Checked  tests/cosim/test_released.py, against two Kepler orbits
    """
    closing = np.sum(position * velocity, axis=1)
    best: Nearest | None = None
    for i in np.flatnonzero((closing[:-1] < 0.0) & (closing[1:] >= 0.0)):
        h = float(time[i + 1] - time[i])
        p, q, u, w = position[i], position[i + 1], h * velocity[i], h * velocity[i + 1]
        cubic = np.array([p, u, 3.0 * (q - p) - 2.0 * u - w, 2.0 * (p - q) + u + w])
        square = np.sum([np.convolve(cubic[:, k], cubic[:, k]) for k in range(3)], axis=0)[::-1]
        roots = np.roots(np.polyder(square))
        turns = [float(x.real) for x in roots if abs(x.imag) < 1e-9 and 0.0 <= x.real <= 1.0]
        for x in (0.0, 1.0, *turns):
            distance = math.sqrt(max(0.0, float(np.polyval(square, x))))
            if best is None or distance < best.distance:
                best = Nearest(distance, float(time[i]) + x * h)
    return best


TOLD = ("release.returned", "release.return_distance", "release.return_time")
"""By which an FMU tells itself how near they came again, between rows as well."""


def after_the_cut(result: PhaseResult) -> Nearest | None:
    """The nearest return after the line was cut [m], and when since the phase began [s]: by the FMU's own watch or,
    without that, by the rows there are."""
    recorder = result.recorder
    if set(TOLD) <= set(recorder.names):
        returned, distance, when = (recorder.last()[name] for name in TOLD)
        return Nearest(distance, when) if returned else None
    needed = {f"relative.{what}{each}" for what in ("position", "velocity") for each in EACH}
    if not needed <= set(recorder.names) or not recorder.last().get("release.released"):
        return None
    time = recorder["time"] - recorder["time"][0]
    rows = time >= recorder.last()["release.time"]
    position, velocity = (
        np.stack([recorder[f"relative.{what}{each}"][rows] for each in EACH], axis=1)
        for what in ("position", "velocity")
    )
    return nearest_return(time[rows], position, velocity)


def apsides(position: Vectors, velocity: Vectors) -> tuple[float, float, float, float]:
    """Semi-major axis [m], eccentricity, and altitudes of perigee and apogee [m] of the osculating orbit.

    Source   vis viva, eccentricity vector
    Checked  tests/cosim/test_released.py
    """
    radius = float(np.linalg.norm(position))
    axis = 1.0 / (2.0 / radius - float(velocity @ velocity) / EARTH_MU)
    vector = np.cross(velocity, np.cross(position, velocity)) / EARTH_MU - position / radius
    e = float(np.linalg.norm(vector))
    return axis, e, axis * (1.0 - e) - EARTH_EQUATORIAL_RADIUS, axis * (1.0 + e) - EARTH_EQUATORIAL_RADIUS


def findings(run: RunResult, phase: str, result: PhaseResult) -> Iterator[Finding]:
    """When it was cut, how near the bodies came again, and where each of them goes."""
    recorder = result.recorder
    last = recorder.last() if len(recorder) else {}
    if "release.released" not in last:
        return
    if not last["release.released"]:
        yield Finding(phase, "released_at", "the line was cut", "not within the run")
        return
    yield Finding(phase, "released_at", "the line was cut at", last["release.time"], "s")
    back = after_the_cut(result)
    label = "nearest return of the bodies" + ("" if set(TOLD) <= set(recorder.names) else " (by the rows)")
    if back is None:
        yield Finding(phase, "return_distance", label, _without_return(last))
    else:
        yield Finding(phase, "return_distance", label, back.distance, "m")
        yield Finding(phase, "return_time", "that was at", back.after, "s")
    main = next(one.main for one in run.scene.phases if one.name == phase)
    values = {**main.asked, **main.defaults, **run.parameters.get(phase, {})}
    if "engine" in main.terms and "chaser.mass" in values:
        values["chaser.mass"] -= last.get("chaser.propellant", 0.0)
    for body in ("chaser", "target"):
        names = [f"{body}.{what}{each}" for what in ("position", "velocity") for each in EACH]
        if not set(names) <= last.keys():
            continue
        state = np.array([last[name] for name in names])
        axis, e, low, high = apsides(state[:3], state[3:])
        if not (0.0 <= e < 1.0 and axis > 0.0):
            continue
        told = "" if main.fmu is None else ", osculating"
        if "oblateness" in main.terms:
            axis, e = mean_orbit(state[:3], state[3:])
            low, high = (axis * (1.0 + side * e) - EARTH_EQUATORIAL_RADIUS for side in (-1.0, 1.0))
            told = ", in the mean"
        yield Finding(phase, f"{body}_perigee", f"{body}'s perigee at the end{told}", low, "m", shown_in="km")
        yield Finding(phase, f"{body}_apogee", f"{body}'s apogee at the end{told}", high, "m", shown_in="km")
        yield from _lifetime(phase, body, (axis, e), state, values, main.terms)


def _without_return(last: Mapping[str, float]) -> str:
    """What is told where the bodies have not come nearer again and passed: how the last row leaves them."""
    position, velocity = (
        [last.get(f"relative.{what}{each}", 0.0) for each in EACH] for what in ("position", "velocity")
    )
    closing = sum(x * v for x, v in zip(position, velocity, strict=True)) < 0.0
    return "none within the run" + (", which ends as they come nearer" if closing else "")


def _lifetime(
    phase: str,
    body: str,
    orbit: tuple[float, float],
    state: Vectors,
    values: Mapping[str, float],
    terms: Mapping[str, str],
) -> Iterator[Finding]:
    """How long it stays up in the air of the scene, as that is, with the digits that hold; nothing without air."""
    density = build.air_of(values, terms)
    ballistic = values.get("air.drag_coefficient", 0.0) * values.get(f"air.{body}_area", 0.0) / values[f"{body}.mass"]
    if density is None or not ballistic > 0.0:
        return
    normal = np.cross(state[:3], state[3:])
    time = lifetime(*orbit, ballistic, density, float(normal[2] / np.linalg.norm(normal)), LOW, LONGEST)
    label = f"{body}'s lifetime from there, in this air, about"
    if math.isinf(time):
        yield Finding(phase, f"{body}_lifetime", label, f"more than {LONGEST / YEAR:.0f} years")
    else:
        shown_in = "yr" if time > YEAR else "day"
        rounded = float(f"{time / SHOWN_IN[shown_in]:.2g}") * SHOWN_IN[shown_in]
        yield Finding(phase, f"{body}_lifetime", label, rounded, "s", shown_in=shown_in)


def returning(phase: str, result: PhaseResult, room: float) -> Iterator[str]:
    """Whether the bodies may meet after the line is cut."""
    back = after_the_cut(result)
    if back is not None and back.distance < room:
        yield (
            f"{phase}: once the line is cut the bodies may meet: their centres come within {back.distance:.3g} m, "
            f"{back.after:.6g} s after the phase began; they are taken to touch at {room:.3g} m"
        )
