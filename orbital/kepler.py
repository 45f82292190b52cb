"""Motion along a Kepler orbit: elements to state and back, and the state after any time in closed form.

Propagation by universal variables is what numerical orbits are judged by, on every kind of conic alike.
"""

import math
from typing import NamedTuple

import numpy as np

from orbital.kernel import kernel
from orbital.vectors import Array, dot, norm

# Below this eccentricity, or sine of the inclination, periapsis or node drown in the rounding of a state in doubles.
UNDEFINED_BELOW = 1.0e-12

# Laguerre's method settles in under ten iterations; more means that the arguments are not those of an orbit.
ITERATION_LIMIT = 50


class Elements(NamedTuple):
    """Classical orbital elements; the order is that of the arguments of `elements_to_state`.

    semi_major_axis        a      negative on a hyperbola                       [m]
    eccentricity           e      0 for a circle                                [-]
    inclination            i      0 to pi, from the reference plane             [rad]
    ascending_node         raan   0 to 2 pi; 0 by definition on an equatorial orbit  [rad]
    periapsis_argument     argp   0 to 2 pi; 0 by definition on a circular orbit     [rad]
    true_anomaly           nu     0 to 2 pi; from the node on a circular orbit  [rad]
    """

    semi_major_axis: float
    eccentricity: float
    inclination: float
    ascending_node: float
    periapsis_argument: float
    true_anomaly: float


@kernel
def elements_to_state(
    position_out: Array,
    velocity_out: Array,
    semi_major_axis: float,
    eccentricity: float,
    inclination: float,
    ascending_node: float,
    periapsis_argument: float,
    true_anomaly: float,
    mu: float,
) -> None:
    """Inertial position [m] and velocity [m/s] of a body on the given orbit.

        p = a (1 - e^2),   r = p / (1 + e cos nu),   u = argp + nu
        position = r (N cos u + M sin u)
        velocity = sqrt(mu/p) (-N (sin u + e sin argp) + M (cos u + e cos argp))
        N = towards the node,   M = a quarter turn ahead of it in the orbit

    semi_major_axis        a      negative on a hyperbola        [m]
    eccentricity           e                                     [-]
    inclination            i                                     [rad]
    ascending_node         raan                                  [rad]
    periapsis_argument     argp                                  [rad]
    true_anomaly           nu                                    [rad]
    mu                     mu     gravitational parameter        [m^3/s^2]

    Valid    e != 1; circular and equatorial orbits included, where only argp + nu, or raan + argp + nu, counts
    Source   Vallado, Fundamentals of astrodynamics and applications (2013), algorithm 10, in the basis of the node
    Checked  tests/orbital/test_kepler.py
    """
    latus = semi_major_axis * (1.0 - eccentricity * eccentricity)
    radius = latus / (1.0 + eccentricity * math.cos(true_anomaly))
    speed = math.sqrt(mu / latus)
    latitude = periapsis_argument + true_anomaly
    along_n = -speed * (math.sin(latitude) + eccentricity * math.sin(periapsis_argument))
    along_m = speed * (math.cos(latitude) + eccentricity * math.cos(periapsis_argument))
    n0 = math.cos(ascending_node)
    n1 = math.sin(ascending_node)
    m0 = -n1 * math.cos(inclination)
    m1 = n0 * math.cos(inclination)
    m2 = math.sin(inclination)
    cosine = radius * math.cos(latitude)
    sine = radius * math.sin(latitude)
    position_out[0] = cosine * n0 + sine * m0
    position_out[1] = cosine * n1 + sine * m1
    position_out[2] = sine * m2
    velocity_out[0] = along_n * n0 + along_m * m0
    velocity_out[1] = along_n * n1 + along_m * m1
    velocity_out[2] = along_m * m2


def state_to_elements(position: Array, velocity: Array, mu: float) -> Elements:
    """Orbital elements of an inertial state.

        e cos nu = h^2/(mu r) - 1,   e sin nu = h (r . v)/(mu r),   u from the node,   argp = u - nu

    position      r      from the centre of attraction           [m]        (3,)
    velocity      v      inertial                                [m/s]      (3,)
    mu            mu     gravitational parameter                 [m^3/s^2]

    The conventions for circular and equatorial orbits stand in `Elements`.

    Valid    r and v not parallel, not a parabola; ValueError otherwise
    Source   Vallado (2013), algorithm 9, with arc tangents in place of arc cosines
    Checked  tests/orbital/test_kepler.py
    """
    momentum = np.cross(position, velocity)
    h = float(np.linalg.norm(momentum))
    r = float(np.linalg.norm(position))
    if not (math.isfinite(h) and h > 0.0):
        raise ValueError(f"no orbital plane: position {position} m, velocity {velocity} m/s parallel or not finite")
    inverse_axis = 2.0 / r - float(np.dot(velocity, velocity)) / mu
    if inverse_axis == 0.0:
        raise ValueError("a parabola has no semi-major axis")

    across = math.hypot(momentum[0], momentum[1])
    equatorial = across < UNDEFINED_BELOW * h
    node = 0.0 if equatorial else math.atan2(momentum[0], -momentum[1])
    towards_node = np.array([math.cos(node), math.sin(node), 0.0])
    ahead_of_node = np.cross(momentum / h, towards_node)
    latitude = math.atan2(float(np.dot(position, ahead_of_node)), float(np.dot(position, towards_node)))

    e_cos = h * h / (mu * r) - 1.0
    e_sin = h * float(np.dot(position, velocity)) / (mu * r)
    eccentricity = math.hypot(e_cos, e_sin)
    circular = eccentricity < UNDEFINED_BELOW
    anomaly = latitude if circular else math.atan2(e_sin, e_cos)
    return Elements(
        semi_major_axis=1.0 / inverse_axis,
        eccentricity=eccentricity,
        inclination=math.atan2(across, momentum[2]),
        ascending_node=node % (2.0 * math.pi),
        periapsis_argument=(latitude - anomaly) % (2.0 * math.pi),
        true_anomaly=anomaly % (2.0 * math.pi),
    )


