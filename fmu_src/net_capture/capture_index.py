"""How well the target is wrapped: the capture quality index (CQI) of the literature, lower is better.

    J = 0.1 |Vn - Vt| / Vt + 0.1 |Sn - St| / St + 0.8 |qn| / Lc

Vn, Sn are volume and surface of the convex hull of net, bullets and vertex; Vt, St those of the target; qn goes from
the target's centre of mass to theirs; Lc is a characteristic length of the target.

Vt and St of a box, cylinder, sphere or frustum follow from its sizes; of any other shape the scene gives them. Lc is by
default the mean of the three edges of the box that holds the target, the characteristic length of debris in NASA's
breakup model (Johnson and others, Advances in Space Research 28 (2001) 1377): publications take lengths of their own.

Valid    looked at at communication points; the hull knows neither mouth nor holes, so a net that lies beside the target
         with its middle near it counts as good: see `captured`
Source   weights and terms as in the tether-net literature (Botta, Sharf, Misra and others)
Checked  tests/net_capture/test_capture_index.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

from fmu_src.extremes import Extreme
from fmu_src.interface import Term, fault
from fmu_src.net_capture.hull import FACE_WORDS, POINT_WORDS, make_hull
from fmu_src.net_capture.planes import MASS, SHOWN
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.rows import at_least_zero, output, peak
from orbital.kernel import kernel, view

SCRATCH_PLANES = 4 * FACE_WORDS + 2 * POINT_WORDS
"""Planes of doubles that the hull may scribble on: it has at most twice as many faces as points, and some to spare."""

NO_ROOM = fault("no_room_for_hull", "", "the convex hull of the net has more faces than there is memory for")


class Index(NamedTuple):
    """Kernels of the index.

    start(p)                    nothing measured yet
    measure(p, work) -> fault   of the nodes shown, with the places of catch and target
    """

    start: Any
    measure: Any


@kernel
def quality_index(volume, surface, offset, target_volume, target_surface, length):
    """The index [1] from volumes [m3], surfaces [m2], offset of the centres of mass and characteristic length [m].

    Checked  tests/net_capture/test_capture_index.py
    """
    wrapped = 0.1 * abs(volume - target_volume) / target_volume + 0.1 * abs(surface - target_surface) / target_surface
    return wrapped + 0.8 * offset / length


@kernel
def box_extent(p):
    """Volume [m3] and surface [m2] of a box.

    Checked  tests/net_capture/test_capture_index.py
    """
    a, b, c = p.target_size[0], p.target_size[1], p.target_size[2]
    return a * b * c, 2.0 * (a * b + b * c + c * a)


@kernel
def cylinder_extent(p):
    """Volume [m3] and surface [m2] of a cylinder.

    Checked  tests/net_capture/test_capture_index.py
    """
    r, length = p.target_radius, p.target_length
    return math.pi * r * r * length, 2.0 * math.pi * r * (r + length)


@kernel
def sphere_extent(p):
    """Volume [m3] and surface [m2] of a sphere.

    Checked  tests/net_capture/test_capture_index.py
    """
    r = p.target_radius
    return 4.0 / 3.0 * math.pi * r * r * r, 4.0 * math.pi * r * r


@kernel
def frustum_extent(p):
    """Volume [m3] and surface [m2] of a frustum.

    Checked  tests/net_capture/test_capture_index.py
    """
    a, b, length = p.target_radius_bottom, p.target_radius_top, p.target_length
    slant = math.sqrt(length * length + (a - b) * (a - b))
    volume = math.pi * length * (a * a + a * b + b * b) / 3.0
    return volume, math.pi * (a * a + b * b + (a + b) * slant)


KNOWN = {"box": box_extent, "cylinder": cylinder_extent, "sphere": sphere_extent, "frustum": frustum_extent}
"""Shapes whose volume and surface follow from their sizes, each with the kernel that tells them."""


@kernel
def told_extent(p):
    """Volume [m3] and surface [m2] as the scene gives them.

    Checked  tests/net_capture/test_capture_index.py
    """
    return p.quality_target_volume, p.quality_target_surface


def make(composition: Any) -> Index:
    """Kernels for the composition's net and target."""
    memory, per_double = composition.memory, composition.per_double
    node_plane, first = memory.node_plane, composition.scratch_plane
    extent = KNOWN.get(composition.terms["target"], told_extent)
    hull, no_room = make_hull(), composition.code(NO_ROOM.name)

    @view
    def scratch(p, work):
        """The planes that the hull may scribble on.

        Checked  tests/net_capture/test_capture_index.py
        """
        return work[first * p.node_slots // per_double : (first // per_double + SCRATCH_PLANES) * p.node_slots]

    @kernel
    def start(p):
        """Nothing measured yet.

        Checked  tests/net_capture/test_capture_index.py
        """
        p.quality_at_capture = -1.0
        p.quality_length = p.quality_characteristic_length
        if p.quality_length == 0.0:
            p.quality_length = p.target_edge

    @kernel
    def measure(p, work):
        """Hull, offset and index, and the index when the target was first seen captured; a fault code or 0.

        Checked  tests/net_capture/test_capture_index.py
        """
        points, mass = scratch(p, work), node_plane(p, work, MASS)
        count = 0
        for node in range(p.node_slots):
            if mass[node] > 0.0:
                for axis in range(3):
                    points[3 * count + axis] = node_plane(p, work, SHOWN + axis)[node]
                count += 1
        p.quality_hull_volume, p.quality_hull_surface = hull(points, count)
        if p.quality_hull_volume < 0.0:
            return no_room
        squared = 0.0
        for axis in range(3):
            d = p.catch_position[axis] - p.target_position[axis]
            squared += d * d
        p.quality_offset = math.sqrt(squared)
        volume, surface = extent(p)
        if p.quality_target_volume > 0.0:
            volume, surface = told_extent(p)
        p.quality_index = quality_index(
            p.quality_hull_volume, p.quality_hull_surface, p.quality_offset, volume, surface, p.quality_length
        )
        if p.captured != 0 and p.quality_at_capture < 0.0:
            p.quality_at_capture = p.quality_index
        return 0

    return Index(start, measure)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """Volume or surface of the target that nobody knows, or one without the other."""
    for name in ("target_volume", "target_surface"):
        other = "target_surface" if name == "target_volume" else "target_volume"
        if scene.values[f"quality.{name}"] == 0.0:
            if scene.values[f"quality.{other}"] > 0.0:
                yield Refusal(f"quality.{name}", "0", f"must be given with quality.{other}, and greater than 0")
            elif scene.terms["target"] not in KNOWN:
                expected = f"must be greater than 0: it follows from the sizes of {', '.join(KNOWN)} alone"
                yield Refusal(f"quality.{name}", "0", expected)


PART = Term(
    "capture quality index (CQI), by the convex hull of the net",
    (
        at_least_zero(
            "quality.characteristic_length",
            "m",
            "of the target; zero: the mean of the edges of the box that holds it",
            0.0,
        ),
        at_least_zero("quality.target_volume", "m3", "of the target; zero: by its sizes", 0.0),
        at_least_zero("quality.target_surface", "m2", "of the target; zero: by its sizes", 0.0),
        output("quality.index", "1", "capture quality index: lower is better"),
        peak("quality.at_capture", "1", "that index when captured was first told; -1 before"),
        output("quality.hull_volume", "m3", "of the convex hull of net, bullets and vertex"),
        output("quality.hull_surface", "m2", "of that hull"),
        output("quality.offset", "m", "from the target's centre of mass to that of net, bullets and vertex"),
        peak("quality.length", "m", "the characteristic length taken"),
    ),
    needs=("target",),
    faults=(NO_ROOM,),
    extremes=tuple(
        Extreme(
            f"index of a target {length:g} m long",
            "lengths, surfaces and volumes of net and target decades apart",
            "hull",
            {
                "quality.characteristic_length": length,
                "quality.target_surface": 6.0 * length**2,
                "quality.target_volume": length**3,
            },
        )
        for length in (1e-3, 1e3)
    ),
    make=make,
    refuses=refuses,
)
