"""One mass on a line that pulls: frequencies, damping, the snap of a slack line, and the longest stable step.

Closed forms for a thread of the net or a tether (a spring with a dashpot, k x + c dx/dt) by which the models are
judged, and from which the sizing takes its peaks. The damping ratio zeta is c / (2 sqrt(k m)), m the reduced mass.
"""

import math

from orbital.kernel import kernel


@kernel
def line_stiffness(young_modulus: float, diameter: float, length: float) -> float:
    """Stiffness of a solid round line [N/m].

        k = E A / L,   A = pi d^2/4

    young_modulus E                                              [Pa]
    diameter      d      of the load-bearing section             [m]
    length        L      unloaded                                [m]

    Valid    strains at which E is constant; a braid is softer by its packing
    Source   D-CoNe paper, eq. 1
    Checked  tests/orbital/test_oscillators.py; 3926.99 N/m for the tether of Table 2
    """
    return young_modulus * math.pi * diameter * diameter / (4.0 * length)


@kernel
def reduced_mass(first: float, second: float) -> float:
    """Reduced mass of two bodies joined by a line [kg].

        m_r = m1 m2 / (m1 + m2)

    first, second m1 m2                                          [kg]

    Valid    positive masses
    Source   relative motion of two bodies
    Checked  tests/orbital/test_oscillators.py; 666.667 kg for Table 2
    """
    return first * second / (first + second)


@kernel
def natural_frequency(stiffness: float, mass: float) -> float:
    """Undamped angular frequency [rad/s].

        omega = sqrt(k / m)

    stiffness     k                                              [N/m]
    mass          m      reduced mass of what moves              [kg]

    Valid    the line stays taut
    Source   harmonic oscillator
    Checked  tests/orbital/test_oscillators.py; period 2.589 s for Table 2
    """
    return math.sqrt(stiffness / mass)


@kernel
def dashpot(zeta: float, stiffness: float, mass: float) -> float:
    """Dashpot that damps by a ratio of the critical one [N s/m]: the inverse of `damping_ratio`.

        c = 2 zeta sqrt(k m)

    zeta                 damping ratio                           [-]
    stiffness     k                                              [N/m]
    mass          m      reduced mass of what moves              [kg]

    Valid    any
    Source   harmonic oscillator
    Checked  tests/orbital/test_oscillators.py
    """
    return 2.0 * zeta * math.sqrt(stiffness * mass)


def damping_ratio(damping: float, stiffness: float, mass: float) -> float:
    """Damping as a ratio of the critical one [-].

        zeta = c / (2 sqrt(k m))

    damping       c      axial dashpot                           [N s/m]
    stiffness     k                                              [N/m]
    mass          m      reduced mass of what moves              [kg]

    Valid    positive stiffness and mass
    Source   harmonic oscillator
    Checked  tests/orbital/test_oscillators.py
    """
    return damping / (2.0 * math.sqrt(stiffness * mass))


def damped_frequency(stiffness: float, mass: float, damping: float) -> float:
    """Angular frequency of the damped oscillation [rad/s].

        omega_d = omega sqrt(1 - zeta^2)

    stiffness     k                                              [N/m]
    mass          m      reduced mass of what moves              [kg]
    damping       c      axial dashpot                           [N s/m]

    Valid    zeta < 1; ValueError otherwise
    Source   harmonic oscillator
    Checked  tests/orbital/test_oscillators.py
    """
    zeta = damping_ratio(damping, stiffness, mass)
    return natural_frequency(stiffness, mass) * _root(zeta)


def logarithmic_decrement(zeta: float) -> float:
    """Logarithm of the ratio of two successive maxima [-].

        delta = 2 pi zeta / sqrt(1 - zeta^2)

    zeta                 damping ratio                           [-]

    Valid    0 <= zeta < 1; ValueError otherwise
    Source   harmonic oscillator
    Checked  tests/orbital/test_oscillators.py
    """
    return 2.0 * math.pi * zeta / _root(zeta)


def snap_peak(speed: float, stiffness: float, mass: float, preload: float = 0.0) -> float:
    """Largest tension [N] when an undamped line goes taut at a given speed.

        T = P + sqrt(P^2 + k m v^2)

    speed         v      of separation as the line goes taut     [m/s]
    stiffness     k                                              [N/m]
    mass          m      reduced mass                            [kg]
    preload       P      steady force that keeps the line apart, its static tension  [N]

    Valid    no damping, forces other than the line's constant during the snap
    Source   energy: m v^2/2 + P x = k x^2/2
    Checked  tests/orbital/test_oscillators.py
    """
    return preload + math.sqrt(preload**2 + stiffness * mass * speed**2)


