"""Gains of a reel, designed for the pair that a scene describes; and what a loop with given gains comes to.

The plant is the planar dumbbell of `orbital.dumbbell`, linearised about one of its rests, in units of the commanded
length between the centres of mass and of 1/n. Its state is x = (l, l', phi, phi'), its input the tension u in
m_r l n^2, and the reel answers u = -K x. A winch sets l'' instead, in l n^2, constant over a sample.

Checked  tests/tethered_deorbit/test_design.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.linalg import expm

from fmu_src.implied import Implied
from fmu_src.interface import Undesigned
from fmu_src.tethered_deorbit.asked import EFFORT_WEIGHT, GAINS, LQR, RESTS, TOWING, WEIGHTS
from fmu_src.tethered_deorbit.powered import most_thrust
from orbital import dumbbell
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.dumbbell import Matrix, Pair
from orbital.plain import mean_motion

Values = Mapping[str, float]
Poles = npt.NDArray[np.complex128]
LEAST_SHARE = 1e-6
"""Share of the gains below which a crossing is rounding: at none at all the plant's own poles stand on the edge."""


class Plant(NamedTuple):
    """A pair at a rest, for small motion about it.

    matrix, drive   A, B in units of `length` and 1/n
    pair            its rate, mass and thrust
    length          of the line of centres                       [m]
    angle           of the rest                                  [rad]
    tension         that keeps it                                [N]
    """

    matrix: Matrix
    drive: Matrix
    pair: Pair
    length: float
    angle: float
    tension: float


def pair_of(values: Values, terms: Mapping[str, str]) -> Pair | None:
    """The pair of a scene, with the thrust that an electric engine has the power for; None without an orbit."""
    if "orbit.altitude" not in values:
        return None
    chaser, target = values["chaser.mass"], values["target.mass"]
    most = most_thrust(values, terms)
    push = -max(-most, min(most, values.get("thrust.level", 0.0) + values.get("thrust.offset", 0.0))) / chaser
    along = terms.get("thrust") == "tether"
    rate = mean_motion(EARTH_EQUATORIAL_RADIUS + values["orbit.altitude"], EARTH_MU)
    reduced = chaser * target / (chaser + target)
    return Pair(rate, reduced, 0.0 if along else push, push if along else 0.0)


def length_of(values: Values) -> float:
    """Length of the line of centres that is commanded [m]."""
    return values["reel.length"] + values["reel.length_offset"] + values.get("target.attachment_distance", 0.0)


def plant_at(pair: Pair, length: float, angle: float) -> Plant:
    """The plant about a rest, in units of its length and 1/n."""
    matrix, drive = dumbbell.linearised(pair, length, angle)
    n = pair.rate
    size = np.array([length, length * n, 1.0, n])
    matrix = matrix * size[None, :] / size[:, None] / n
    drive = drive * (pair.mass * length * n * n) / size[:, None] / n
    return Plant(matrix, drive, pair, length, angle, dumbbell.rest_tension(pair, length, angle))


GAIN_NAMES = {
    "regulator": ("reel.proportional_gain", "reel.derivative_gain", "reel.angle_gain", "reel.angle_rate_gain"),
    "linear": ("reel.proportional_gain", "reel.derivative_gain"),
    "sampled_linear": (
        "reel.winding_length_gain",
        "reel.winding_rate_gain",
        "reel.winding_angle_gain",
        "reel.winding_angle_rate_gain",
    ),
}
"""Gains of each law that is linear, on the states in their order."""


def units(plant: Plant, law: str) -> Matrix:
    """What K is to be multiplied with for the gains of a law, one for each state: those of a tension [N], which falls
    with u, or of an acceleration [m/s^2].

    Source   u = T/(m_r l n^2), or u = a/(l n^2)
    """
    n, length = plant.pair.rate, plant.length
    effort = length * n * n * (1.0 if law == "sampled_linear" else -plant.pair.mass)
    return effort / np.array([length, length * n, 1.0, n])


def acted(plant: Plant, law: str, step: float | None) -> tuple[Matrix, Matrix]:
    """A, B of the plant by what a law sets, in its units: the tension, or of a winch its acceleration.

    step    over which that is held [s]; A, B are then those from one sample to the next
    """
    if law != "sampled_linear":
        return plant.matrix, plant.drive
    matrix, drive = dumbbell.driven(plant.matrix)
    if step is None:
        return matrix, drive
    # exp of [[A, B], [0, 0]] h holds both
    whole = expm(np.block([[matrix, drive], [np.zeros((1, 5))]]) * step * plant.pair.rate)
    return whole[:4, :4], whole[:4, 4:]


