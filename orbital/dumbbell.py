"""Two points on a line whose length changes, in the plane of a circular orbit: what a reel acts on, and its rests.

The line has the length l and the angle phi from the local vertical, towards along-track; both are those of the target
as seen from the chaser. What a thruster gives the target relative to the chaser is q along-track and p along the line:
-F/m_c of a thrust F on the chaser alone.

    l''   = l (phi'^2 + 2 n phi' + 3 n^2 cos^2 phi) + q sin phi + p - T/m_r
    phi'' = -2 (phi' + n) l'/l - 3 n^2 sin phi cos phi + (q/l) cos phi

Valid    lengths small against the orbit's radius
Source   Hill's equations in polar coordinates; `orbital.references` is the same at a constant length
Checked  tests/orbital/test_dumbbell.py
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Matrix = npt.NDArray[np.float64]


class Pair(NamedTuple):
    """What a reel acts on.

    rate          n      mean motion of the orbit                [rad/s]
    mass          m_r    reduced mass of the pair                [kg]
    across        q      along-track                             [m/s^2]
    along         p      along the line                          [m/s^2]
    """

    rate: float
    mass: float
    across: float = 0.0
    along: float = 0.0


def accelerations(
    pair: Pair, length: float, length_rate: float, angle: float, angle_rate: float, tension: float
) -> tuple[float, float]:
    """Second derivatives of length [m/s^2] and angle [rad/s^2]: the formulas of this module.

    length        l      of the line                             [m]
    length_rate   l'                                             [m/s]
    angle         phi    from the local vertical                 [rad]
    angle_rate    phi'   relative to the orbital frame           [rad/s]
    tension       T                                              [N]

    Valid    as this module
    Source   as this module
    Checked  tests/orbital/test_dumbbell.py, against Hill's equations in Cartesian coordinates
    """
    n, sine, cosine = pair.rate, math.sin(angle), math.cos(angle)
    outward = length * (angle_rate * (angle_rate + 2.0 * n) + 3.0 * n * n * cosine * cosine)
    outward += pair.across * sine + pair.along - tension / pair.mass
    turning = -2.0 * (angle_rate + n) * length_rate / length - 3.0 * n * n * sine * cosine
    return outward, turning + pair.across * cosine / length


def hanging_angle(pair: Pair, length: float) -> float | None:
    """Angle [rad] of the rest near the vertical, the target above the chaser; None where the thrust is too strong.

        sin phi = q / (3 n^2 l)

    length        l                                              [m]

    Valid    |q| < 3 n^2 l; stable at a constant length
    Source   phi'' = 0
    Checked  tests/orbital/test_dumbbell.py; 7.4045 deg for Table 2
    """
    sine = pair.across / (3.0 * pair.rate**2 * length)
    return math.asin(sine) if abs(sine) < 1.0 else None


def towing_angle(pair: Pair) -> float:
    """Angle [rad] of the rest along the track: the target trails what the chaser is pushed away from.

        phi = 90 deg where q > 0, -90 deg where q < 0

    Valid    at a constant length stable only if |q| > 3 n^2 l; a reel may hold it below that
    Source   phi'' = 0
    Checked  tests/orbital/test_dumbbell.py
    """
    return math.copysign(0.5 * math.pi, pair.across)


def rest_tension(pair: Pair, length: float, angle: float) -> float:
    """Tension [N] that keeps the length at a rest.

        T = m_r (3 n^2 l cos^2 phi + q sin phi + p)

    length        l                                              [m]
    angle         phi    of the rest                             [rad]

    Valid    at a rest
    Source   l'' = 0
    Checked  tests/orbital/test_dumbbell.py
    """
    return pair.mass * accelerations(pair, length, 0.0, angle, 0.0, 0.0)[0]


def linearised(pair: Pair, length: float, angle: float) -> tuple[Matrix, Matrix]:
    """Matrices A (4, 4), B (4, 1) of small motion about a rest, for the state (l, l', phi, phi') and the tension [N].

        l''   = 3 n^2 cos^2 phi dl + (q cos phi - 3 n^2 l sin 2 phi) dphi + 2 n l phi' - dT/m_r
        phi'' = -(q/l^2) cos phi dl - (2 n/l) l' - (3 n^2 cos 2 phi + (q/l) sin phi) dphi

    length        l                                              [m]
    angle         phi    of the rest                             [rad]

    Valid    small motion about a rest
    Source   derivatives of `accelerations`
    Checked  tests/orbital/test_dumbbell.py, against differences
    """
    n, q, sine, cosine = pair.rate, pair.across, math.sin(angle), math.cos(angle)
    tide = 3.0 * n * n
    plant = np.zeros((4, 4))
    plant[0, 1] = plant[2, 3] = 1.0
    plant[1, 0] = tide * cosine * cosine
    plant[1, 2] = q * cosine - 2.0 * tide * length * sine * cosine
    plant[1, 3] = 2.0 * n * length
    plant[3, 0] = -q * cosine / length**2
    plant[3, 1] = -2.0 * n / length
    plant[3, 2] = -tide * (cosine * cosine - sine * sine) - q * sine / length
    return plant, np.array([[0.0], [-1.0 / pair.mass], [0.0], [0.0]])


def driven(plant: Matrix) -> tuple[Matrix, Matrix]:
    """Matrices A (4, 4), B (4, 1) for the state (l, l', phi, phi') of a taut line that a winch drives, u = l'' [m/s^2].

    plant         A of `linearised`                              (4, 4)

    Valid    a line so stiff that it is as long as what is wound out
    Source   the row of l'' in `linearised` is replaced: what the tension is, the winch does not mind
    Checked  tests/orbital/test_dumbbell.py
    """
    matrix = plant.copy()
    matrix[1] = 0.0
    return matrix, np.array([[0.0], [1.0], [0.0], [0.0]])