def damped_snap_peak(speed: float, stiffness: float, mass: float, zeta: float) -> float:
    """Largest tension [N] when a damped line, which never pushes, goes taut at a given speed.

        T = v sqrt(k m) exp(-zeta (3 acos zeta - pi)/sqrt(1 - zeta^2))     zeta < 1/2
        T = 2 zeta v sqrt(k m) = c v                                       zeta >= 1/2

    speed         v      of separation as the line goes taut     [m/s]
    stiffness     k                                              [N/m]
    mass          m      reduced mass                            [kg]
    zeta                 damping ratio c / (2 sqrt(k m))         [-]

    The tension is -m x''; it is largest where x''' = 0, at omega_d t = 3 acos zeta - pi. From one half on that lies
    before the start, and the dashpot's first tug is the largest.

    Valid    no preload, zeta >= 0
    Source   x = v/omega_d exp(-zeta omega t) sin omega_d t; each derivative advances its phase by pi - acos zeta
    Checked  tests/orbital/test_oscillators.py
    """
    _require_positive(zeta)
    impact = speed * math.sqrt(stiffness * mass)
    if zeta >= 0.5:
        return 2.0 * zeta * impact
    return impact * math.exp(-zeta * (3.0 * math.acos(zeta) - math.pi) / _root(zeta))


def snap_duration(stiffness: float, mass: float, zeta: float) -> float:
    """Time [s] from the line's going taut to its tension's falling back to zero, without preload.

        t = 2 acos(zeta) / omega_d

    stiffness     k                                              [N/m]
    mass          m      reduced mass                            [kg]
    zeta                 damping ratio                           [-]

    Valid    0 <= zeta < 1; ValueError otherwise. Half a period, pi/omega, without damping
    Source   first zero of x'' after the start, as for `damped_snap_peak`
    Checked  tests/orbital/test_oscillators.py
    """
    root = _root(zeta)
    return 2.0 * math.acos(zeta) / (natural_frequency(stiffness, mass) * root)


def snap_restitution(zeta: float) -> float:
    """Speed of return over speed of arrival in a snap without preload [-].

        e = exp(-2 zeta acos zeta / sqrt(1 - zeta^2))

    zeta                 damping ratio                           [-]

    Valid    0 <= zeta < 1; ValueError otherwise. The line lets go when its tension vanishes, still stretched
    Source   speed at the end of `snap_duration`
    Checked  tests/orbital/test_oscillators.py
    """
    root = _root(zeta)
    return math.exp(-2.0 * zeta * math.acos(zeta) / root)


@kernel
def explicit_step_limit(stiffness_rate: float, damping_rate: float) -> float:
    """Longest step [s] at which leapfrog is stable whose dashpots see a predicted velocity.

        h = 2/(c + sqrt(c^2 + w))

    stiffness_rate w     largest eigenvalue of M^-1 K, a squared frequency           [1/s^2]
    damping_rate   c     largest eigenvalue of M^-1 C, C the matrix of the dashpots  [1/s]

    The scheme is v' = v + h a, x' = x + h v', with a at x and at the velocity v + (v - v_before)/2 predicted for it.

    Valid    exact for a dashpot in proportion to the stiffness (all modes are then alike); else taken for a bound
    Source   ours: with h^2 w + 4 h c = 4 an eigenvalue of the scheme is -1, the edge of stability
    Checked  tests/orbital/test_oscillators.py
    """
    return 2.0 / (damping_rate + math.sqrt(damping_rate * damping_rate + stiffness_rate))


def _root(zeta: float) -> float:
    """sqrt(1 - zeta^2) [-], for the ratios at which a line oscillates; ValueError for any other."""
    if not 0.0 <= zeta < 1.0:
        raise ValueError(f"the damping ratio must lie in [0, 1), but is {zeta}")
    return math.sqrt((1.0 - zeta) * (1.0 + zeta))


def _require_positive(zeta: float) -> None:
    """ValueError for a damping ratio that is negative or not a number."""
    if not zeta >= 0.0:
        raise ValueError(f"the damping ratio must not be negative, but is {zeta}")
