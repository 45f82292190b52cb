"""Many revolutions of a dumbbell at once: a spiral of the orbit, and a swing that keeps its action.

Between two communication points at least `REVOLUTIONS` revolutions apart a pair whose vibration has died and that
cannot go slack is carried over, from its state at one to its state at the other. Under a thrust f = F/M along the track
of a nearly circular orbit, its speed v = sqrt(mu/a),

    dv/dt = -f    dlambda/dt = n = v^3/mu    e = e_c + (2 f/(v n)) (sin u, -cos u)    e_c goes as v^(3/2)

lambda the mean longitude, u the true one, e the vector of the eccentricity; and of the swing, see `libration`, the
action stays while its angle goes on by 2 pi dt/P. Rate, period and mean tension are summed over the leap by Simpson's
rule, the leap being short enough that n changes by `CHANGE` at most.

What is given up, and told as `level.average_error`: what the eccentricity does to the swing,

    phi'' = ... + e n^2 (2 sin u - (9/2) cos u sin 2 phi)

which forces it once a revolution to d = (2 + (9/2) sin 2 phi) e/|(2 pi/(P n))^2 - 1| at most; a leap begins and ends
anywhere in that, a tension changes by up to 1.4 of a swing's angle, and as much again is left to what the swing's own
time does meanwhile: 6 d. And what swings across the plane, by the square of its angle. Where that exceeds
`level.average_tolerance`, where a swing comes to take as long as a revolution, where the tension comes near zero within
a swing, where an end is within the leap, or a tank runs dry in it, there is no leap.

Source   Gauss's equations for a thrust along the track of a circle; `libration`
Checked  tests/tethered_deorbit/test_averaged.py
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fmu_src.tethered_deorbit.layout import StateLayout
from fmu_src.tethered_deorbit.level import Level
from fmu_src.tethered_deorbit.levels.counted import AVERAGED, DUMBBELL
from fmu_src.tethered_deorbit.levels.libration import (
    ACTION,
    LARGEST,
    LEAST,
    MEAN,
    MIDDLE,
    PERIOD,
    UPRIGHT,
    WIDTH,
    along_swing,
    energy_of,
    place_of,
    potential,
    swing,
)
from fmu_src.tethered_deorbit.optional_rows import REVOLUTIONS
from fmu_src.tethered_deorbit.outputs import note_pull
from orbital.constants import EARTH_MU, STANDARD_GRAVITY
from orbital.kernel import kernel
from orbital.vectors import Array, cross, dot, norm

CHANGE = 0.02
"""Share by which the orbit's rate changes in a leap at most."""
FORCED = 6.0
"""By how much a leap may err, over what is forced: see above."""
MARGIN = 0.1
"""Least tension within a swing over its mean, below which a tug is taken to be near."""