def designed(values: Values, asked: Values, terms: Mapping[str, str]) -> dict[str, float]:
    """Values of the gains, of the angle they are about, and of the bias; none where they are given.

    values   every parameter and input by FMI name, SI
    asked    rows of the term that only the scene knows

    Source   `control.lqr` and `control.place` of python-control
    Checked  tests/tethered_deorbit/test_design.py: gains of Table 2's pair
    """
    method, about = int(asked["reel.gains"]), int(asked["reel.about"])
    if not method:
        return {}
    law = terms["reel"]
    plant = _plant_asked(values, terms, about, method)
    step = values.get("reel.sample_time")
    gain = design(*acted(plant, law, step), asked, None if step is None else step * plant.pair.rate)
    numbers = (gain[0] * units(plant, law)).tolist()
    found = dict(zip(GAIN_NAMES[law], numbers, strict=True)) | {"reel.angle": plant.angle}
    if law == "regulator":
        tide = 3.0 * plant.pair.rate**2 * plant.pair.mass * plant.length
        found["reel.bias"] = plant.tension - tide
    return found


def _plant_asked(values: Values, terms: Mapping[str, str], about: int, method: int) -> Plant:
    """The plant at the rest that is named, or `Undesigned`."""
    pair = pair_of(values, terms)
    if pair is None:
        raise Undesigned("reel.gains", GAINS[method], "needs an orbit: without one there is no rest to design about")
    length = length_of(values)
    if about == TOWING:
        if pair.across == 0.0:
            raise Undesigned(
                "reel.about", RESTS[about], "needs a thrust along the track, which keeps the line taut there"
            )
        return plant_at(pair, length, dumbbell.towing_angle(pair))
    angle = dumbbell.hanging_angle(pair, length)
    if angle is None:
        raise Undesigned(
            "reel.about",
            RESTS[about],
            f"the thrust is above 3 n^2 l m_c = {3.0 * pair.rate**2 * length * values['chaser.mass']:.4g} N, and the "
            f'pair rests along the track only; expected "{RESTS[TOWING]}"',
        )
    return plant_at(pair, length, angle)


def design(matrix: Matrix, drive: Matrix, asked: Values, step: float | None) -> Matrix:
    """K of u = -K x for a plant, as asked.

    step    of a sampled law, in 1/n: A and B are those of a sample, and poles are asked as of a continuous one
    """
    import control

    states = len(matrix)
    names = [name for name, _ in WEIGHTS]
    if int(asked["reel.gains"]) == LQR:
        weights = np.diag([asked[name] for name in names])
        effort = np.array([[asked[EFFORT_WEIGHT]]])
        regulator = control.lqr if step is None else control.dlqr
        try:
            gain, _, poles = regulator(matrix, drive, weights, effort)
        except (ValueError, np.linalg.LinAlgError, control.ControlException) as error:
            raise Undesigned("reel.gains", "lqr", f"no regulator has these weights: {error}") from None
        if not np.all(np.isfinite(gain)):
            raise Undesigned("reel.gains", "lqr", f"no regulator has these weights: poles {poles}")
        return np.asarray(gain, float)
    wanted = _poles(asked, states)
    if step is not None:
        wanted = np.exp(wanted * step)
    apart = all(np.sum(np.isclose(wanted, pole, rtol=1e-9)) == 1 for pole in wanted)
    # `place` wants them apart, and `acker` answers with a row
    return np.asarray((control.place if apart else control.acker)(matrix, drive, wanted), float).reshape(1, -1)


def _poles(asked: Values, states: int) -> Poles:
    """The poles that are asked for, in n."""
    wanted = np.array(
        [complex(asked[f"reel.poles[{k}]"], asked[f"reel.poles_imaginary[{k}]"]) for k in range(1, states + 1)]
    )
    # in the order of their real parts, and of their imaginary parts' size
    ordered = sorted(wanted, key=lambda pole: (pole.real, abs(pole.imag), pole.imag))
    mirrored = sorted(wanted.conj(), key=lambda pole: (pole.real, abs(pole.imag), pole.imag))
    if not np.allclose(ordered, mirrored, rtol=1e-12, atol=0.0):
        shown = ", ".join(f"{pole.imag:g}" for pole in wanted)
        raise Undesigned(
            "reel.poles_imaginary", f"[{shown}]", "a pole with an imaginary part needs its conjugate beside it"
        )
    return wanted


