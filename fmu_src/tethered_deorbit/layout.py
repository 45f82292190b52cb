"""Where things lie: the components of the state, and the work memory of an instance.

The state is one centre of mass and one relative vector (target minus chaser), inertial axes, the attitude and rate of
every body that turns, and what they gather:

    0:3 R   centre of mass [m]      3:6 V   its velocity [m/s]      6:9 rho   relative [m]      9:12 its rate [m/s]
    then, for each body that turns, q attitude (4) [-], body to inertial axes, and w its rate (3) [rad/s], body axes
    then, with attitude control, h momentum of the wheels (3) [N m s], body axes
    then, with an engine or burns, the propellant used [kg]
    then what the law of the line moves; of a line of nodes, place and velocity of each
    then J  impulse of the line [N s]: dJ/dt is the tension that the equations have in them
    last    what the law of the line gathers
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from fmu_src.integrators.scheme import AdaptiveScheme

PAIR = 12
"""Components of the motion of the two centres of mass, four vectors. Those of the bodies that turn lie behind."""
ATTITUDE = 7
"""Components of one body that turns."""
CAPACITY = 32
"""Nodes that there is room for. Room costs: some two per cent of a node that is used for each that is not."""
WIDTH = 6
"""Components of a node: place and velocity."""
MOVED, GATHERED = WIDTH * CAPACITY, 1
"""Components of all, and the heat of the dashpots."""


class StateLayout(NamedTuple):
    """Components of the state.

    moving      how many the equations depend on: all before J
    wheels      place of h, or what comes after it where there is none
    spent       place of the propellant, or of what comes after it where none is kept
    reel        place of what the law of the line moves
    impulse     place of J; behind it what that law gathers
    size        how many there are
    """

    moving: int
    wheels: int
    spent: int
    reel: int
    impulse: int
    size: int


def state_layout(
    turning: int, wheels: bool = False, spends: bool = False, moved: int = 0, gathered: int = 0
) -> StateLayout:
    """The components of a pair of which so many bodies turn, 0 to 2, with wheels or not, that keeps what its thruster
    spends or not, on a line whose law has so many of its own."""
    own = PAIR + ATTITUDE * turning
    spent = own + 3 * wheels
    reel = spent + spends
    return StateLayout(reel + moved, own, spent, reel, reel + moved, reel + moved + 1 + gathered)


def layout_of(terms: Mapping[str, str], moved: int, gathered: int) -> StateLayout:
    """The components of a pair with these terms, on a line whose law has so many of its own."""
    turning = sum(terms[role] != "point" for role in ("target", "chaser"))
    if "lumped" in terms:
        moved, gathered = moved + MOVED, gathered + GATHERED
    gathered += "friction" in terms
    return state_layout(turning, "aocs" in terms, "burn" in terms or "engine" in terms, moved, gathered)


class Places(NamedTuple):
    """Where things lie in the work memory.

    size        components of a state
    moving      how many of them the equations depend on
    impulse     place of J among them
    begin       state at the begin of the current step
    end         state at its end
    here        state at the point last asked of the dense output
    slope       rate of that state
    low, high   errors of a step
    stages      stage memory of the scheme, as long as it wants
    last        in it, derivative at the end of the current step
    dense       dense output of that step
    total       length of the memory, in doubles
    """

    size: int
    moving: int
    impulse: int
    begin: int
    end: int
    here: int
    slope: int
    low: int
    high: int
    stages: int
    last: int
    dense: int
    total: int


def places_of(state: StateLayout, scheme: AdaptiveScheme) -> Places:
    """The places for one state and one scheme."""
    begin, end, here, slope, low, high, stages = (row * state.size for row in range(7))
    dense = stages + scheme.stages
    total = dense + scheme.dense
    return Places(
        state.size,
        state.moving,
        state.impulse,
        begin,
        end,
        here,
        slope,
        low,
        high,
        stages,
        stages + scheme.last,
        dense,
        total,
    )
