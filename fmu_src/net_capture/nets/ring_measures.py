"""Lengths of a net of rings and meridians, for its kernels and for whoever asks before any build.

The functions are made twice from what stands here: as kernels, and as plain Python on values.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, NamedTuple

from fmu_src.implied import formula
from fmu_src.net_capture.nets import LARGEST_MESH, Checks, Values
from fmu_src.net_capture.nets.uniform import Lengths, uniform
from orbital.kernel import kernel

BULLETS = 4
CROWDED = 2.0 / 3.0
"""Share of a mesh below which knots of a ring crowd: with every second left they are as much wider apart as they were
too close."""


class Profile(NamedTuple):
    """Kernels of the profile of one such net.

    rings(p)         how many rings there are, without the tip [1]
    has_tip(p)       whether the meridians meet behind the last ring
    ring(p, i)       radius of a ring, and how far it lies behind the mouth [m]; the tip is the one after the last
    """

    rings: Any
    has_tip: Any
    ring: Any


@kernel
def meridians_of(radius, mesh, given):
    """Meridians of a net [1]: those given, or the number nearest to the rim over the mesh of those that can be halved
    often, 4, 8, 12, 16, 24, 32, 48 and on.

    radius    of the mouth       [m]
    mesh      wanted             [m]

    Checked  tests/net_capture/test_rings.py
    """
    if given > 0:
        return given
    wanted = 2.0 * math.pi * radius / mesh
    found = 4
    size = 4
    while size < 2.0 * wanted:
        for number in (size, size + size // 2):
            if number % 4 == 0 and abs(number - wanted) < abs(found - wanted):
                found = number
        size *= 2
    return found


@kernel
def chord(radius, meridians, every):
    """From a knot of a ring to the next [m]: 2 r sin(pi e / M).

    every    e    meridians from one to the next [1]

    Checked  tests/net_capture/test_rings.py
    """
    return 2.0 * radius * math.sin(math.pi * every / meridians)


@kernel
def next_every(every, radius, meridians, mesh):
    """On every so many-th meridian a ring has a knot [1], after a ring where that was `every`.

    Checked  tests/net_capture/test_rings.py
    """
    while (
        2.0 * radius * math.sin(math.pi * every / meridians) < CROWDED * mesh
        and meridians % (2 * every) == 0
        and meridians // (2 * every) >= 4
    ):
        every *= 2
    return every


class Measures(NamedTuple):
    """Functions of a net of one profile.

    along_of(p, i, every)   length of a thread along ring i                               [m]
    inward_of(p, i)         length of a thread from ring i to the next                    [m]
    every_of(p, i)          on every so many-th meridian ring i has a knot                [1]
    total(p)                length of all threads                                         [m]
    shortest(p)             as `Checks` means it                                          [m]
    """

    along_of: Any
    inward_of: Any
    every_of: Any
    total: Any
    shortest: Any


def make_measures(compiled: Callable[..., Any], chord: Any, next_every: Any, profile: Profile) -> Measures:
    """These functions, each passed through `compiled`, of kernels or of plain functions."""
    has_tip, ring = profile.has_tip, profile.ring

    @compiled
    def along_of(p, i, every):
        """Length of a thread along a ring [m].

        Checked  tests/net_capture/test_rings.py
        """
        radius, _ = ring(p, i)
        return chord(radius, p.grid_columns, every)

    @compiled
    def inward_of(p, i):
        """Length of a thread from a ring to the next [m].

        Checked  tests/net_capture/test_rings.py
        """
        r, z = ring(p, i)
        next_r, next_z = ring(p, i + 1)
        return math.sqrt((r - next_r) * (r - next_r) + (z - next_z) * (z - next_z))

    @compiled
    def every_of(p, i):
        """On every so many-th meridian ring i has a knot [1]; the tip has the one of the last ring.

        Checked  tests/net_capture/test_rings.py
        """
        every = 1
        for k in range(1, min(i, p.grid_rows - 1) + 1):
            radius, _ = ring(p, k)
            every = next_every(every, radius, p.grid_columns, p.net_mesh)
        return every

    @compiled
    def total(p):
        """Length of all threads [m].

        Checked  tests/net_capture/test_rings.py
        """
        length = 0.0
        tip = has_tip(p)
        for i in range(p.grid_rows):
            every = every_of(p, i)
            length += (p.grid_columns // every) * along_of(p, i, every)
            if i + 1 < p.grid_rows or tip:
                length += (p.grid_columns // every_of(p, i + 1)) * inward_of(p, i)
        return length

    @compiled
    def shortest(p):
        """As `Checks` means it [m]: the root of the least sum of l over sum of 1/l of the threads of a knot.

        Checked  tests/net_capture/test_rings.py
        """
        least = math.inf
        tip = has_tip(p)
        for i in range(p.grid_rows):
            every = every_of(p, i)
            along = along_of(p, i, every)
            if p.net_segments > 1:
                # a node within a thread has two of its pieces
                least = min(least, along * along)
            goes_on = i + 1 < p.grid_rows or tip
            # a meridian that ends here, and one that goes on, where there is such a one
            for onward in range(2):
                if onward == 1 and not goes_on:
                    continue
                if onward == 0 and goes_on and every_of(p, i + 1) == every:
                    continue
                length = 2.0 * along
                stiff = 2.0 / along
                if i > 0:
                    length += inward_of(p, i - 1)
                    stiff += 1.0 / inward_of(p, i - 1)
                if onward == 1:
                    length += inward_of(p, i)
                    stiff += 1.0 / inward_of(p, i)
                least = min(least, length / stiff)
            if goes_on and (p.net_segments > 1 or i + 1 == p.grid_rows):
                least = min(least, inward_of(p, i) ** 2)
        return math.sqrt(least)

    return Measures(along_of, inward_of, every_of, total, shortest)


def plain(profile: Profile) -> tuple[Profile, Measures]:
    """A profile and its measures as plain Python."""
    written = Profile(*(formula(one) for one in profile))
    return written, make_measures(lambda function: function, formula(chord), formula(next_every), written)


def record_of(profile: Profile, values: Values) -> Any:
    """What the functions read, of values by FMI name."""
    p = SimpleNamespace(**{name.replace(".", "_"): value for name, value in values.items()})
    written, _ = plain(profile)
    p.grid_columns = formula(meridians_of)(written.ring(p, 0)[0], p.net_mesh, int(p.net_meridians))
    p.grid_rows = written.rings(p)
    return p


def make_checks(profile: Profile) -> Checks:
    """What a net of that profile says."""
    written, measures = plain(profile)

    def side(values: Values) -> float:
        """A quarter of the rim [m]."""
        p = record_of(profile, values)
        return float(p.grid_columns // BULLETS * measures.along_of(p, 0, 1))

    def knots(values: Values) -> int:
        return int(record_of(profile, values).grid_columns) // BULLETS - 1

    def lengths(values: Values) -> Lengths:
        p = record_of(profile, values)
        goes_in = p.grid_rows > 1 or written.has_tip(p)
        edge = measures.along_of(p, 0, 1) + (0.5 * measures.inward_of(p, 0) if goes_in else 0.0)
        inside = 0.0
        for i in range(1, p.grid_rows):
            onward = 0.5 * measures.inward_of(p, i) if i + 1 < p.grid_rows or written.has_tip(p) else 0.0
            along = measures.along_of(p, i, measures.every_of(p, i))
            inside = max(inside, along + 0.5 * measures.inward_of(p, i - 1) + onward)
        if written.has_tip(p):
            last = p.grid_rows - 1
            meet = p.grid_columns // measures.every_of(p, last)
            inside = max(inside, 0.5 * meet * measures.inward_of(p, last))
        return inside, edge, edge

    def least(values: Values) -> float:
        p = record_of(profile, values)
        rings, tip = range(p.grid_rows), written.has_tip(p)
        along = [measures.along_of(p, i, measures.every_of(p, i)) for i in rings]
        inward = [measures.inward_of(p, i) for i in rings if i + 1 < p.grid_rows or tip]
        return float(min(along + inward))

    def nodes(values: Values) -> int:
        if not sound(profile, values):
            return 1
        p = record_of(profile, values)
        here = [p.grid_columns // measures.every_of(p, i) for i in range(p.grid_rows)]
        tip = bool(written.has_tip(p))
        inwards = [*here[1:], *([here[-1]] if tip else [])]
        return int(sum(here) + tip + (int(values["net.segments"]) - 1) * (sum(here) + sum(inwards)))

    def drawing(values: Values) -> tuple[list[list[int]], list[int]]:
        p = record_of(profile, values)
        first, number = 0, []
        for i in range(p.grid_rows):
            every = measures.every_of(p, i)
            number.append({j: first + j // every for j in range(0, p.grid_columns, every)})
            first += len(number[-1])
        lines = [[*ring.values(), ring[0]] for ring in number]
        for j in range(p.grid_columns):
            line = [ring[j] for ring in number if j in ring]
            lines.append([*line, first] if written.has_tip(p) and j in number[-1] else line)
        return [line for line in lines if len(line) > 1], [*number[0].values(), 0]

    return uniform(
        corner=lambda values: (math.sqrt(0.5) * values["net.radius"], math.sqrt(0.5) * values["net.radius"]),
        widths=lambda values: (2.0 * values["net.radius"], 2.0 * values["net.radius"]),
        sides=lambda values: [side(values)] * BULLETS,
        narrow=lambda values: "net.radius",
        knots=knots,
        gap=lambda values: side(values) / (knots(values) + 1),
        total=lambda values: float(measures.total(record_of(profile, values))),
        shortest=lambda values: float(measures.shortest(record_of(profile, values))),
        lengths=lengths,
        least=least,
        nodes=nodes,
        drawing=drawing,
    )


def sound(profile: Profile, values: Values) -> bool:
    """Whether there is such a net."""
    if int(values["net.meridians"]) % BULLETS or not 0.0 < values["net.mesh"] < math.inf:
        return False
    p = record_of(profile, values)
    return bool(max(p.grid_columns, p.grid_rows) <= LARGEST_MESH)
