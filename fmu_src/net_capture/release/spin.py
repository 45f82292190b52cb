"""A net that turns as it leaves, and a chaser that does.

    dv = (s axis + w) x (r - r_muzzle) + w x arm

`s` is the spin that the launcher gives the whole net about the shot axis: the chaser takes the opposite angular
momentum. At `w` chaser and net have turned together before the shot: the net keeps that, and a muzzle that stands off
the chaser's centre of mass by `arm` gives all of it a transverse velocity, whose opposite the chaser has.

Valid    a chaser whose attitude is held from the shot on; `chaser.start_velocity` is that of chaser and net together
Source   rigid motion; ours
Checked  tests/net_capture/test_spin.py
"""

from __future__ import annotations

from typing import Any, NamedTuple

from fmu_src.extremes import Extreme
from fmu_src.interface import Term
from fmu_src.net_capture.planes import MASS, U, X
from fmu_src.net_capture.release import BOOKED
from fmu_src.rows import parameter, state, vector
from orbital.kernel import kernel

FASTEST = 100.0
"""rad/s, 16 turns a second: more is a slip of the unit."""


class Spin(NamedTuple):
    """Kernels of a net that turns.

    turn(p, work)     add its velocities at the shot, and book what the chaser takes of its spin
    is_turning(p)     whether anything turns
    """

    turn: Any
    is_turning: Any


@kernel
def is_turning(p):
    """Whether anything turns.

    Checked  tests/net_capture/test_ejection.py
    """
    rate = p.spin_chaser_rate
    return p.spin_rate != 0.0 or rate[0] != 0.0 or rate[1] != 0.0 or rate[2] != 0.0


@kernel
def cross(out, a, b):
    """out = a x b.

    Checked  tests/net_capture/test_spin.py
    """
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


def make(composition: Any) -> Spin:
    """Kernels for the composition's net."""
    node_plane = composition.memory.node_plane

    @kernel
    def turn(p, work):
        """Add the velocities at the shot, and book what the chaser takes of the spin.

        Checked  tests/net_capture/test_spin.py
        """
        mass = node_plane(p, work, MASS)
        place = p.spin_vectors[0:3]
        whole = p.spin_vectors[3:6]
        swept = p.spin_vectors[6:9]
        given = p.spin_vectors[9:12]
        taken = p.spin_vectors[12:15]
        for i in range(p.node_slots):
            if mass[i] > 0.0:
                for axis in range(3):
                    place[axis] = node_plane(p, work, X + axis)[i] - p.muzzle[axis]
                    given[axis] = p.spin_rate * p.axes[6 + axis]
                    whole[axis] = place[axis] + p.spin_arm[axis]
                cross(swept, p.spin_chaser_rate, whole)
                cross(taken, given, place)
                for axis in range(3):
                    node_plane(p, work, U + axis)[i] += swept[axis] + taken[axis]
                    given[axis] = taken[axis]
                cross(taken, place, given)
                for axis in range(3):
                    p.chaser_turned[axis] -= mass[i] * taken[axis]

    return Spin(turn, is_turning)


PART = Term(
    "the net turns as it leaves, or the chaser does",
    (
        parameter(
            "spin.rate",
            "rad/s",
            "of the whole net about the shot axis, as it leaves",
            0.0,
            -FASTEST,
            FASTEST,
            display_unit="deg/s",
        ),
        vector(
            "spin.chaser_rate",
            "rad/s",
            "of the chaser at the shot, orbital frame",
            "parameter",
            minimum=-FASTEST,
            maximum=FASTEST,
            display_unit="deg/s",
        ),
        vector("spin.arm", "m", "from the chaser's centre of mass to the muzzle, orbital frame", "parameter"),
        *BOOKED,
        state("spin_vectors[#]", "1", "small vectors of its kernels", shape=(15,)),
    ),
    make=make,
    extremes=tuple(
        Extreme(
            f"net turns at {rate:g} rad/s",
            "the pull outward grows with the square of the rate",
            "energy_gained",
            {"spin.rate": rate},
            duration=duration,
            chief=rate == 10.0,
        )
        for rate, duration in ((0.0, 0.0), (10.0, 0.0), (100.0, 1.0))
    ),
)
