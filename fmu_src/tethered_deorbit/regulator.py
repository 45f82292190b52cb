"""A reel that controls tension by the whole state in the orbit's plane: length, angle and their rates."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.controlled import make_linear
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.interface import NO_VERTICAL
from fmu_src.tethered_deorbit.law import Reel
from orbital.kernel import kernel
from orbital.oscillators import natural_frequency
from orbital.vectors import Array, dot, norm


@kernel
def in_plane(state: Array) -> tuple[float, float, float]:
    """Angle of the line of centres from the local vertical [rad], its rate in the orbital frame, and that of the frame.

        phi  = atan2(y, x),   x, y = rho . r, rho . t,   t = h x r,   r = R/|R|,   h = R x V/|R x V|
        phi' = (x rho'.t - y rho'.r)/(x^2 + y^2) - n,   n = |R x V|/R^2

    state         R, V, rho, rho'  of `layout`                   (12,); its axes may turn

    Valid    R and V not parallel, rho not along h
    Source   polar coordinates in the plane of the osculating orbit of the centre of mass
    Checked  tests/tethered_deorbit/test_regulator.py
    """
    position, velocity = state[0:3], state[3:6]
    radius = norm(position)
    radial = dot(position, velocity) / radius
    across = math.sqrt(max(0.0, dot(velocity, velocity) - radial * radial))
    x, u = dot(state[6:9], position) / radius, dot(state[9:12], position) / radius
    y = (dot(state[6:9], velocity) - radial * x) / across
    v = (dot(state[9:12], velocity) - radial * u) / across
    turning = across / radius
    square = x * x + y * y
    return math.atan2(y, x), (x * v - y * u) / square - turning, turning


@kernel
def within_half_a_turn(angle: float) -> float:
    """The angle [rad] within half a turn of zero that points the same way.

    Checked  tests/tethered_deorbit/test_regulator.py
    """
    return math.atan2(math.sin(angle), math.cos(angle))


def make_regulator(interface: Interface) -> Reel:
    """A reel that controls tension, its line stiff against what it does.

        T = max(0, T_ff + T_b + k_p (l - l_c) + k_d l' + k_a (phi - phi_c) + k_r phi'),   T_ff = 3 n^2 m_r (l_c + a)

    phi is the angle of the line of centres from the local vertical, phi' its rate relative to the orbital frame. The
    rest about the vertical needs no bias T_b: whatever the thrust, its tension is the feed-forward.

    Valid    as `make_linear`; an orbit, which gives the vertical
    Source   fmu_src/tethered_deorbit/README.md, What is computed
    Checked  tests/tethered_deorbit/test_regulator.py
    """
    linear = make_linear(interface)
    angle_slot = interface.references["reel.angle"]

    @kernel
    def prepare(record: Any, value: float, rate: float, duration: float) -> int:
        """Put a commanded length in force; returns 0 or a fault. As `make_linear`, with the bias.

        value, rate   offset of the commanded length, and its rate   [m], [m/s]
        duration      for which it moves                             [s]

        Checked  tests/tethered_deorbit/test_regulator.py
        """
        r = record[0]
        if not r.state_mean_motion > 0.0:
            return blame(record, NO_VERTICAL, angle_slot, r.reel_angle)
        fault = int(linear.prepare(record, value, rate, duration))
        fastest = max(
            natural_frequency(abs(r.state_stiffness), r.state_effective_mass),
            abs(r.state_damping) / r.state_effective_mass,
        )
        r.state_frequency = max(fastest, r.state_pace)
        return fault

    @kernel
    def see(record: Any, state: Array) -> None:
        """Keep the angle from its command and its rate [rad], [rad/s].

        Checked  tests/tethered_deorbit/test_regulator.py
        """
        r = record[0]
        angle, rate, _ = in_plane(state)
        r.state_angle = within_half_a_turn(angle - r.reel_angle)
        r.state_angle_rate = rate

    @kernel
    def see_change(record: Any, state: Array, rate: Array, turned: float) -> None:
        """Keep the second derivative of the angle [rad/s^2].

            phi'' = (x w_t - y w_r - 2 (phi' + n)(x u + y v))/(x^2 + y^2) - n',   w = rho'' in inertial axes
            n'    = V'.t/|R| - 2 n R.V/R^2

        state, rate   of `layout`
        turned        1 where the axes of the rate turn at `state.turning`, 0 where they are at rest

        Checked  tests/tethered_deorbit/test_regulator.py, against differences
        """
        r = record[0]
        position, velocity = state[0:3], state[3:6]
        radius = norm(position)
        radial = dot(position, velocity) / radius
        across = math.sqrt(max(0.0, dot(velocity, velocity) - radial * radial))
        turning = across / radius
        x, u = dot(state[6:9], position) / radius, dot(state[9:12], position) / radius
        y = (dot(state[6:9], velocity) - radial * x) / across
        v = (dot(state[9:12], velocity) - radial * u) / across
        # Along r and t, what the rates have in axes that turn and what the turning adds.
        w = r.state_turning
        pull_radial, pull_across, push = 0.0, 0.0, 0.0
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            toward = position[i] / radius
            along = (velocity[i] - radial * toward) / across
            relative = rate[9 + i] + turned * (w[j] * state[9 + k] - w[k] * state[9 + j])
            pull_radial += toward * relative
            pull_across += along * relative
            push += along * (rate[3 + i] + turned * (w[j] * state[3 + k] - w[k] * state[3 + j]))
        square = x * x + y * y
        angle_rate = (x * v - y * u) / square
        change = (x * pull_across - y * pull_radial - 2.0 * angle_rate * (x * u + y * v)) / square
        r.state_angle_acceleration = change - (push - 2.0 * turning * radial) / radius

    @kernel
    def tension(record: Any, length: float, rate: float, since: float) -> float:
        """Tension before the clamp [N]: the formula of `make_regulator`.

        Checked  tests/tethered_deorbit/test_regulator.py
        """
        r = record[0]
        force: float = linear.tension(record, length, rate, since)
        force += r.reel_bias + r.reel_angle_gain * r.state_angle + r.reel_angle_rate_gain * r.state_angle_rate
        return force

    @kernel
    def tension_rate(record: Any, length: float, rate: float, acceleration: float, since: float) -> float:
        """Its time derivative [N/s]: that of the linear law, and k_a phi' + k_r phi''.

        Checked  tests/tethered_deorbit/test_regulator.py, against differences
        """
        r = record[0]
        slope: float = linear.tension_rate(record, length, rate, acceleration, since)
        slope += r.reel_angle_gain * r.state_angle_rate + r.reel_angle_rate_gain * r.state_angle_acceleration
        return slope

    @kernel
    def taut(record: Any, length: float, rate: float) -> bool:
        """Whether the law asks for a pull.

        Checked  tests/tethered_deorbit/test_regulator.py
        """
        return bool(tension(record, length, rate, 0.0) > 0.0)

    return linear._replace(
        prepare=prepare,
        taut=taut,
        tension=tension,
        tension_rate=tension_rate,
        onset=tension,
        onset_rate=tension_rate,
        see=see,
        first=0,
        see_change=see_change,
    )