def make_leap(derivative: Callable[..., Any], engine: bool, layout: StateLayout) -> Callable[..., Any]:
    """The kernel `leap(record, state, rate, now, target) -> time` for a thrust along the track or none.

    derivative    of `equations`, the axes at rest
    engine        whether the masses fall

    Checked  tests/tethered_deorbit/test_averaged.py
    """
    impulse, spent = layout.impulse, layout.spent

    @kernel
    def swing_at(record: Any, share: float, flow: float, force: float, span: float, place: int) -> bool:
        """Orbit and swing at a share of the leap, written to the row `place` of `state.leap`; false where it would not
        swing.

        share         of the leap                                [-]
        flow, force   M' of the pair's mass, lost, and thrust along the track   [kg/s], [N]
        span          of the leap                                [s]

        Checked  tests/tethered_deorbit/test_averaged.py
        """
        r = record[0]
        row, out, waves = r.state_leap[place], r.state_swing, r.state_waves
        time = share * span
        mass, length = r.state_total_mass - flow * time, row[7]
        gained = force * time / r.state_total_mass
        if flow > 0.0:
            gained = force / flow * math.log(r.state_total_mass / mass)
        speed = row[8] - gained
        rate = speed * speed * speed / EARTH_MU
        chaser = mass - r.target_mass
        push = -row[9] * force / (chaser * length)
        slowing = -3.0 * rate * force / (mass * speed)
        row[0], row[1], row[2], row[3] = speed, rate, push, slowing
        if place > 0:
            guess = row[4] * rate / r.state_leap[0, 1]
            row[4] = energy_of(out, waves, row[5], guess, length, rate, push, slowing)
            if not row[4] < math.inf:
                return False
        if not swing(out, waves, row[4], length, rate, push, slowing, place != 1):
            return False
        reduced = chaser * r.target_mass / mass
        row[6] = reduced
        return bool(out[LEAST] > MARGIN * out[MEAN])

    @kernel
    def leap(record: Any, state: Array, rate: Array, now: float, target: float) -> float:
        """Carry the state over from one time to another one at most as late; returns that [s], or the first where
        there is no leap.

        state         of `layout`, inertial; written where there is one
        rate          room for its rate

        Checked  tests/tethered_deorbit/test_averaged.py
        """
        r = record[0]
        if r.state_level_now != DUMBBELL or now < r.state_next_leap or not norm(state[6:9]) > 0.0:
            return now
        r.state_next_leap = target
        center, velocity, rho, moving = state[0:3], state[3:6], state[6:9], state[9:12]
        radial, along, normal, ahead = r.state_vector[0], r.state_vector[1], r.state_vector[2], r.state_vector[3]
        cross(normal, center, velocity)
        momentum, radius, apart = norm(normal), norm(center), norm(rho)
        for i in range(3):
            normal[i] /= momentum
            radial[i] = center[i] / radius
        cross(along, normal, radial)
        axis = 1.0 / (2.0 / radius - dot(velocity, velocity) / EARTH_MU)
        if not axis > 0.0:
            return now
        speed = math.sqrt(EARTH_MU / axis)
        n = speed / axis
        span = target - now
        if not span * n > 2.0 * math.pi * REVOLUTIONS:
            return now
        # thrust
        derivative(record, state, rate, 0.0)
        force, flow = r.state_thrust, 0.0
        if engine:
            flow = rate[spent]
            force = math.copysign(flow * r.thrust_specific_impulse * STANDARD_GRAVITY, r.state_thrust)
            if state[spent] + 1.01 * flow * span >= r.engine_propellant and flow > 0.0:
                return now
        push = force / r.state_total_mass
        if push != 0.0:
            span = min(span, CHANGE * speed / (3.0 * abs(push)))
        # eccentricity, in the axes of the begin
        forced = 2.0 * push / (speed * n)
        fast, slow = dot(velocity, along), dot(velocity, radial)
        ex = momentum * fast / EARTH_MU - 1.0
        ey = -momentum * slow / EARTH_MU
        cx, cy = ex, ey + forced
        # swing
        cross(ahead, rho, moving)
        turning = momentum / (radius * radius)
        x, y, z = dot(rho, radial), dot(rho, along), dot(rho, normal)
        angle, sense = math.atan2(y, x), 1.0
        if abs(angle) > UPRIGHT:
            angle -= math.copysign(math.pi, angle)
            sense = -1.0
        faster = dot(ahead, normal) / (x * x + y * y) - turning
        across = (z * z + dot(moving, normal) * dot(moving, normal) / (n * n)) / (apart * apart)
        eccentric = math.sqrt(cx * cx + cy * cy)
        error = eccentric + across
        if error > r.level_average_tolerance:
            return now
        table, out, waves = r.state_leap, r.state_swing, r.state_waves
        for place in range(3):
            table[place, 7], table[place, 8], table[place, 9] = apart, speed, sense
        rate0 = speed * speed * speed / EARTH_MU
        push0 = -sense * force / ((r.state_total_mass - r.target_mass) * apart)
        slowing0 = -3.0 * rate0 * push / speed
        energy = 0.5 * faster * faster + potential(angle, rate0 * rate0, push0, slowing0)
        table[0, 4] = energy
        if not swing_at(record, 0.0, flow, force, span, 0):
            return now
        least, largest = table[0, 6] * out[LEAST], table[0, 6] * out[LARGEST]
        action, period0, mean0 = out[ACTION], out[PERIOD], table[0, 6] * out[MEAN]
        place0 = math.acos(max(-1.0, min(1.0, (out[MIDDLE] - angle) / out[WIDTH])))
        if faster < 0.0:
            place0 = 2.0 * math.pi - place0
        begun = along_swing(waves, 0, place0)
        beyond0 = along_swing(waves, 1, place0) - out[MEAN] * begun + 2.0 * apart * rate0 * angle
        for place in range(1, 3):
            table[place, 4], table[place, 5] = energy, action
        if not swing_at(record, 0.5, flow, force, span, 1):
            return now
        least, largest = min(least, table[1, 6] * out[LEAST]), max(largest, table[1, 6] * out[LARGEST])
        period1, mean1 = out[PERIOD], table[1, 6] * out[MEAN]
        if not swing_at(record, 1.0, flow, force, span, 2):
            return now
        least, largest = min(least, table[2, 6] * out[LEAST]), max(largest, table[2, 6] * out[LARGEST])
        period2, mean2, reduced = out[PERIOD], table[2, 6] * out[MEAN], table[2, 6]
        # the eccentricity forces the swing once a revolution, the more the nearer that is to a swing's own time
        widest = min(abs(out[MIDDLE]) + out[WIDTH], 0.25 * math.pi)
        forcing, side = 2.0 + 4.5 * math.sin(2.0 * widest), 0.0
        for place in range(3):
            period = period0 if place == 0 else period1 if place == 1 else period2
            ratio = 2.0 * math.pi / (period * table[place, 1])
            apart_from = ratio * ratio - 1.0
            if apart_from * side < 0.0:
                return now
            side = apart_from
            error = max(error, FORCED * forcing * eccentric / max(abs(apart_from), 1e-9) + across)
        if error > r.level_average_tolerance:
            return now
        swung = span / 6.0 * (1.0 / period0 + 4.0 / period1 + 1.0 / period2)
        turned = begun / period0 + swung
        last = place_of(waves, (turned - math.floor(turned)) * period2, period2)
        v1, n1, push1, slowing1, energy1 = table[2, 0], table[2, 1], table[2, 2], table[2, 3], table[2, 4]
        angle1 = out[MIDDLE] - out[WIDTH] * math.cos(last)
        faster1 = math.sqrt(max(0.0, 2.0 * (energy1 - potential(angle1, n1 * n1, push1, slowing1))))
        faster1 = math.copysign(faster1, math.sin(last))
        beyond1 = along_swing(waves, 1, last) - out[MEAN] * along_swing(waves, 0, last) + 2.0 * apart * n1 * angle1
        # orbit
        longitude = 2.0 * ey - 1.5 * ey * ex
        longitude += span / 6.0 * (table[0, 1] + 4.0 * table[1, 1] + n1)
        grown = math.pow(v1 / speed, 1.5)
        forced1 = 2.0 * force / ((r.state_total_mass - flow * span) * v1 * n1)
        u = longitude
        ex1, ey1, es, ec = 0.0, 0.0, 0.0, 0.0
        for _ in range(12):
            c, s = math.cos(u), math.sin(u)
            ex1, ey1 = grown * cx + forced1 * s, grown * cy - forced1 * c
            es, ec = ex1 * s - ey1 * c, ex1 * c + ey1 * s
            u = longitude + 2.0 * es - 1.5 * es * ec
        c, s = math.cos(u), math.sin(u)
        semi = EARTH_MU / (v1 * v1)
        latus = semi * (1.0 - ex1 * ex1 - ey1 * ey1)
        away, pace = latus / (1.0 + ex1 * c + ey1 * s), math.sqrt(EARTH_MU / latus)
        for i in range(3):
            center[i] = away * (c * radial[i] + s * along[i])
            velocity[i] = pace * ((c + ex1) * along[i] - (s + ey1) * radial[i])
        turning = pace * latus / (away * away)
        ca, sa = sense * math.cos(u + angle1), sense * math.sin(u + angle1)
        pull = reduced * apart * (faster1 * (faster1 + 2.0 * n1) + 3.0 * n1 * n1 * math.cos(angle1) ** 2)
        pull += reduced * apart * push1 * math.sin(angle1)
        apart = r.state_length + r.state_beyond + pull / r.state_stiffness
        for i in range(3):
            rho[i] = apart * (ca * radial[i] + sa * along[i])
            moving[i] = apart * (faster1 + turning) * (ca * along[i] - sa * radial[i])
        state[impulse] += span / 6.0 * (mean0 + 4.0 * mean1 + mean2) + reduced * (beyond1 - beyond0)
        if engine:
            state[spent] += flow * span
        r.state_leap_range[0] = least
        r.state_leap_range[1] = largest
        r.state_leap_range[2] = error
        r.state_leap_range[3] = span * n / (2.0 * math.pi)
        r.state_next_leap = now
        return now + span

    return leap


