"""Gravity that is the same everywhere and changes with time, as is left over in an aircraft on a parabola.

Straight lines between the instants of a table; before the first and after the last as there. What changes with time
gives energy and takes it: the potential -m g(t) r changes by -m dg r where nothing has moved. That is summed from look
to look, r at the mean of both, and told as `gravity.work`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fmu_src.interface import Term
from fmu_src.net_capture.gravity import Gravity
from fmu_src.net_capture.gravity.falling import BACK, GAIN, ROWS, TIME, WAY, make_falling
from fmu_src.net_capture.planes import MASS, SHOWN
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.rows import output, state
from fmu_src.tables import Table, read_rows
from orbital.kernel import kernel

UNITS = ("s", "m/s2", "m/s2", "m/s2")
"""Of the columns, in which a head may name them: time [s], x [m/s2], y [m/s2], z [m/s2]."""


def read(path: Path) -> list[list[float]]:
    """Rows of such a file, with a head or without; ValueError if they are not four numbers, or times do not rise."""
    rows = read_rows(path, UNITS)
    for count, row in enumerate(rows, 1):
        if len(row) != 4:
            raise ValueError(
                f"row {count}: {len(row)} numbers, expected 4: time [s] and acceleration [m/s2] along each axis"
            )
        if count > 1 and not row[0] > rows[count - 2][0]:
            raise ValueError(f"row {count}: time {row[0]:g} s, expected one after {rows[count - 2][0]:g} s")
    return rows


@kernel
def span_of(rows, time):
    """Number of the row before a time [s], of those that have one after them; the first where none is before it.

    Checked  tests/net_capture/test_ground.py
    """
    low = 0
    high = rows.shape[0] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if rows[middle, 0] <= time:
            low = middle
        else:
            high = middle
    return low


@kernel
def at_time(rows, time, axis):
    """Acceleration [m/s2] along an axis at a time [s].

    Checked  tests/net_capture/test_ground.py
    """
    last = rows.shape[0] - 1
    if time <= rows[0, 0]:
        return rows[0, 1 + axis]
    if time >= rows[last, 0]:
        return rows[last, 1 + axis]
    k = span_of(rows, time)
    share = (time - rows[k, 0]) / (rows[k + 1, 0] - rows[k, 0])
    return rows[k, 1 + axis] + share * (rows[k + 1, 1 + axis] - rows[k, 1 + axis])


@kernel
def fall(rows, begin, end, axis, flight):
    """What gravity adds along an axis to velocity [m/s] and way [m] from one time to another [s], into a flight.

        dv = integral g dt,   dx = integral (end - t) g dt; of a straight piece g0 to g1 in d, with e after it:
        (g0 + g1) d/2   and   (g0/3 + g1/6) d2 + e (g0 + g1) d/2

    Checked  tests/net_capture/test_ground.py
    """
    gain = 0.0
    way = 0.0
    time = begin
    while time < end:
        k = 0 if time < rows[0, 0] else span_of(rows, time) + 1
        later = end
        if k < rows.shape[0]:
            if rows[k, 0] > time:
                later = min(end, rows[k, 0])
        d = later - time
        first = at_time(rows, time, axis)
        second = at_time(rows, later, axis)
        step = 0.5 * (first + second) * d
        gain += step
        way += (first / 3.0 + second / 6.0) * d * d + (end - later) * step
        time = later
    flight[GAIN + axis] = gain
    flight[WAY + axis] = way


def make(composition: Any) -> Gravity:
    """Kernels for the composition's table and clock."""
    table, now = composition.table("gravity.history"), composition.clock.now
    node_plane, has_target = composition.memory.node_plane, "target" in composition.terms

    @kernel
    def renew(p):
        """Gravity of now.

        Checked  tests/net_capture/test_ground.py
        """
        for axis in range(3):
            p.gravity_now[axis] = at_time(table(p), now(p), axis)

    @kernel
    def start(p):
        """Gravity of the start, and the largest of the table: between two rows it is no larger than at both.

        Checked  tests/net_capture/test_ground.py
        """
        renew(p)
        p.gravity_most = 0.0
        for k in range(table(p).shape[0]):
            squared = 0.0
            for axis in range(3):
                squared += table(p)[k, 1 + axis] * table(p)[k, 1 + axis]
            p.gravity_most = max(p.gravity_most, math.sqrt(squared))
        p.gravity_given = 0.0
        for axis in range(3):
            p.gravity_looked[axis] = p.gravity_now[axis]

    @kernel
    def begin_flight(p, flight, first, steps):
        """What gravity adds to way and velocity from a substep on; see `fall`.

        Checked  tests/net_capture/test_ground.py
        """
        h = p.solver_substep
        begin = now(p) + (first - p.grid) * h
        end = begin + steps * h
        flight[TIME] = end - begin
        for axis in range(3):
            fall(table(p), begin, end, axis, flight)
            flight[BACK + axis] = 0.5 * h * at_time(table(p), end, axis)

    @kernel
    def moment(p, work, out):
        """out = sum of mass times place [kg m] of all that falls, as shown.

        Checked  tests/net_capture/test_ground.py
        """
        mass = node_plane(p, work, MASS)
        for axis in range(3):
            place = node_plane(p, work, SHOWN + axis)
            total = 0.0
            for i in range(p.node_slots):
                total += mass[i] * place[i]
            if p.gravity_on_chaser != 0:
                total += p.chaser_mass * p.chaser_place[axis]
            if has_target:
                if p.gravity_on_target != 0:
                    total += p.target_mass * p.target_place[axis]
            out[axis] = total

    @kernel
    def given(p, work):
        """Energy [J] that the change of gravity has given: up to the last look, and since.

            -integral M r . dg,   M r at the mean of both ends

        Valid    gravity that changes little between two looks; the error of a look is that of the trapezoidal rule
        Checked  tests/net_capture/test_ground.py
        """
        here = p.scratch[0:3]
        moment(p, work, here)
        p.gravity_work = p.gravity_given
        for axis in range(3):
            change = p.gravity_now[axis] - p.gravity_looked[axis]
            p.gravity_work -= 0.5 * (here[axis] + p.gravity_moment[axis]) * change
        return p.gravity_work

    @kernel
    def watch(p, work):
        """Sum it up to this look.

        Checked  tests/net_capture/test_ground.py
        """
        if p.grid > 0:
            p.gravity_given = given(p, work)
        moment(p, work, p.gravity_moment)
        for axis in range(3):
            p.gravity_looked[axis] = p.gravity_now[axis]

    return make_falling(composition, start, renew, begin_flight, watch, given)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """A scheme that looks at forces within a substep, where gravity would be that of its begin."""
    scheme = scene.terms.get("solver", "leapfrog")
    if scheme != "leapfrog":
        yield Refusal("solver.scheme", scheme, 'must be "leapfrog" with a gravity that changes with time')


PART = Term(
    "gravity that changes with time, as on a parabolic flight: straight lines between the rows of a table",
    (
        output("gravity.work", "J", "given by the change of gravity so far"),
        *ROWS,
        state("gravity_given", "J", "given up to the last look"),
        state("gravity_looked[#]", "m/s2", "gravity at the last look", shape=(3,)),
        state("gravity_moment[#]", "kg.m", "mass times place of all that falls, at the last look", shape=(3,)),
    ),
    make=make,
    tables=(
        Table(
            "gravity.history",
            "1",
            "time since the shot [s], acceleration along each axis [m/s2]; a head with these units may stand first",
            2,
            read=read,
        ),
    ),
    refuses=refuses,
)
