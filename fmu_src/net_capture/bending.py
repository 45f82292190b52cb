"""Threads that resist being bent, at their knots and where they are cut into pieces.

Two pieces of the net's thread that go straight on in the net as meant are a joint, over a node within a thread or
across a knot. With the directions of its pieces, which a slack one has by the share of its length that its ends span,

    t = r / max(|r|, l),   e = t2 - t1,   |e| = 2 sin(theta / 2) where both are taut,   s = (t1 + t2) / |t1 + t2|

it stores energy and takes power as

    E = B / (2 L) e.e,   L = (l1 + l2) / 2
    D = tau B / L q.q,   q = (s.t1) dt2/dt - (s.t2) dt1/dt without its part along s, less (w.s) t1 x t2

    B    flexural rigidity, E I of a solid thread     [N m2]    r, l   from end to end of a piece, its unloaded length
    tau  damping time, of a solid with E (1 + tau d/dt)   [s]   w      turn of the net as a whole                [rad/s]

and pulls the nodes by the gradients of both. q is de/dt of a thread that is nearly straight; it sees neither how fast
the joint turns in its plane nor how fast the net turns as one body. Where the plane in which it is bent turns about the
thread otherwise than the net, the thread, which does not, would be twisted; that moment, of second order in e, goes to
the net as a whole, as to a rigid body. So the forces sum to nothing, and so do their moments. A stretch of taut pieces
changes neither E nor D.

Valid    threads that are straight when nothing bends them; no twist. 2 (1 - cos theta) is theta^2 to 1 % up to 20 deg.
         What a slack piece stores between its ends is left out. Of a joint that is bent back on itself D vanishes
Source   a chain of hinges for Euler's beam, of second order in the length of its pieces; the directions of slack
         pieces, and the dashpot, are ours
Checked  tests/net_capture/test_bending.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from fmu_src.extremes import Extreme, times
from fmu_src.interface import Term
from fmu_src.net_capture.joints import JOINT_WORDS, make_joints
from fmu_src.net_capture.planes import (
    FX,
    LENGTH,
    SHOWN,
    SHOWN_RATE,
    STRIP_NUMBERS,
    THREAD_MASS,
    P,
    X,
)
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.net_capture.whole_turn import ROWS as TURNING
from fmu_src.net_capture.whole_turn import make_whole_turn
from fmu_src.rows import at_least_zero, count, output, positive, state
from orbital.kernel import kernel
from orbital.vectors import cross, dot

SCHEMES = ("leapfrog", "rk4")
"""That take this force at a step within its bound."""
STEEPEST = 2.0 / math.sqrt(3.0)
"""The largest eigenvalue of the second derivatives of 1 - cos by both ends of a direction, over that at no angle."""


class Bending(NamedTuple):
    """Kernels of bending.

    words(p)               whole numbers of work memory
    find(p, work)          the joints of the net laid out, and what they ask of the substep
    pull(p, work)          add their forces, for a substep; their power into `bending_power`
    pull_shown(p, work)    the same for what is shown; what they store into `bending_energy`
    """

    words: Any
    find: Any
    pull: Any
    pull_shown: Any


@kernel
def stiffening(rigidity, length, mass):
    """What bending adds at a node at most, see `formulas.longest_step` [1/s2].

        omega^2 <= 2/sqrt(3) 16 B / (l^3 m),   half of it

    rigidity   B    flexural                                [N m2]
    length     l    of the shortest piece of thread         [m]
    mass       m    of the lightest                         [kg]

    A joint of pieces no shorter than l adds at most B/l (1, 2, 1)/l 4/l to the row sums of its nodes (Gershgorin).
    A node is in the middle of one joint and at the ends of two for each two half pieces that hang on it, at most. Of a
    joint bent far the second derivatives are larger by 2/sqrt(3).

    Checked  tests/net_capture/test_bending.py
    """
    return 0.5 * STEEPEST * 16.0 * rigidity / (length * length * length * mass)


def stiffening_of(values: Any, net: Any) -> tuple[float, float]:
    """The same [1/s2] with the dashpots' [1/s], of values by FMI name; `net` are the checks of the net."""
    from fmu_src.implied import formula

    pieces = values["net.segments"]
    length, mass = net.finest(values)
    found = float(formula(stiffening)(values["bending.rigidity"], length / pieces, mass / pieces))
    return found, found * values["bending.damping_time"]


