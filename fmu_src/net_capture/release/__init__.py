"""How the net leaves the chaser beside the plain shot: bullets each in its own way, a net or a chaser that turns, and
ejectors whose own data give the bullets' speed.

The chaser is a point with a mass: its attitude is held. What it would turn by is booked, `chaser.spin`, and is part of
the angular momentum of all bodies.
"""

from __future__ import annotations

from fmu_src.rows import state, vector

BOOKED = (
    vector(
        "chaser.spin",
        "N.m.s",
        "angular momentum that the release has given the chaser about its centre of mass; what holds its attitude "
        "takes it up",
    ),
    state("chaser_turned[#]", "N.m.s", "the same as far back as velocities are kept", shape=(3,)),
)
"""Rows of every part that turns the chaser. So do canisters, and nets of one's own: their bullets may lie unevenly
round the shot's axis."""
