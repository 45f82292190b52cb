"""Threads that push each other apart: a spring and a dashpot where two of them are nearer than they are thick.

A thread is a round rod along the straight way between its nodes. Two that share no node, at their closest points g
deep in one another, push these apart with

    F = max(0, c g - b v),   g = r1 + r2 - |x1 - x2|,   v the speed at which the points part

along the line between them, c = m (pi / t)^2, b = 2 zeta sqrt(c m), m what both weigh to each other in their middles.
Each node takes its share of the force, as the point divides its thread: (1 - s) F and s F. So the forces sum to
nothing; and so do their moments, since the force acts along the line between its two points. c does not depend on where
they are, so the spring's force is the gradient of c g^2 / 2, and nothing is gained or lost by it.

In the middle of both threads a contact lasts 2 acos(zeta) / omega_d, omega = pi / t, and gives back
exp(-2 zeta acos(zeta) / sqrt(1 - zeta^2)) of the speed; at their ends both feel half as heavy.

Pairs are taken one after another, each seeing what those before it did in the same substep. The dashpot sees the
velocity half way through the kick with the kick's own share in it, so it takes energy at any step, however many touch
at one node. Where threads met within the last substep it counts from there on.

Pairs that overlap as the net is folded are left alone until they have parted. What goes through all the same, fast or
left alone, is counted as it turns the tetrahedron of its four ends inside out.

Valid    threads whose chord says where they are: a slack thread's loop does not touch. No friction: threads have no
         axis to turn about. Cord, bullets and vertex touch no thread
Source   law B between two threads (`contact/penalty.py`; Benvenuto and Lavagna (D-CoNe), eq. 4); ours
Checked  tests/net_capture/test_self_contact.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

from fmu_src.extremes import Extreme, times
from fmu_src.interface import Term, fault
from fmu_src.net_capture.formulas import longest_step
from fmu_src.net_capture.planes import FX, INVERSE_MASS, SHOWN, SHOWN_RATE, P, U, X
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.net_capture.self_contact.pairs import CLEAR, KICK, LEFT_OUT, NEW, RATE, TOUCHES, make_pairs
from fmu_src.net_capture.self_contact.segments import closest, pair_mass, passes, spring, stiffening
from fmu_src.rows import at_least_zero, count, output, peak, positive, state
from orbital.kernel import kernel

CHOSEN = {"solver": "leapfrog", "precision": "double", "substeps": "fixed"}
"""With which threads may touch: a force that sees what others did in the same substep, on lengths of micrometres."""
DURATION, RATIO = 5e-4, 0.5
"""Of a contact, and of its damping, unless the scene says otherwise: at 3 m/s two threads of Table 1, 0.5 mm thick, go
0.26 mm into each other and come back at 0.3 of it."""
THICKEST = 0.5
"""Of the shortest piece of thread: pieces that follow one another but one would touch for good."""

TOO_CROWDED = fault(
    "too_crowded",
    "self_contact.thickness",
    "more pairs of threads lie within reach of each other than there is room for",
)


class SelfContact(NamedTuple):
    """Kernels of threads that touch each other.

    words(p)              whole numbers of work memory
    start(p, work) -> fault   what overlaps now is left out; before the scheme begins
    pull(p, work)         add the forces, for a substep, and book what they take
    pull_shown(p, work)   the same for what is shown; what is stored there and what is taken
    fault(p)              code of what stopped the last substep, 0 for nothing
    """

    words: Any
    start: Any
    pull: Any
    pull_shown: Any
    fault: Any


def make(composition: Any) -> SelfContact:
    """Kernels for the composition's net and what is rigged to it."""
    for group, wanted in CHOSEN.items():
        if composition.terms[group] != wanted:
            raise ValueError(f"net_capture: threads that touch each other need {group} = {wanted!r}")
    from fmu_src.net_capture.schemes.asleep import make_asleep

    memory, rouse, now = composition.memory, composition.rouse, composition.clock.now
    node_plane, reals_of, own = memory.node_plane, memory.reals, memory.own
    bring = make_asleep(composition).bring
    first_plane, thread = composition.self_contact_plane, composition.net.thread
    pairs = make_pairs(composition, first_plane)
    list_first, go_on, stride = pairs.start, pairs.go_on, pairs.stride
    nodes, states, dues, ends, radii = pairs.nodes, pairs.states, pairs.dues, pairs.ends, pairs.radii
    too_crowded = composition.code(TOO_CROWDED.name)

    @kernel
    def copy(p, work, source, target):
        """Three node planes of the part into others; from -1: zeros.

        Checked  tests/net_capture/test_self_contact.py
        """
        for axis in range(3):
            to = node_plane(p, work, first_plane + target + axis)
            for node in range(p.node_slots):
                to[node] = node_plane(p, work, first_plane + source + axis)[node] if source >= 0 else 0.0

    @kernel
    def kick(p, work, node, share):
        """Change of a node's velocity so far in this substep by the force of this pair and a share of it [m/s].

        Checked  tests/net_capture/test_self_contact.py
        """
        light = share * node_plane(p, work, INVERSE_MASS)[node]
        for axis in range(3):
            force = p.self_contact_force[axis]
            node_plane(p, work, FX + axis)[node] += share * force
            node_plane(p, work, first_plane + NEW + axis)[node] += p.solver_substep * light * force

    @kernel
    def crowd(p, work, node, stiffness):
        """What touches at a node, as stiffness over mass [1/s2]; the most of any so far.

        Checked  tests/net_capture/test_self_contact.py
        """
        rate = node_plane(p, work, first_plane + RATE)
        rate[node] += stiffness * node_plane(p, work, INVERSE_MASS)[node]
        p.self_contact_rate = max(p.self_contact_rate, rate[node])

    @kernel
    def margin(p):
        """Bound of the net with what touches in truth, over the substep [1].

            h^2 (w + 2 e) / 4 + c h = 1,   e what touches beyond `stiffening`

        Checked  tests/net_capture/test_self_contact.py
        """
        _, dashpot, node = thread(p)
        damping = 8.0 * dashpot / node
        bound = p.solver_stability_bound
        beyond = max(0.0, p.self_contact_rate - stiffening(p.self_contact_duration))
        whole = max(0.0, 4.0 * (1.0 - damping * bound) / (bound * bound)) + 2.0 * beyond
        return longest_step(0.5 * whole, 0.5 * damping) / p.solver_substep

    def make_touch(place: int, rate: int, real: bool) -> Any:
        """Kernel of all pairs by the planes of positions and velocities from these on; `real`: for a substep."""

        @kernel
        def parting(p, work, node, axis):
            """Velocity of a node half way through its kick, as far as that is known [m/s].

            Checked  tests/net_capture/test_self_contact.py
            """
            last = node_plane(p, work, first_plane + KICK + axis)[node]
            new = node_plane(p, work, first_plane + NEW + axis)[node]
            return node_plane(p, work, rate + axis)[node] - 0.5 * last + new

        @kernel
        def through(p, work, a, b, c, d):
            """Whether two threads went through each other in the last substep.

            Checked  tests/net_capture/test_self_contact.py
            """
            h = p.solver_substep
            x, y, z = node_plane(p, work, X), node_plane(p, work, X + 1), node_plane(p, work, X + 2)
            u, v, w = node_plane(p, work, U), node_plane(p, work, U + 1), node_plane(p, work, U + 2)
            return passes(
                x[b] - x[a], y[b] - y[a], z[b] - z[a],
                x[d] - x[c], y[d] - y[c], z[d] - z[c],
                x[a] - x[c], y[a] - y[c], z[a] - z[c],
                h * (u[b] - u[a]), h * (v[b] - v[a]), h * (w[b] - w[a]),
                h * (u[d] - u[c]), h * (v[d] - v[c]), h * (w[d] - w[c]),
                h * (u[a] - u[c]), h * (v[a] - v[c]), h * (w[a] - w[c]),
            )  # fmt: skip

        @kernel
        def push(p, work, a, b, c, d, s, t, gap, depth, held):
            """Force of a pair that overlaps; the power that it takes [W].

            a, b, c, d    nodes of both threads
            s, t          shares of both at the closest points          [1]
            gap, depth    distance of these; how deep the threads are   [m]
            held          whether they touched a substep ago

            Checked  tests/net_capture/test_self_contact.py
            """
            h, force = p.solver_substep, p.self_contact_force
            inverse = node_plane(p, work, INVERSE_MASS)
            mass = pair_mass(inverse[a], inverse[b], inverse[c], inverse[d])
            stiffness = spring(mass, p.self_contact_duration)
            leaving = 0.0
            for axis in range(3):
                at = node_plane(p, work, place + axis)
                way = (1.0 - s) * at[a] + s * at[b] - (1.0 - t) * at[c] - t * at[d]
                going = (1.0 - s) * parting(p, work, a, axis) + s * parting(p, work, b, axis)
                going -= (1.0 - t) * parting(p, work, c, axis) + t * parting(p, work, d, axis)
                force[axis] = way / gap
                leaving += going * force[axis]
            counts = 2.0 * p.self_contact_damping_ratio * math.sqrt(stiffness * mass)
            if not held:
                since = min(h, depth / max(-leaving, depth / h))
                counts *= 0.5 + since / h
            feel = (1.0 - s) * (1.0 - s) * inverse[a] + s * s * inverse[b]
            feel += (1.0 - t) * (1.0 - t) * inverse[c] + t * t * inverse[d]
            elastic = stiffness * depth
            size = max(0.0, (elastic - counts * leaving) / (1.0 + 0.5 * h * counts * feel))
            for axis in range(3):
                force[axis] *= size
            kick(p, work, a, 1.0 - s)
            kick(p, work, b, s)
            kick(p, work, c, t - 1.0)
            kick(p, work, d, -t)
            if real:
                crowd(p, work, a, (1.0 - s) * stiffness)
                crowd(p, work, b, s * stiffness)
                crowd(p, work, c, (1.0 - t) * stiffness)
                crowd(p, work, d, t * stiffness)
                p.self_contact_force_max = max(p.self_contact_force_max, size)
                p.self_contact_depth = max(p.self_contact_depth, depth)
            p.self_contact_stored += 0.5 * stiffness * depth * depth
            return (elastic - size) * (leaving + 0.5 * h * size * feel)

        @kernel
        def touch(p, work):
            """All pairs of the list that may touch; the power that they take [W].

            Checked  tests/net_capture/test_self_contact.py
            """
            if p.self_contact_stirred > 0:
                copy(p, work, -1, NEW)
                p.self_contact_stirred = 0
            pair, state, due, at, size = nodes(p, work), states(p, work), dues(p, work), ends(p, work), radii(p, work)
            x, y, z = node_plane(p, work, place), node_plane(p, work, place + 1), node_plane(p, work, place + 2)
            way = p.self_contact_way
            if not real:
                way += stride(p, work, False)
            taken = 0.0
            touching = 0
            p.self_contact_stored = 0.0
            for n in range(p.self_contact_listed):
                if due[n] > way:
                    continue
                one, other = pair[n] >> 32, pair[n] & 0xFFFFFFFF
                a, b, c, d = at[2 * one], at[2 * one + 1], at[2 * other], at[2 * other + 1]
                if real:
                    reals, words = reals_of(work), own(p, work)
                    bring(p, reals, words, a // p.row_pitch)
                    bring(p, reals, words, b // p.row_pitch)
                    bring(p, reals, words, c // p.row_pitch)
                    bring(p, reals, words, d // p.row_pitch)
                    p.self_contact_looked += 1
                s, t, squared = closest(
                    x[b] - x[a], y[b] - y[a], z[b] - z[a],
                    x[d] - x[c], y[d] - y[c], z[d] - z[c],
                    x[a] - x[c], y[a] - y[c], z[a] - z[c],
                )  # fmt: skip
                gap = math.sqrt(squared)
                depth = size[2 * one] + size[2 * other] - gap
                if real:
                    reach = size[2 * one + 1] + size[2 * other + 1]
                    if gap <= 2.0 * p.self_contact_stride * reach:
                        p.self_contact_passed += through(p, work, a, b, c, d)
                    if depth <= 0.0:
                        if state[n] == LEFT_OUT:
                            p.self_contact_left_out -= 1
                        state[n] = CLEAR
                        due[n] = way - depth / reach
                        continue
                if depth <= 0.0 or state[n] == LEFT_OUT or gap == 0.0:
                    continue
                if real:
                    rouse(p, work, a)
                    rouse(p, work, b)
                    rouse(p, work, c)
                    rouse(p, work, d)
                taken += push(p, work, a, b, c, d, s, t, gap, depth, state[n] == TOUCHES)
                touching += 1
                p.self_contact_stirred = 1
                if real and state[n] != TOUCHES:
                    state[n] = TOUCHES
                    p.self_contact_touched += 1
                    if p.self_contact_first_time < 0.0:
                        p.self_contact_first_time = now(p)
            p.self_contact_pairs = touching
            return taken

        return touch

    touch_now, touch_shown = make_touch(X, P, True), make_touch(SHOWN, SHOWN_RATE, False)

    @kernel
    def stopped(p):
        """Code of what stopped the last substep, 0 for nothing.

        Checked  tests/net_capture/test_near_pairs.py
        """
        if p.self_contact_full > 0:
            p.fault_value = p.self_contact_thickness
            return too_crowded
        return 0

    @kernel
    def start(p, work):
        """What overlaps now is left out; a fault code or 0.

        Checked  tests/net_capture/test_self_contact.py
        """
        for plane in (KICK, NEW):
            copy(p, work, -1, plane)
        p.self_contact_touched = 0
        p.self_contact_passed = 0
        p.self_contact_lists = 0
        p.self_contact_pairs = 0
        p.self_contact_stirred = 0
        p.self_contact_kicked = 0
        p.self_contact_rate_max = 0.0
        p.self_contact_power = 0.0
        p.self_contact_first_time = -1.0
        p.self_contact_force_max = 0.0
        p.self_contact_depth = 0.0
        p.self_contact_booked = 0.0
        p.self_contact_stride = 0.0
        p.self_contact_margin_least = p.solver_stability_bound / p.solver_substep
        list_first(p, work)
        p.self_contact_left_out = 0
        for n in range(p.self_contact_listed):
            if states(p, work)[n] == LEFT_OUT:
                p.self_contact_left_out += 1
        p.self_contact_at_start = p.self_contact_left_out
        return stopped(p)

    @kernel
    def pull(p, work):
        """Add the forces of all pairs [N], and book what they take over the substep [J].

        Checked  tests/net_capture/test_self_contact.py
        """
        go_on(p, work)
        touched = p.self_contact_kicked
        if touched > 0:
            rate = node_plane(p, work, first_plane + RATE)
            for node in range(p.node_slots):
                rate[node] = 0.0
        p.self_contact_rate = 0.0
        p.self_contact_booked += p.solver_substep * touch_now(p, work)
        p.self_contact_kicked = p.self_contact_pairs
        if touched > 0 or p.self_contact_pairs > 0:
            copy(p, work, NEW, KICK)
        if p.self_contact_rate > p.self_contact_rate_max:
            p.self_contact_rate_max = p.self_contact_rate
            p.self_contact_margin_least = min(p.self_contact_margin_least, margin(p))

    @kernel
    def pull_shown(p, work):
        """The same for what is shown: energy stored [J], and what is taken [W].

        Checked  tests/net_capture/test_self_contact.py
        """
        p.self_contact_power = touch_shown(p, work)

    return SelfContact(pairs.words, start, pull, pull_shown, stopped)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """Schemes, numbers and substeps that it does not go with, and threads too thick for their length."""
    told = {"solver": "solver.scheme", "precision": "solver.precision", "substeps": "solver.substeps"}
    for group, wanted in CHOSEN.items():
        if scene.terms[group] != wanted:
            expected = f'must be "{wanted}" with threads that touch each other, [capture.self_contact]'
            yield Refusal(told[group], f'"{scene.terms[group]}"', expected)
    values = scene.values
    shortest = scene.parts["net"].checks.finest(values)[0] / values["net.segments"]
    if values["self_contact.thickness"] > THICKEST * shortest:
        expected = (
            f"must be at most {THICKEST * shortest:.3g} m, half the shortest piece of thread: two pieces on both sides of "
            "a third one would touch for good"
        )
        yield Refusal("self_contact.thickness", f"{values['self_contact.thickness']:g} m", expected)


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
        "how long two threads that meet in their middles touch, without damping: 0.5 ms hold threads of 0.5 mm apart up "
        "to about 6 m/s",
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
    count("self_contact.passed", "how often two threads have gone through each other, left out or not"),
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
    state("self_contact_rate", "1/s2", "stiffness over mass that touches at a node in this substep, at most"),
    state("self_contact_rate_max", "1/s2", "the same in any substep so far"),
    state("self_contact_power", "W", "what contact between threads takes now"),
    state("self_contact_booked", "J", "taken by it up to half a substep back"),
)

PART = Term(
    "threads that push each other apart where they touch",
    ROWS,
    excludes=("wrap", "break", "table"),
    faults=(TOO_CROWDED,),
    make=make,
    refuses=refuses,
    extremes=(
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
    ),
)