def make(composition: Any) -> Bending:
    """Kernels for the composition's net."""
    if composition.terms["solver"] not in SCHEMES:
        raise ValueError(f"net_capture: bending needs one of the schemes {SCHEMES}")
    memory, rouse_all = composition.memory, composition.rouse_all
    node_plane, properties = memory.node_plane, memory.properties
    words, list_joints, joints, lengths = make_joints(composition)

    @kernel
    def find(p, work):
        """List all joints, and what the stiffest may ask of the substep.

        Checked  tests/net_capture/test_bending.py
        """
        p.bending_joints = list_joints(p, work)
        numbers = properties(p, work)
        shortest = math.inf
        lightest = math.inf
        for q in range(0, STRIP_NUMBERS * p.net_strips, STRIP_NUMBERS):
            shortest = min(shortest, numbers[q + LENGTH])
            lightest = min(lightest, numbers[q + THREAD_MASS])
        p.bending_stiffening = stiffening(p.bending_rigidity, shortest, lightest)

    def make_pull(place: int, rate: int, wake: bool) -> Any:
        """Kernel of the forces by the planes of positions and velocities from these on; `wake`: rows may sleep."""
        measure_turn, load_whole = make_whole_turn(composition, place, rate)

        @kernel
        def direct(p, work, one, other, length, towards, going):
            """Direction of a piece into `towards`, and its rate into `going` [1/s]; the larger of length and way [m],
            negative where it is slack.

            Checked  tests/net_capture/test_bending.py
            """
            squared = 0.0
            along = 0.0
            for axis in range(3):
                at = node_plane(p, work, place + axis)
                by = node_plane(p, work, rate + axis)
                towards[axis] = np.float64(at[other]) - np.float64(at[one])
                going[axis] = np.float64(by[other]) - np.float64(by[one])
                squared += towards[axis] * towards[axis]
                along += towards[axis] * going[axis]
            taut = squared > length * length
            reach = math.sqrt(squared) if taut else length
            for axis in range(3):
                towards[axis] /= reach
                going[axis] /= reach
                if taut:
                    going[axis] -= along / squared * towards[axis]
            return reach if taut else -reach

        @kernel
        def push(p, work, one, other, reach, towards, moment, sign):
            """Forces of one piece on its two nodes [N]: the moment's gradient by the way between them.

            Checked  tests/net_capture/test_bending.py
            """
            along = 0.0
            if reach > 0.0:
                along = moment[0] * towards[0] + moment[1] * towards[1] + moment[2] * towards[2]
            for axis in range(3):
                force = sign * (moment[axis] - along * towards[axis]) / abs(reach)
                node_plane(p, work, FX + axis)[one] += force
                node_plane(p, work, FX + axis)[other] -= force

        @kernel
        def pull(p, work):
            """Add the forces of all joints [N], their power [W] into `bending_power`; what they store [J] is returned.

            Checked  tests/net_capture/test_bending.py
            """
            if wake:
                rouse_all(p, work)
            found, long = joints(p, work), lengths(p, work)
            first, second = p.bending_vectors[0:3], p.bending_vectors[3:6]
            first_rate, second_rate = p.bending_vectors[6:9], p.bending_vectors[9:12]
            moment, middle, normal = p.bending_vectors[12:15], p.bending_vectors[15:18], p.bending_vectors[18:21]
            damped = p.bending_damping_time > 0.0
            if damped:
                damped = measure_turn(p, work)
            stored = 0.0
            power = 0.0
            for n in range(p.bending_joints):
                j = JOINT_WORDS * n
                one = found[j]
                node = found[j + 1]
                other = found[j + 2]
                stiffness = 2.0 * p.bending_rigidity / (long[j + 3] + long[j + 4])
                near = direct(p, work, one, node, long[j + 3], first, first_rate)
                far = direct(p, work, node, other, long[j + 4], second, second_rate)
                squared = 0.0
                length = 0.0
                for axis in range(3):
                    moment[axis] = stiffness * (second[axis] - first[axis])
                    squared += moment[axis] * (second[axis] - first[axis])
                    middle[axis] = first[axis] + second[axis]
                    length += middle[axis] * middle[axis]
                stored += 0.5 * squared
                push(p, work, one, node, near, first, moment, -1.0)
                push(p, work, node, other, far, second, moment, 1.0)
                if damped and length > 0.0:
                    for axis in range(3):
                        middle[axis] /= math.sqrt(length)
                    at_first = dot(middle, first)
                    at_second = dot(middle, second)
                    cross(normal, first, second)
                    along = at_first * dot(middle, second_rate) - at_second * dot(middle, first_rate)
                    turn = dot(middle, p.turn_rate)
                    dashpot = p.bending_damping_time * stiffness
                    twist = 0.0
                    for axis in range(3):
                        growth = at_first * second_rate[axis] - at_second * first_rate[axis]
                        growth -= along * middle[axis] + turn * normal[axis]
                        moment[axis] = dashpot * growth
                        power += moment[axis] * growth
                        twist += moment[axis] * normal[axis]
                    for axis in range(3):
                        p.turn_moment[axis] += twist * middle[axis]
                        first_rate[axis] = at_second * moment[axis]
                        second_rate[axis] = at_first * moment[axis]
                    push(p, work, one, node, near, first, first_rate, -1.0)
                    push(p, work, node, other, far, second, second_rate, 1.0)
            if damped:
                load_whole(p, work)
            p.bending_power = power
            return stored

        return pull

    pull_now, pull_there = make_pull(X, P, True), make_pull(SHOWN, SHOWN_RATE, False)

    @kernel
    def pull(p, work):
        """Add the forces of all joints [N], and their power [W] into `bending_power`.

        Checked  tests/net_capture/test_bending.py
        """
        pull_now(p, work)

    @kernel
    def pull_shown(p, work):
        """The same for what is shown, and what they store [J].

        Checked  tests/net_capture/test_bending.py
        """
        p.bending_energy = pull_there(p, work)

    return Bending(words, find, pull, pull_shown)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """A scheme that goes beyond the bound of an explicit force."""
    scheme = scene.terms["solver"]
    if scheme not in SCHEMES:
        allowed = " or ".join(f'"{name}"' for name in SCHEMES)
        yield Refusal("solver.scheme", f'"{scheme}"', f"knows no threads that resist bending; it must be {allowed}")


