"""How a rigid body turns on without torques, in closed form: Jacobi's elliptic functions for its rate, Legendre's third
integral for its attitude.

Axes a, b, c: a the principal axis of the greatest or the least moment, that about which the momentum goes round in the
body; b the middle one; c the third.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.special import ellipj, elliprf, elliprj

from orbital.vectors import Array


def turned_freely(attitude: Array, rate: Array, inertia: Array, frame_rate: float, time: float) -> tuple[Array, Array]:
    """Attitude and body rate [rad/s] of a rigid body after a time without torques; it costs the same whatever the time.

        I w' + w x I w = 0
        w_a = +-C dn(u, m),   w_b = B sn(u, m),   w_c = A cn(u, m),   u = u0 +- p t
        psi = H t/I_a + H (1/I_c - 1/I_a) (Pi(n; u, m) - Pi(n; u0, m))/p     angle of axis a about the momentum H
        p2 = (I_a - I_b)(H2 - 2T I_c)/(I_a I_b I_c)
        m = (I_b - I_c)(2T I_a - H2)/((I_a - I_b)(H2 - 2T I_c)),   n = -I_a (I_b - I_c)/(I_c (I_a - I_b))

    attitude             q   unit quaternion, body to orbital axes, scalar first             (4,)
    rate                 w   relative to inertial space, body axes                [rad/s]    (3,)
    inertia              I   principal moments about the body axes                [kg m2]    (3,)
    frame_rate           n   at which the orbital axes turn about their third     [rad/s]
    time                 t                                                        [s]

    Valid    gravity gradient and drag left out: 3 n^2 t, 1e-5 rad/s per m of low orbit's minute, changes the rate; less
             sharp where 1 - m < 1e-10, a tumble about the middle axis that takes a dozen turns to turn over
    Source   Landau and Lifshitz, Mechanics, section 37; the integrals as Carlson's, DLMF 19.25
    Checked  tests/orbital/test_tumbling.py
    """
    begun = Rotation.from_quat(np.asarray(attitude, float), scalar_first=True)
    turned, then = _tumbled(np.array(rate, float), np.asarray(inertia, float), time)
    seen = _about_third(-frame_rate * time) * begun * turned
    return np.asarray(seen.as_quat(scalar_first=True), float), then


def _tumbled(w: Array, moments: Array, time: float) -> tuple[Rotation, Array]:
    """Rotation from the body axes then to those at first, and the rate then [rad/s]."""
    least, b, greatest = (int(axis) for axis in np.argsort(moments, kind="stable"))
    squares = moments * w * w
    excess = squares[greatest] * (moments[greatest] - moments[b]) - squares[least] * (moments[b] - moments[least])
    a, c = (greatest, least) if excess > 0.0 else (least, greatest)
    ia, ib, ic = moments[a], moments[b], moments[c]
    across = squares[b] * (ia - ib) + squares[c] * (ia - ic)
    along = squares[a] * (ia - ic) + squares[b] * (ib - ic)
    pace = math.sqrt((ia - ib) * along / (ia * ib * ic))
    steady = not any((moments[i - 2] - moments[i - 1]) * w[i - 2] * w[i - 1] for i in range(3))
    if steady or pace == 0.0 or across == 0.0:
        return Rotation.from_rotvec(w * time), w
    size_a = math.copysign(math.sqrt(along / (ia * (ia - ic))), w[a])
    size_b, size_c = math.sqrt(across / (ib * (ia - ib))), math.sqrt(across / (ic * (ia - ic)))
    m, rest = (ib - ic) * across / ((ia - ib) * along), abs((ia - ic) * excess / ((ia - ib) * along))
    n = -ia * (ib - ic) / (ic * (ia - ib))

    half, whole = 2.0 * float(elliprf(0.0, rest, 1.0)), 2.0 * _third(1.0, 0.0, rest, n)
    first = math.copysign(1.0, w[c])
    sn, cn, dn = first * w[b] / size_b, first * w[c] / size_c, w[a] / size_a
    since, before = sn * float(elliprf(cn * cn, dn * dn, 1.0)), _third(sn, cn * cn, dn * dn, n)
    handed = np.linalg.det(np.eye(3)[[c, b, a]])
    sense = math.copysign(1.0, handed * size_a * (ia - ic))
    now = since + sense * pace * time
    left = math.remainder(now, half)
    halves = round((now - left) / half)
    sn, cn, dn, _ = (float(value) for value in ellipj(left, min(m, 1.0)))
    swept = _third(sn, cn * cn, dn * dn, n) - before + (halves * whole if halves else 0.0)

    sign = first * (-1.0) ** halves
    then = np.empty(3)
    then[[a, b, c]] = size_a * dn, sign * size_b * sn, sign * size_c * cn
    momentum = float(np.linalg.norm(moments * w))
    psi = momentum * time / ia + sense * momentum * (1.0 / ic - 1.0 / ia) / pace * swept
    return _seen(moments * w, a).inv() * _about_third(psi) * _seen(moments * then, a), then


def _third(sn: float, cn2: float, dn2: float, n: float) -> float:
    """Legendre's integral Pi(n; u, m) up to a quarter of a period, of the elliptic functions of u."""
    more = n / 3.0 * sn**3 * float(elliprj(cn2, dn2, 1.0, 1.0 - n * sn * sn)) if n else 0.0
    return sn * float(elliprf(cn2, dn2, 1.0)) + more


def _seen(momentum: Array, a: int) -> Rotation:
    """From body axes to those of the momentum: in its plane with body axis a, across it, along the momentum."""
    along = momentum / np.linalg.norm(momentum)
    rest = np.delete(along, a)
    towards = -along[a] * along
    towards[a] = rest @ rest
    towards /= np.linalg.norm(towards)
    return Rotation.from_matrix(np.array([towards, np.cross(along, towards), along]))


def _about_third(angle: float) -> Rotation:
    return Rotation.from_rotvec([0.0, 0.0, angle])