@kernel
def stumpff(z: float) -> tuple[float, float]:
    """The two Stumpff functions c2 and c3 [-].

        c2(z) = (1 - cos sqrt z)/z,   c3(z) = (sqrt z - sin sqrt z)/sqrt(z)^3     (cosh and sinh for z < 0)

    z             alpha chi^2, the square of the eccentric anomaly passed  [rad^2]

    Valid    z above -5e5, where cosh overflows; within |z| < 1 the power series, to rounding
    Source   Battin (1999), section 4.5
    Checked  tests/orbital/test_kepler.py
    """
    if math.fabs(z) < 1.0:
        c2 = 0.0
        c3 = 0.0
        term = 0.5
        for k in range(2, 22, 2):
            c2 += term
            c3 += term / (k + 1)
            term *= -z / ((k + 1) * (k + 2))
        return c2, c3
    if z > 0.0:
        root = math.sqrt(z)
        half = math.sin(0.5 * root)
        return 2.0 * half * half / z, (root - math.sin(root)) / (z * root)
    root = math.sqrt(-z)
    half = math.sinh(0.5 * root)
    return -2.0 * half * half / z, (root - math.sinh(root)) / (z * root)


@kernel
def propagate(
    position_out: Array, velocity_out: Array, position: Array, velocity: Array, duration: float, mu: float
) -> int:
    """Status: 0 when position_out [m] and velocity_out [m/s] are the state after `duration`, 1 when there is none.

        sqrt(mu) t = s chi^2 c2 + (1 - alpha r) chi^3 c3 + r chi
        s = r . v/sqrt(mu),   alpha = 1/a,   z = alpha chi^2
        f = 1 - chi^2 c2/r,   g = t - chi^3 c3/sqrt(mu),   position_out = f r + g v,   and their rates

    position      r      from the centre of attraction           [m]        (3,)
    velocity      v      inertial                                [m/s]      (3,)
    duration      t      either sign; whole periods are taken off first  [s]
    mu            mu     gravitational parameter                 [m^3/s^2]

    The outputs must not be the inputs. With status 1 they are left as they were.

    Valid    ellipse, parabola and hyperbola; after N periods the rounding of the period is multiplied by N
    Source   Battin (1999), section 4.5; solved by Laguerre's method as in Conway, Celestial Mechanics 39 (1986) 199
    Checked  tests/orbital/test_kepler.py
    """
    radius = norm(position)
    root_mu = math.sqrt(mu)
    sigma = dot(position, velocity) / root_mu
    alpha = 2.0 / radius - dot(velocity, velocity) / mu
    time = duration
    if alpha > 0.0:
        period = 2.0 * math.pi / (root_mu * alpha * math.sqrt(alpha))
        time = math.copysign(math.fabs(duration) % period, duration)
        chi = root_mu * time * alpha
    else:
        chi = root_mu * time / radius
        # On a hyperbola chi grows with the logarithm of the time: the linear guess would overflow the hyperbolic sine.
        if alpha * chi * chi < -1.0:
            chi = math.copysign(math.asinh(math.sqrt(-alpha) * math.fabs(chi)) / math.sqrt(-alpha), time)

    step = 0.0
    for _ in range(ITERATION_LIMIT):
        c2, c3 = stumpff(alpha * chi * chi)
        u2 = chi * chi * c2
        u3 = chi * chi * chi * c3
        # The residual and its first two derivatives; the first is the distance reached.
        residual = sigma * u2 + (1.0 - alpha * radius) * u3 + radius * chi - root_mu * time
        slope = radius * (1.0 - alpha * u2) + sigma * (chi - alpha * u3) + u2
        curvature = sigma * (1.0 - alpha * u2) + (1.0 - alpha * radius) * (chi - alpha * u3)
        root = math.sqrt(math.fabs(16.0 * slope * slope - 20.0 * residual * curvature))
        step = 5.0 * residual / (slope + math.copysign(root, slope))
        chi -= step
        if math.fabs(step) <= 1.0e-15 * math.fabs(chi):
            break
    # Written so that a NaN fails it too.
    if not math.fabs(step) <= 1.0e-9 * math.fabs(chi):
        return 1

    c2, c3 = stumpff(alpha * chi * chi)
    u2 = chi * chi * c2
    u3 = chi * chi * chi * c3
    f = 1.0 - u2 / radius
    g = time - u3 / root_mu
    position_out[0] = f * position[0] + g * velocity[0]
    position_out[1] = f * position[1] + g * velocity[1]
    position_out[2] = f * position[2] + g * velocity[2]
    reached = norm(position_out)
    f_rate = root_mu / (reached * radius) * (alpha * u3 - chi)
    g_rate = 1.0 - u2 / reached
    velocity_out[0] = f_rate * position[0] + g_rate * velocity[0]
    velocity_out[1] = f_rate * position[1] + g_rate * velocity[1]
    velocity_out[2] = f_rate * position[2] + g_rate * velocity[2]
    return 0
