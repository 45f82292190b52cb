"""A net in which one thread alone is taut, from a corner to the knot beside it: two masses on a line."""

import math

import numpy as np

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from fmu_src.net_capture.planes import SHOWN, SHOWN_RATE, P, U, X
from tests.conftest import FREE
from tests.net_capture.memory import nodes, planes
from tests.net_capture.taut_net import PARAMETERS

MESH, THREAD = 1.0, 0.0002
"""Length [m] and mass [kg] of a thread, of twelve."""
PAIR = PARAMETERS | {"net.side": 2.0 * MESH, "net.mesh": MESH, "net.mass": 12.0 * THREAD, "net.fold_side": 0.5}
STIFFNESS = PARAMETERS["net.youngs_modulus"] * THREAD / (1440.0 * MESH) / MESH
PER_MASS = 1.0 / (PARAMETERS["bullets.mass"] + THREAD) + 1.0 / (1.5 * THREAD)
"""Of the two together [1/kg]: a corner has half of two threads and a bullet, the knot beside it half of three."""


def dashpot(ratio):
    """Of that thread [N s/m]: the ratio is that of a knot between two threads."""
    return 2.0 * ratio * math.sqrt(STIFFNESS * 2.0 * THREAD)


def matrix_of(ratio):
    """Of the motion s'' = -(1/ma + 1/mb)(k s + d s')."""
    return np.array([[0.0, 1.0], [-PER_MASS * STIFFNESS, -PER_MASS * dashpot(ratio)]])


def pair(scheme, stretch, rate, changes, terms=FREE):
    """That net: stretch [m] of the thread and its rate [m/s] at the start; all other knots rest half way."""
    net = Instance(MODEL, terms | {"solver": scheme}, PAIR | changes).initialise()
    memory, slots = planes(net), nodes(net)
    for first in (X, U, P):
        memory[first : first + 3, slots] = 0.0
    memory[X, slots[:2]] = -0.5 * (MESH + stretch), 0.5 * (MESH + stretch)
    for first in (U, P):
        memory[first, slots[:2]] = -0.5 * rate, 0.5 * rate
    return net


def state(net):
    """Stretch [m] and rate [m/s] of that thread as shown: rows of the leapfrog may be asleep."""
    memory, slots = planes(net), nodes(net)[:2]
    place, speed = memory[SHOWN, slots], memory[SHOWN_RATE, slots]
    return np.array([place[1] - place[0] - MESH, speed[1] - speed[0]])