@kernel
def leapt(record: Any, now: float, later: float) -> None:
    """A leap from one time to another [s] holds: its time, tensions, revolutions and error are booked.

    Checked  tests/tethered_deorbit/test_averaged.py
    """
    r = record[0]
    span = later - now
    r.state_leapt_to = later
    r.state_level_times[AVERAGED] += span
    note_pull(record, r.state_leap_range[1])
    if not r.state_tug_begun:
        r.state_tug_peak = r.tug_peak[0]
    r.state_peak = max(r.state_peak, r.state_leap_range[1])
    r.state_least = min(r.state_least, r.state_leap_range[0])
    r.state_average_error = max(r.state_average_error, r.state_leap_range[2])
    r.state_revolutions += r.state_leap_range[3]


def make_averaged(level: Level) -> Level:
    """The level whose dumbbells leap, of the one from event to event."""

    @kernel
    def publish(record: Any) -> None:
        """The outputs of that level, and of the leaps.

        Checked  tests/tethered_deorbit/test_averaged.py
        """
        level.publish(record)
        r = record[0]
        r.level_averaged = r.state_level_times[AVERAGED]
        r.level_average_error = r.state_average_error
        r.level_revolutions = r.state_revolutions
        if r.state_leapt_to == r.state_published and r.state_revolutions > 0.0:
            r.level_now = AVERAGED

    @kernel
    def begin(record: Any) -> None:
        """No leap has been.

        Checked  tests/tethered_deorbit/test_averaged.py
        """
        r = record[0]
        r.state_next_leap = 0.0
        r.state_average_error = 0.0
        r.state_revolutions = 0.0
        r.state_leapt_to = 0.0
        level.begin(record)
        publish(record)

    return level._replace(begin=begin, publish=publish)
