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

from fmu_src.interface import Term, fault
from fmu_src.net_capture.formulas import longest_step
from fmu_src.net_capture.planes import SHOWN, SHOWN_RATE, P, U, X
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.net_capture.self_contact.pairs import CLEAR, LEFT_OUT, TOUCHES, make_pairs
from fmu_src.net_capture.self_contact.pushing import make_copy, make_push
from fmu_src.net_capture.self_contact.reaches import BEFORE, HELD, KICK, NEW, RATE
from fmu_src.net_capture.self_contact.rows import EXTREMES, ROWS
from fmu_src.net_capture.self_contact.segments import closest, passes, stiffening
from orbital.kernel import kernel

CHOSEN = {"solver": "leapfrog", "precision": "double", "substeps": "fixed"}
"""With which threads may touch: a force that sees what others did in the same substep, on lengths of micrometres."""
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
    room, list_first, go_on, bucket = make_pairs(composition)
    nodes, states, dues, ends, radii = room.nodes, room.states, room.dues, room.ends, room.radii
    following = room.following
    copy = make_copy(composition)
    too_crowded = composition.code(TOO_CROWDED.name)

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

    @kernel
    def book(p, work):
        """Go on with the list; and book what the dashpots took in the last substep [J], by the mean of the velocities
        before and after all of its kicks, which are known now.

        Checked  tests/net_capture/test_self_contact.py
        """
        if p.self_contact_gone == p.grid:
            return
        if p.self_contact_kicked > 0:
            for axis in range(3):
                held = node_plane(p, work, first_plane + HELD + axis)
                before = node_plane(p, work, first_plane + BEFORE + axis)
                after = node_plane(p, work, U + axis)
                for node in range(p.node_slots):
                    p.self_contact_booked += 0.5 * p.solver_substep * held[node] * (before[node] + after[node])
                    held[node] = 0.0
        go_on(p, work)

    def make_touch(place: int, rate: int, real: bool) -> Any:
        """Kernel of all pairs by the planes of positions and velocities from these on; `real`: for a substep."""
        push = make_push(composition, place, rate, real)

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
        def look(p, work, n, way):
            """One pair of the list; the power that it takes [W]. Apart, it is due later.

            Checked  tests/net_capture/test_self_contact.py
            """
            at, size, state = ends(p, work), radii(p, work), states(p, work)
            x, y, z = node_plane(p, work, place), node_plane(p, work, place + 1), node_plane(p, work, place + 2)
            pair = nodes(p, work)[n]
            one, other = pair >> 32, pair & 0xFFFFFFFF
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
                if p.grid > 0 and gap <= 2.0 * p.self_contact_stride * reach:
                    p.self_contact_passed += through(p, work, a, b, c, d)
                if depth <= 0.0:
                    if state[n] == LEFT_OUT:
                        p.self_contact_left_out -= 1
                    state[n] = CLEAR
                    dues(p, work)[n] = way - depth / reach
            if depth <= 0.0 or state[n] == LEFT_OUT or gap == 0.0:
                return 0.0
            if real:
                rouse(p, work, a)
                rouse(p, work, b)
                rouse(p, work, c)
                rouse(p, work, d)
            taken = push(p, work, a, b, c, d, s, t, gap, depth, state[n] == TOUCHES)
            p.self_contact_pairs += 1
            p.self_contact_stirred = 1
            if real and state[n] != TOUCHES:
                state[n] = TOUCHES
                p.self_contact_touched += 1
                if p.self_contact_first_time < 0.0:
                    p.self_contact_first_time = now(p)
            return taken

        @kernel
        def touch(p, work):
            """All pairs that are due; the power that they take [W]. What stays due stands in the bucket of now, in the
            order in which it was looked at.

            Checked  tests/net_capture/test_self_contact.py
            """
            if p.self_contact_stirred > 0:
                copy(p, work, -1, NEW)
                p.self_contact_stirred = 0
            book(p, work)
            way = p.self_contact_way
            taken = 0.0
            p.self_contact_pairs = 0
            p.self_contact_stored = 0.0
            due, after = dues(p, work), following(p, work)
            present = bucket(way)
            first = -1
            last = -1
            for b in range(p.self_contact_reached, present + 1):
                n = p.self_contact_bucket[b]
                if real:
                    p.self_contact_bucket[b] = -1
                while n >= 0:
                    coming = after[n]
                    if due[n] <= way:
                        taken += look(p, work, n, way)
                    if real:
                        later = bucket(due[n])
                        if later > present:
                            after[n] = p.self_contact_bucket[later]
                            p.self_contact_bucket[later] = n
                        else:
                            after[n] = -1
                            if last < 0:
                                first = n
                            else:
                                after[last] = n
                            last = n
                    n = coming
            if real:
                p.self_contact_bucket[present] = first
                p.self_contact_reached = present
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
        for plane in (KICK, NEW, HELD, BEFORE):
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
        touched = p.self_contact_kicked
        if touched > 0:
            rate = node_plane(p, work, first_plane + RATE)
            for node in range(p.node_slots):
                rate[node] = 0.0
        p.self_contact_rate = 0.0
        touch_now(p, work)
        p.self_contact_kicked = p.self_contact_pairs
        if touched > 0 or p.self_contact_pairs > 0:
            copy(p, work, NEW, KICK)
            for axis in range(3):
                before = node_plane(p, work, first_plane + BEFORE + axis)
                for node in range(p.node_slots):
                    before[node] = node_plane(p, work, U + axis)[node]
        if p.self_contact_rate > p.self_contact_rate_max:
            p.self_contact_rate_max = p.self_contact_rate
            p.self_contact_margin_least = min(p.self_contact_margin_least, margin(p))

    @kernel
    def pull_shown(p, work):
        """The same for what is shown: energy stored [J], and what is taken [W].

        Checked  tests/net_capture/test_self_contact.py
        """
        p.self_contact_power = touch_shown(p, work)

    return SelfContact(room.words, start, pull, pull_shown, stopped)


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
            f"must be at most {THICKEST * shortest:.3g} m, half the shortest piece of thread: two pieces on both sides "
            "of a third one would touch for good"
        )
        yield Refusal("self_contact.thickness", f"{values['self_contact.thickness']:g} m", expected)


PART = Term(
    "threads that push each other apart where they touch",
    ROWS,
    excludes=("wrap", "break", "table"),
    faults=(TOO_CROWDED,),
    make=make,
    refuses=refuses,
    extremes=EXTREMES,
)
