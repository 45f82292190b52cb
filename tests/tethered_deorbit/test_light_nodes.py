"""A light node that goes to and fro on a slack line, undamped: what it takes of a snap, and that this goes with its
mass, slowly."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.interface import MODEL
from tests.plain import plain
from tests.tethered_deorbit import lumped as pair
from tests.validation import Validated, closed_form

__all__ = ["plain"]

PIECE, SPEED, SLACK = pair.LENGTH / 2.0, 0.1, 0.02
FIRM = pair.AXIAL / PIECE
ACROSS = 20.0 * PIECE * SPEED / math.sqrt(PIECE**2 - (PIECE - 0.5 * SLACK) ** 2)
"""Speed of the node across the line [m/s]: it goes to and fro often while the room that the line leaves it narrows."""


def action(energy: float, chord: float, mass: float) -> float:
    """Of a node [J s] that goes to and fro across the middle of the line, between attachments a chord [m] apart.

    4 integral of sqrt(2 m (E - V)) dy from 0 to where V = E,   V = k (|(s/2, y)| - l)^2 where that stretches
    """

    def held(y: float) -> float:
        return FIRM * max(0.0, math.hypot(0.5 * chord, y) - PIECE) ** 2

    turn: float = brentq(lambda y: held(y) - energy, 0.0, 2.0 * PIECE)
    angles = (np.arange(2000) + 0.5) * (0.25 * math.pi / 1000.0)
    speeds = [math.sqrt(max(0.0, 2.0 * mass * (energy - held(turn * math.sin(angle))))) for angle in angles]
    return float(4.0 * turn * np.mean(speeds * np.cos(angles)) * 0.5 * math.pi)


def lost_to(mass: float) -> float:
    """Part of the parting speed [-] that a pair has lost to a node of this mass [kg] as the line gets tight.

    The action stays as the room narrows, so that the node's energy E grows: m_r (v^2 - v'^2)/2 = E - m u^2/2.

    Source   the adiabatic invariant of one degree of freedom; for V ~ y^4 it makes E go as m^(2/3)
    """
    begins = 0.5 * mass * ACROSS**2
    kept = action(begins, pair.LENGTH - SLACK, mass)
    energy: float = brentq(lambda e: action(e, pair.LENGTH, mass) - kept, begins, pair.REDUCED * SPEED**2)
    return 1.0 - math.sqrt(1.0 - 2.0 * (energy - begins) / (pair.REDUCED * SPEED**2))


def found_lost(mass: float, make: Any) -> float:
    """The same of the model, by what makes a line of nodes."""
    chord = pair.LENGTH - SLACK
    i = make(1, mass / (pair.SECTION * PIECE), pair.apart(chord, 0.0, SPEED, 0.0))
    pair.put_nodes(i, np.array([[0.0, -0.5 * chord, 0.0]]), np.array([[ACROSS, -0.5 * SPEED, 0.0]]))
    while not i["tether.tug_count"]:
        i.step(0.1 * SLACK / SPEED)
    return 1.0 - i["tug[1].speed"] / SPEED


@pytest.mark.usefixtures("plain")
def test_what_a_light_node_takes_is_what_its_action_makes(validated: Validated) -> None:
    what = "one light node to and fro on a slack line: part of the parting speed that it takes"
    source = closed_form("the action of the node stays")
    validated(source, what, found_lost(1e-5, pair.lumped), lost_to(1e-5), "1", rel=5e-2)


def compiled(count: int, density: float, values: Mapping[str, Any]) -> Instance:
    """The same pair by compiled kernels."""
    i = Instance(MODEL, pair.TERMS)
    for name, value in (pair.VALUES | {"lumped.nodes": count, "lumped.density": density} | dict(values)).items():
        if isinstance(value, tuple):
            i.array(name)[:] = value
        else:
            i[name] = value
    return i.initialise()


@pytest.mark.evidence
def test_what_a_light_node_takes_goes_as_two_thirds_of_its_mass() -> None:
    """Not as the mass, and nothing is left over without it: four masses from 3 mg to 3 ug, the order rising to that."""
    masses = [3e-6, 3e-7, 3e-8, 3e-9]
    found = [found_lost(mass, compiled) for mass in masses]
    assert found == pytest.approx([lost_to(mass) for mass in masses], rel=5e-2)  # 1/20, how slowly the room narrows
    orders = np.diff(np.log(found)) / np.diff(np.log(masses))
    assert np.all(np.diff(orders) > 0.0)
    assert orders[-1] == pytest.approx(2.0 / 3.0, abs=0.05)
    assert found[-1] < 3e-4


@pytest.mark.evidence
def test_table_2_has_its_first_tug_back_as_the_node_gets_light() -> None:
    """A node of Kevlar, of a third and of a tenth of that, undamped: time as the mass, speed as its power 2/3, and the
    peak scattered by what the node's motion at that instant adds, within what it has taken."""
    terms = {"reel": "locked", "thrust": "along_track"}
    own = {"tether.damping_ratio": 0.0}
    massless = Instance(MODEL, terms, own).initialise()
    massless.step(1125.0)
    late, slow = [], []
    shares = (1.0, 0.3, 0.1)
    for share in shares:
        i = Instance(MODEL, terms | {"lumped": "nodes"}, own | {"lumped.nodes": 1, "lumped.density": 1440.0 * share})
        i.initialise().step(1125.0)
        late.append(i["tug[1].time"] - massless["tug[1].time"])
        slow.append(1.0 - i["tug[1].speed"] / massless["tug[1].speed"])
        assert abs(i["tug[1].peak"] / massless["tug[1].peak"] - 1.0) < slow[-1]
    orders = [np.polyfit(np.log(shares), np.log(what), 1)[0] for what in (late, slow)]
    assert orders[0] == pytest.approx(1.0, abs=0.05)
    assert orders[1] == pytest.approx(2.0 / 3.0, abs=0.05)
