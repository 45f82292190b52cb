"""No field at all: two free bodies in an inertial frame, for closed forms and the low-friction table.

The frame is at rest, its axes 1, 2 and 3 stand where radial, along-track and cross-track stand on an orbit, and its
origin is where a pair that is not handed over has its centre of mass at the start. The line then lies along axis 2, and
a thrust `along_track` points along it.
"""

from __future__ import annotations

from typing import Any

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.environment import Environment
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.interface import EQUAL_VELOCITY, HANDED_OVER, NO_ORBIT
from orbital.kernel import kernel
from orbital.vectors import Array

PACE = 1.0e-3
"""That of a low orbit [rad/s], so that the tolerances mean what they mean there."""


@kernel
def begin(record: Any) -> None:
    """No orbit, no mean motion [rad/s].

    Checked  tests/tethered_deorbit/test_field_free.py
    """
    r = record[0]
    r.state_mean_motion = 0.0
    r.state_pace = PACE


@kernel
def frame(record: Any, position: Array, velocity: Array) -> float:
    """Axes at rest; the rate returned is zero [rad/s].

    Checked  tests/tethered_deorbit/test_field_free.py
    """
    basis = record[0].state_basis
    for i in range(3):
        for j in range(3):
            basis[i][j] = 1.0 if i == j else 0.0
    return 0.0


@kernel
def place(record: Any, position: Array, velocity: Array) -> float:
    """An origin at rest, where the axes meet; the rate returned is zero [rad/s].

    Checked  tests/tethered_deorbit/test_field_free.py
    """
    for i in range(3):
        position[i] = 0.0
        velocity[i] = 0.0
    return float(frame(record, position, velocity))


@kernel
def add_gravity(record: Any, state: Array, rate: Array) -> None:
    """Rate of the state of free bodies [m/s, m/s^2]; writes all twelve components.

        R' = V,   V' = 0,   d(rho)/dt = rho',   rho'' = 0

    state         R, V, rho, rho'  of `layout`                   (12,)

    Source   Newton's first law
    Checked  tests/tethered_deorbit/test_field_free.py: centre of mass and momentum
    """
    for i in range(3):
        rate[i] = state[3 + i]
        rate[3 + i] = 0.0
        rate[6 + i] = state[9 + i]
        rate[9 + i] = 0.0


@kernel
def gravity_apart(position: Array, offset: Array, out: Array) -> None:
    """out = difference of gravity where there is none [m/s^2].

    Checked  tests/tethered_deorbit/test_nodes.py
    """
    for i in range(3):
        out[i] = 0.0


@kernel
def along_track(record: Any, state: Array) -> tuple[float, float, float]:
    """Axis 2, along which a line lies at the start [-]."""
    return 0.0, 1.0, 0.0


@kernel
def gradient(position: Array) -> float:
    """No field, no gradient [1/(m2 s2)]."""
    return 0.0


@kernel
def fallen(position: Array) -> float:
    """There is no ground: -1.

    Checked  tests/tethered_deorbit/test_field_free.py: a centre of mass at the origin
    """
    return -1.0


@kernel
def publish(record: Any) -> None:
    """It has no outputs of its own."""


@kernel
def differentiate(record: Any, state: Array, rate: Array, shed: float) -> None:
    """Nor rates of them."""


@kernel
def relative_rates(
    basis: Array, position: Array, velocity: Array, acceleration: Array, relative: Array, out: Array
) -> tuple[float, float]:
    """Rates of the relative state, in axes at rest: see `Environment`. Rate of the frame and its change are zero.

    relative      rho', rho''  inertial                          [m/s]    (6,)
    out           rho'' and, behind it, rho'                     (6,)

    Checked  tests/tethered_deorbit/test_field_free.py: against differences
    """
    for i in range(3):
        out[i] = relative[3 + i]
        out[3 + i] = relative[i]
    return 0.0, 0.0


def make_none(interface: Interface) -> Environment:
    """The kernels for a record of this interface."""
    condition_slot = interface.references["start.condition"]

    @kernel
    def check(record: Any) -> int:
        """Fault of a start that wants an orbit, or 0.

        Checked  tests/tethered_deorbit/test_field_free.py
        """
        condition = record[0].start_condition
        if condition in (EQUAL_VELOCITY, HANDED_OVER):
            return 0
        return blame(record, NO_ORBIT, condition_slot, float(condition))

    @kernel
    def same_orbit(record: Any, state: Array) -> int:
        """The fault of one that has none: `check` has refused it before.

        Checked  tests/tethered_deorbit/test_field_free.py
        """
        return NO_ORBIT

    return Environment(
        begin,
        check,
        place,
        same_orbit,
        add_gravity,
        gravity_apart,
        along_track,
        gradient,
        fallen,
        frame,
        publish,
        differentiate,
        relative_rates,
    )