PART = Term(
    "threads that resist being bent, between their pieces and across the knots at which they go straight on",
    (
        positive(
            "bending.rigidity",
            "N.m2",
            "flexural rigidity of a thread: of Table 1's as 1690 loose filaments of 12 um (DuPont's Kevlar guide), "
            "n E pi d^4 / 64 of these; were it solid, 2e-4",
            1.2e-7,
        ),
        at_least_zero(
            "bending.damping_time", "s", "tau in E (1 + tau d/dt): a swing at omega has the ratio omega tau/2", 0.0
        ),
        count("bending.joints", "where two pieces of thread go straight on"),
        output("bending.energy", "J", "stored in bent threads, part of energy.elastic"),
        output("bending.dissipated", "J", "taken by the damping of their bending so far"),
        state("bending_stiffening", "1/s2", "half the stiffness over mass that bending may add at a node"),
        state("bending_power", "W", "what the damping of bending takes now"),
        state("bending_loss", "J", "taken by it up to half a substep back"),
        state("bending_vectors[#]", "1", "directions of two pieces, their rates, and what follows", shape=(21,)),
        *TURNING,
    ),
    excludes=("wrap", "break"),
    make=make,
    refuses=refuses,
    extremes=(
        *(
            Extreme(
                f"threads {factor:g} times as hard to bend",
                "from yarn to wire: the substep follows the stiffest joint",
                "energy_gained",
                {"bending.rigidity": times("bending.rigidity", factor)},
                chief=factor == 1e3,
            )
            for factor in (1e-3, 1e3)
        ),
        Extreme(
            "bending that is damped for 0.1 s",
            "dashpots far above critical at the shortest waves",
            "energy_lost",
            {"bending.damping_time": 0.1},
        ),
    ),
)
