"""What an FMU tells of threads that bend, what their kernels scribble on, and the ends of their range."""

from __future__ import annotations

import math
from dataclasses import replace

from fmu_src.extremes import Extreme
from fmu_src.net_capture.contact.section import FACES, MOST
from fmu_src.net_capture.shapes.union import BESIDE
from fmu_src.net_capture.visit_list import rows as visits
from fmu_src.rows import count, output, peak, state

OF_UNIONS = (
    *visits(),
    count("wrap_body", "which body that is round which a way goes, counted from 0", "state"),
    count("wrap_once", "whether a way slides over one corner alone in a search", "state"),
    count("wrap_slid", "whether it has", "state"),
    state("wrap_bent[#][#]", "m", "where it bent first and last then, body axes", shape=(2, 3)),
    count("wrap_leans", "on which side of the body a way is sought", "state"),
    state("wrap_lean[#]", "m", "where a thread bends already, from its end, body axes", shape=(3,)),
    count("wrap_whole[#]", "faces over which a way goes with those in other bodies", "state", shape=(MOST + 1,)),
    count("wrap_covered[#]", "whether a face of the body lies in other bodies", "state", shape=(FACES,)),
    state("wrap_grazes", "m", "by how much deeper than ways lie a piece of one may graze a body"),
    state("wrap_near", "m", "how far a thread is from bodies near it, at least"),
    state("wrap_far", "m", "how far it is from all others, at least"),
)
"""Of ways among several bodies."""

ROWS = (
    *(replace(row, beside=BESIDE) for row in OF_UNIONS),
    count("wrap.threads", "taut threads that bend round an edge now"),
    count("wrap.passed", "how often a taut thread has gone through the target"),
    count(
        "wrap.passed_slack",
        "how often it was lost how a slack thread lies round the target, so that it may be through, or a thread came "
        "to be wound over more edges than are kept",
    ),
    count(
        "wrap.slipped",
        "how often a taut thread has slid over a corner, or its way has grown by a step from body to body",
    ),
    peak(
        "wrap.slip_loss",
        "J",
        "lost by threads that slid over a corner, less what they gained by steps from body to body",
    ),
    peak("wrap.impulse", "N.s", "sum of the sizes of all impulses of bent threads on the target so far"),
    output("wrap.stored", "J", "stored in bent threads beyond what they would as straight ones"),
    count("wrap_numbers", "threads of which the way is kept, and stretches of cord", "state"),
    count("wrap_listed", "threads near the target", "state"),
    count("wrap_next", "substep at which they are looked up again", "state"),
    count("wrap_faces", "faces of the body round which a way goes", "state"),
    count("wrap_lost", "whether a way went on from where it was known, could not, or is wound too far", "state"),
    count("wrap_chain[#]", "faces over which a way goes", "state", shape=(MOST + 1,)),
    count("wrap_pairs[#][#]", "faces on both sides and at both ends of its edges", "state", shape=(MOST, 4)),
    state("wrap_clear", "m", "how far a thread is from the target, at least"),
    state("wrap_haste", "m", "twice what any node moved against the target in a substep, at the last look"),
    state("wrap_substep", "s", "the substep then"),
    state("wrap_soft", "m", "by which the pieces of a way have no creases, while it is sought"),
    state("wrap_taken[#]", "m", "where a way that is not at rest crosses its edges", shape=(MOST,)),
    state("wrap_inset", "m", "how far below the surface ways lie"),
    *(
        state(f"wrap_{name}[#][#]", "1", text, shape=(rows, columns))
        for name, rows, columns, text in (
            ("planes", FACES, 4, "faces of the target, body axes: way out, and distance along it [m]"),
            ("flat", FACES, 3, "lines of the faces in the plane of a way, the last column in metres"),
            ("bends", MOST + 2, 3, "points of a way, body axes [m]"),
            ("pieces", MOST + 1, 4, "directions between them, body axes, and lengths [m]"),
            ("edges", MOST, 3, "directions of the edges, body axes"),
            ("feet", MOST, 3, "points on them, body axes [m]"),
            ("spans", MOST, 4, "where the way crosses them and both ends [m], and slope there"),
            ("steps", MOST, 4, "Newton's equations of a way"),
        )
    ),
    *(
        state(f"wrap_{name}[#]", unit, text, shape=(3,))
        for name, unit, text in (
            ("a", "m", "one end of a thread, body axes"),
            ("b", "m", "the other end, body axes"),
            ("turned", "m", "a bend from the target's centre of mass, frame axes"),
            ("moving", "m/s", "velocity of the surface there, less that of the centre of mass; a lever"),
            ("first", "1", "direction from the first bend to one end"),
            ("last", "1", "direction from the last bend to the other end"),
            ("line", "1", "direction of the straight thread"),
            ("up", "1", "direction across it, body axes"),
        )
    ),
)
"""Rows of threads that bend, with friction or without."""

EXTREMES = (
    Extreme(
        "threads wound on at 60 deg/s",
        "edges turn under the net faster than it closes: each bend wanders from edge to edge",
        "through",
        {"target.start_rate": (0.0, 0.0, math.radians(60.0))},
        chief=True,
    ),
    Extreme(
        "threads flung round edges at 10 m/s",
        "they meet the edges as fast as they stretch",
        "through",
        {"bullets.speed": 10.0},
    ),
)
"""Of threads that bend."""