class Loop(NamedTuple):
    """A closed loop of a reel.

    plant     what it acts on
    gain      K of u = -K x
    step      of a sampled law [s], None for one that acts at any time
    matrix, drive   A, B in the units of the plant; of a sampled law those of an input held over a step
    """

    plant: Plant
    gain: Matrix
    step: float | None
    matrix: Matrix
    drive: Matrix

    def poles(self) -> Poles:
        """Poles of the closed loop [1/s]; of a sampled law those of the continuous one that decays alike, log(z)/h."""
        found = np.linalg.eigvals(self.matrix - self.drive @ self.gain).astype(complex)
        rates = found * self.plant.pair.rate if self.step is None else np.log(found) / self.step
        return np.array(sorted(rates, key=lambda pole: (-pole.real, -pole.imag)))

    def slowest(self) -> float:
        """Largest real part of a pole [1/s]: negative where all motion dies out."""
        return float(np.max(self.poles().real))


def loop_of(values: Values, terms: Mapping[str, str]) -> Loop | None:
    """The loop of a reel with a linear law, about the rest that its angle names; None where there is none."""
    law = terms.get("reel", "")
    pair = pair_of(values, terms) if law in GAIN_NAMES else None
    if pair is None:
        return None
    length = length_of(values)
    rests = [dumbbell.hanging_angle(pair, length), dumbbell.towing_angle(pair) if pair.across else None]
    there = [angle for angle in rests if angle is not None]
    about = values.get("reel.angle", 0.0)
    plant = plant_at(pair, length, min(there, key=lambda angle: abs(angle - about)))
    told = [values.get(name, 0.0) for name in GAIN_NAMES[law]]
    gain = np.array([told + [0.0] * (4 - len(told))]) / units(plant, law)
    step = values.get("reel.sample_time")
    return Loop(plant, gain, step, *acted(plant, law, step))


def rows(values: Values, terms: Mapping[str, str]) -> Iterator[Implied]:
    """The rest, gains, poles and margins of a reel's loop.

    Source   `control.stability_margins` of K (sI - A)^-1 B, the loop cut at the plant's input; of a sampled law with z
    Checked  tests/tethered_deorbit/test_design.py, against the Nyquist curve by numpy
    """
    loop = loop_of(values, terms)
    if loop is None:
        return
    plant = loop.plant
    yield Implied("reel.rest_angle", "rest of the reel's loop: angle from the vertical", plant.angle, "rad")
    yield Implied("reel.rest_tension", "rest of the reel's loop: tension", plant.tension, "N")
    for number, gain in enumerate(loop.gain[0].tolist(), 1):
        yield Implied(f"reel.gain[{number}]", f"gain {number} of the reel's loop, lengths in l, times in 1/n", gain, "")
    for number, pole in enumerate(loop.poles().tolist(), 1):
        yield Implied(f"reel.pole[{number}]", f"pole {number} of the reel's loop, real part", pole.real, "1/s")
        if pole.imag != 0.0:
            yield Implied(f"reel.pole_imaginary[{number}]", f"pole {number}, imaginary part", pole.imag, "1/s")
    yield from _margins(loop)


def _margins(loop: Loop) -> Iterator[Implied]:
    """By how much all gains may rise or fall, and the phase lag, before the loop is no longer stable."""
    if not loop.slowest() < 0.0:
        return
    import control

    matrix, drive, gain, through = loop.matrix, loop.drive, loop.gain, np.zeros((1, 1))
    if loop.step is not None:
        # z = (1 + w h/2)/(1 - w h/2) has the same curve of Nyquist; near the unit circle the margins of z lose digits
        step = loop.step * loop.plant.pair.rate
        inverse = np.linalg.inv(matrix + np.eye(4))
        through = -gain @ inverse @ drive
        matrix, drive, gain = (
            2.0 / step * inverse @ (matrix - np.eye(4)),
            2.0 / math.sqrt(step) * inverse @ drive,
            2.0 / math.sqrt(step) * gain @ inverse,
        )
    factors, phases, *_ = control.stability_margins(control.ss(matrix, drive, gain, through), returnall=True)
    edge = float(through[0, 0])
    crossings = [float(factor) for factor in factors] + ([-1.0 / edge] if edge < 0.0 else [])
    more = [factor for factor in crossings if factor > 1.0]
    less = [factor for factor in crossings if LEAST_SHARE < factor < 1.0]
    if more:
        yield Implied("reel.gain_margin", "gain margin: the gains may rise by a factor", min(more), "")
    if less:
        yield Implied("reel.gain_reduction", "the gains may fall to a share", max(less), "")
    if len(phases):
        least = min(math.radians(abs(float(phase))) for phase in phases)
        yield Implied("reel.phase_margin", "phase margin of the reel's loop", least, "rad")
