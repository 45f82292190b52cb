"""What a scene and an FMU tell of threads that touch each other, what their kernels scribble on, and their extremes."""

from __future__ import annotations

from fmu_src.extremes import Extreme, times
from fmu_src.net_capture.self_contact.pairs import BUCKETS
from fmu_src.rows import at_least_zero, count, output, peak, positive, state

DURATION, RATIO = 5e-4, 0.5
"""Of a contact, and of its damping, unless the scene says otherwise: at 3 m/s two threads of Table 1, 0.5 mm thick, go
0.26 mm into each other and come back at 0.3 of it."""
ROWS = (
    at_least_zero(
        "self_contact.thickness",
        "m",
        "how near threads come before they push, centre to centre; zero: as thick as each is, solid and round",
        0.0,
        display_unit="mm",
    ),
    positive(
        "self_contact.duration",
        "s",
        "how long two threads that meet in their middles touch, without damping: 0.5 ms hold threads of 0.5 mm apart "
        "up to about 5 m/s",
        DURATION,
        display_unit="ms",
    ),
    at_least_zero(
        "self_contact.damping_ratio",
        "1",
        "of two threads on the spring between them: 0.5 gives back 0.3 of their speed; ours",
        RATIO,
        10.0,
    ),
    count("self_contact.pairs", "pairs of threads that touch now"),
    count("self_contact.touched", "how often two threads have come to touch"),
    count(
        "self_contact.passed",
        "how often two threads have gone through each other up to the last substep, left out or not",
    ),
    count("self_contact.left_out", "pairs that have overlapped since the start and are left alone until they part"),
    count("self_contact.at_start", "how many these were at the start"),
    peak("self_contact.first_time", "s", "when two threads first touched, since the shot; -1 before"),
    peak("self_contact.force_max", "N", "largest force between two threads so far"),
    peak("self_contact.depth", "m", "deepest that two threads have overlapped so far"),
    output("self_contact.stored", "J", "in the springs between threads, part of energy.elastic"),
    output("self_contact.loss", "J", "taken by contact between threads so far"),
    peak(
        "self_contact.margin_least",
        "1",
        "least stability bound of the net with what touched in truth, over the substep; below 1 it was too long",
    ),
    count("self_contact.lists", "how often the list of pairs has been made anew"),
    count("self_contact.listed", "pairs on it now"),
    count("self_contact_count", "threads that may touch", "state"),
    count("self_contact_bucket[#]", "the first pair due in each share of the way", "state", shape=(BUCKETS,)),
    count("self_contact_gone", "substep up to which the way has gone on", "state"),
    count("self_contact_reached", "bucket of the present way", "state"),
    count("self_contact_looked", "pairs looked at since the list was made", "state"),
    count("self_contact_swept", "boxes compared for it", "state"),
    count("self_contact_full", "whether there was no room for it", "state"),
    count("self_contact_kicked", "pairs that touched in the last substep", "state"),
    count("self_contact_stirred", "whether velocities so far in a substep are other than zero", "state"),
    state("self_contact_life", "1", "substeps for which a list is meant to last"),
    state("self_contact_way", "1", "how much of their reach nodes may have gone since the list was made"),
    state("self_contact_stride", "1", "the same in the last substep"),
    state("self_contact_drift[#]", "m/s", "mean velocity of all nodes as the list was made", shape=(3,)),
    state("self_contact_force[#]", "N", "of the present pair on its first thread", shape=(3,)),
    state("self_contact_normal[#]", "1", "its direction", shape=(3,)),
    state("self_contact_rate", "1/s2", "stiffness over mass that touches at a node in this substep, at most"),
    state("self_contact_rate_max", "1/s2", "the same in any substep so far"),
    state("self_contact_power", "W", "what contact between threads takes now"),
    state("self_contact_booked", "J", "taken by it up to half a substep back"),
)
"""Rows of the part."""

EXTREMES = (
    *(
        Extreme(
            f"threads that touch {factor:g} times as long",
            "springs between threads ten times softer, or a hundred times stiffer: the substep follows",
            "energy_gained",
            {"self_contact.duration": times("self_contact.duration", factor)},
            chief=factor < 1.0,
        )
        for factor in (0.1, 3.0)
    ),
    *(
        Extreme(
            f"threads that touch with a damping ratio of {ratio:g}",
            "threads that give all back, or nothing",
            "energy_gained",
            {"self_contact.damping_ratio": ratio},
            chief=ratio == 0.0,
        )
        for ratio in (0.0, 10.0)
    ),
    Extreme(
        "threads as thick as ropes",
        "many pairs of the folded net overlap, and part as it opens",
        "energy_gained",
        {"self_contact.thickness": 0.02},
    ),
)
"""The ends of their range."""
