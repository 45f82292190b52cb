"""Threads between nodes that bend round the target.

Nodes alone touch the target, and a thread between two of them that an edge lies across would cut it. A thread has no
mass of its own here, half of it goes to each of its nodes; so it lies round the body in equilibrium, without friction,
and pulls both nodes along the shortest way (`contact/edges.py`), over as many edges as lie across it:

    T = max(0, k (l - L) + d dl/dt)   if l > L,   l the length of that way

The target gets what is left of both pulls, at the first and the last bend. That is a potential, so nothing is lost: two
nodes that fall with a thread across an edge swing round it. A contact point in the middle of a thread that stays
straight would take all they have.

There may be a shortest way on either side of a corner. A thread keeps to the side on which it came to lie, and slides
over the corner where there is none left on its side: its way is shorter at once, and what it held beyond that is lost
(`wrap.slip_loss`), as a real thread would lose it in its own vibration. No way ever grows at once. One that would, of a
taut thread that is found inside the body, has gone through: it stays straight until it is clear of the target, and is
counted in `wrap.passed`.

A union is made of convex bodies, and a thread bends round one after another (`bodies.py`); so does the closing cord
(`cord_bends.py`). Where these do not fit together a way may grow by a step, and what the thread gains is taken from
that loss.

Which threads are near is looked up now and then, ahead of how fast anything moves. In what is shown the pull round an
edge counts up to the middle of the last substep, as that of contact by penalty does.

Checked  tests/net_capture/test_wrapping.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from fmu_src.interface import Term
from fmu_src.net_capture import bodies
from fmu_src.net_capture.capstan import WITH_FRICTION, make_capstan
from fmu_src.net_capture.capstan import rows as friction_rows
from fmu_src.net_capture.contact.section import MOST
from fmu_src.net_capture.lying import make_lie
from fmu_src.net_capture.near import BENT, CLEAR, EDGES, FINE, FREE, JUMP, KEPT, PASSED, SHARE, WAY, make_near
from fmu_src.net_capture.planes import (
    DAMPING,
    FIRST,
    FX,
    LENGTH,
    SHOWN,
    SHOWN_RATE,
    STIFFNESS,
    STRIP_NUMBERS,
    STRIP_WORDS,
    A,
    B,
    P,
    X,
)
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.net_capture.shapes.union import FOR_THREADS
from fmu_src.net_capture.wrap_rows import EXTREMES, ROWS
from orbital.kernel import kernel
from orbital.rotations import rotate
from orbital.vectors import cross

SCHEME = "leapfrog"
CONVEX = ("box", "cylinder", "frustum", "sphere")
"""Shapes along whose distance a straight line comes to the surface once."""
OF_CONVEX = "union"
"""The shape whose pieces are, or are cut into such."""


class Wrap(NamedTuple):
    """Kernels of threads that bend.

    words(p)              whole numbers of work memory, before those of the pace
    start(p)              no thread bends yet
    pull(p, work)         add the pull round edges in place of the straight one, for a substep, and book it
    pull_shown(p, work)   take the straight pull from nodes as shown; energy stored in the bends
    """

    words: Any
    start: Any
    pull: Any
    pull_shown: Any


def make(composition: Any) -> Wrap:
    """Kernels for the composition's net and target; ValueError with a scheme that asks for forces otherwise."""
    scheme = composition.terms["solver"]
    if scheme != SCHEME:
        raise ValueError(f"threads bend round the target with {SCHEME}, not {scheme}")
    # after the scheme's own parts are known, see `schemes.asleep`
    from fmu_src.net_capture.schemes.asleep import make_asleep

    memory = composition.memory
    node_plane, strips, properties, own = memory.node_plane, memory.strips, memory.properties, memory.own
    reals_of, bring, rouse = memory.reals, make_asleep(composition).bring, composition.rouse
    faces, several = composition.target.shape.faces, composition.target.shape.hulls is not None
    if faces is None and not several:
        raise ValueError(f"threads bend round no {composition.terms['target']}: it may have hollows")
    begin_step, rate_of = composition.contact.begin_step, composition.gravity.rate
    peaks, now = composition.peaks, composition.clock.now
    so_far, note = peaks.so_far, peaks.note
    has_map = composition.force_map is not None
    add_to_map = composition.force_map.add if has_map else None
    rubs = composition.terms["wrap"] == "friction"
    kept_of_way = WITH_FRICTION if rubs else KEPT
    whole, step = kept_of_way + (bodies.KEPT if several else 0), bodies.STEP if several else 0.0
    words, list_at, list_near, recall, keep, wound = make_near(composition, whole)
    begin, remember, hold, let_go, stretch_held = make_capstan() if rubs else (None,) * 5
    lie = make_lie(composition, remember)
    ends, look, lose = lie.ends, lie.look, lie.lose
    seek, again = bodies.make_bodies(composition, kept_of_way, lie, remember) if several else (None, None)

    @kernel
    def start(p):
        """No thread bends yet.

        Checked  tests/net_capture/test_wrapping.py
        """
        p.wrap_listed = 0
        p.wrap_next = 0
        p.wrap_threads = 0
        p.wrap_passed = 0
        p.wrap_passed_slack = 0
        p.wrap_impulse = 0.0
        p.wrap_stored = 0.0
        p.wrap_slipped = 0
        p.wrap_slip_loss = 0.0
        if several:
            p.wrap_body = -1
            p.wrap_leans = 0
            p.wrap_others_near = 0
        else:
            p.wrap_faces = faces(p, p.wrap_planes)
        if rubs:
            begin(p)

    @kernel
    def slip(p, before, way, length, stiffness):
        """Book what a taut thread loses as its way gets shorter at once, or gains by a step from body to body [J].

        Checked  tests/net_capture/test_slip_loss.py
        """
        held, kept = max(0.0, before - length), max(0.0, way - length)
        p.wrap_slipped += 1
        p.wrap_slip_loss += 0.5 * stiffness * (held * held - kept * kept)

    @kernel
    def follow(p, words, at, edges, way, going, straight, length, stiffness):
        """State of a thread in this substep, by how many edges it bends over, and what is kept for the next one; a way
        that is shorter at once has slid over a corner.

        at        where its state stands

        Checked  tests/net_capture/test_wrapping.py
        """
        before = words[at]
        if edges == 0:
            if before == BENT and FINE * words[at + WAY * p.wrap_numbers] > max(length, way + JUMP):
                slip(p, FINE * words[at + WAY * p.wrap_numbers], way, length, stiffness)
            words[at] = FREE
            words[at + CLEAR * p.wrap_numbers] = p.grid + 1 + int(p.wrap_clear / p.wrap_haste)
            return
        expected = FINE * words[at + WAY * p.wrap_numbers] if before != FREE else straight
        within = JUMP + SHARE * p.solver_substep * abs(going)
        if before == FREE:
            within += 2.0 * p.solver_substep * abs(going)
            words[at] = BENT
        if before != PASSED:
            if way > length and way > expected + max(within, step):
                words[at] = PASSED
                p.wrap_passed += 1
            elif (way > length and way > expected + within) or (expected > length and way < expected - within):
                slip(p, expected, way, length, stiffness)
        words[at + WAY * p.wrap_numbers] = np.int64((way + p.solver_substep * going) / FINE)
        if several:
            return
        keep(p, words, at, edges)

    @kernel
    def press(p, edges, tension, dashpot):
        """Enter what the thread gives the target at every bend in a substep into the map of forces.

        tension     of the whole thread, where nothing rubs          [N]
        dashpot     its dashpot's share                              [N]

        Checked  tests/net_capture/test_force_map.py, test_capstan.py
        """
        for j in range(edges):
            squared = 0.0
            for axis in range(3):
                if rubs:
                    change = max(0.0, p.wrap_pulls[j + 1] + dashpot) * p.wrap_pieces[j + 1, axis]
                    change -= max(0.0, p.wrap_pulls[j] + dashpot) * p.wrap_pieces[j, axis]
                else:
                    change = p.wrap_pieces[j + 1, axis] - p.wrap_pieces[j, axis]
                squared += change * change
            force = math.sqrt(squared) if rubs else tension * math.sqrt(squared)
            add_to_map(p, p.wrap_bends[j + 1], p.solver_substep * force)

    @kernel
    def pull(p, work):
        """For every thread that bends: the pull along its way in place of the straight one, node, node and target.

        Checked  tests/net_capture/test_wrapping.py
        """
        begin_step(p, rate_of(p))
        if p.grid >= p.wrap_next or p.solver_substep != p.wrap_substep:
            list_near(p, work)
        words, table, numbers = own(p, work), strips(p, work), properties(p, work)
        at = list_at(p, words)
        h = p.solver_substep
        for n in range(p.wrap_listed):
            code = words[at + n]
            strip = code // 64
            number = table[STRIP_WORDS * strip + FIRST] + code % 64
            kept = at + p.wrap_numbers + number
            if words[kept + CLEAR * p.wrap_numbers] > p.grid:
                continue
            a = table[STRIP_WORDS * strip + A] + code % 64
            b = table[STRIP_WORDS * strip + B] + code % 64
            bring(p, reals_of(work), words, a // p.row_pitch)
            bring(p, reals_of(work), words, b // p.row_pitch)
            q = STRIP_NUMBERS * strip
            length, stiffness, damping = numbers[q + LENGTH], numbers[q + STIFFNESS], numbers[q + DAMPING]
            known, slips = words[kept] == BENT, p.wrap_slipped
            if several:
                edges, way, going, straight, closing = seek(p, work, words, kept, a, b, length)
            else:
                edges, way, going, straight, closing = look(p, work, code, X, P, recall(p, words, kept))
                if known:
                    taut = FINE * words[kept + WAY * p.wrap_numbers] > length
                    before = min(words[kept + EDGES * p.wrap_numbers], MOST - 1)
                    lose(p, MOST if wound(p, words, kept) else before, edges, taut)
            follow(p, words, kept, edges, way, going, straight, length, stiffness)
            if words[kept] != BENT or way <= length:
                if rubs:
                    let_go(p, words, kept)
                continue
            rouse(p, work, a)
            rouse(p, work, b)
            elastic = stiffness * (way - length)
            tension = max(0.0, elastic + damping * going)
            farther = tension
            if rubs:
                hold(p, words, kept, edges, way, length, stiffness, known and p.wrap_slipped == slips)
                near, far = p.wrap_pulls[0], p.wrap_pulls[edges]
                tension, farther = max(0.0, near + damping * going), max(0.0, far + damping * going)
                p.thread_loss += h * ((tension - near) * p.wrap_rates[0] + (farther - far) * p.wrap_rates[1])
            else:
                p.thread_loss += h * (tension - elastic) * going
            chord = 0.0
            if straight > length:
                elastic = stiffness * (straight - length)
                chord = max(0.0, elastic + damping * closing)
                p.thread_loss -= h * (chord - elastic) * closing
            for axis in range(3):
                along = chord * p.wrap_line[axis]
                node_plane(p, work, FX + axis)[a] -= tension * p.wrap_first[axis] + along
                node_plane(p, work, FX + axis)[b] -= farther * p.wrap_last[axis] - along
            squared = 0.0
            for axis in range(3):
                push = h * tension * (p.wrap_first[axis] + p.wrap_last[axis])
                if rubs:
                    push += h * (farther - tension) * p.wrap_last[axis]
                p.target_drift[axis] += push / p.target_mass
                squared += push * push
            for end in range(2):
                rotate(p.wrap_turned, p.target_pose, p.wrap_bends[1 if end == 0 else edges])
                cross(p.wrap_moving, p.wrap_turned, p.wrap_first if end == 0 else p.wrap_last)
                for axis in range(3):
                    p.target_spin[axis] += h * (tension if end == 0 else farther) * p.wrap_moving[axis]
            p.wrap_impulse += math.sqrt(squared)
            if has_map:
                press(p, edges, tension, damping * going)
            if max(tension, farther) > so_far(p, number + 1):
                note(p, number + 1, max(tension, farther))
            p.contact_force = max(p.contact_force, tension + farther)
            if p.contact_first_time < 0.0:
                p.contact_first_time = now(p)

    @kernel
    def pull_shown(p, work):
        """Take the straight pull of threads that bend from the nodes as shown, and sum what they store beyond it [J],
        half a substep back.

        Checked  tests/net_capture/test_wrapping.py
        """
        words, table, numbers = own(p, work), strips(p, work), properties(p, work)
        at = list_at(p, words)
        p.wrap_stored = 0.0
        p.wrap_threads = 0
        for n in range(p.wrap_listed):
            code = words[at + n]
            strip = code // 64
            kept = at + p.wrap_numbers + table[STRIP_WORDS * strip + FIRST] + code % 64
            if words[kept] != BENT:
                continue
            if several:
                a, b = ends(p, work, code)
                edges, way, going, straight, closing = again(p, work, words, kept, a, b, SHOWN, SHOWN_RATE)
            else:
                edges, way, going, straight, closing = look(p, work, code, SHOWN, SHOWN_RATE, recall(p, words, kept))
            q = STRIP_NUMBERS * strip
            length = numbers[q + LENGTH]
            if edges == 0 or way <= length:
                continue
            p.wrap_threads += 1
            if rubs:
                p.wrap_stored += stretch_held(p, words, kept, edges, way, length, numbers[q + STIFFNESS])
                power = p.wrap_pulls[0] * p.wrap_rates[0] + p.wrap_pulls[edges] * p.wrap_rates[1]
                p.wrap_stored -= 0.5 * p.solver_substep * power
            else:
                stretch = max(0.0, way - 0.5 * p.solver_substep * going - length)
                p.wrap_stored += 0.5 * numbers[q + STIFFNESS] * stretch * stretch
            if straight > length:
                stretch = straight - length
                elastic = numbers[q + STIFFNESS] * stretch
                chord = max(0.0, elastic + numbers[q + DAMPING] * closing)
                p.wrap_stored -= 0.5 * elastic * stretch
                p.thread_power -= (chord - elastic) * closing
                for axis in range(3):
                    along = chord * p.wrap_line[axis]
                    node_plane(p, work, FX + axis)[table[STRIP_WORDS * strip + A] + code % 64] -= along
                    node_plane(p, work, FX + axis)[table[STRIP_WORDS * strip + B] + code % 64] += along

    return Wrap(words, start, pull, pull_shown)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """A scheme, a precision or a target with which no thread bends."""
    scheme, precision = scene.terms["solver"], scene.terms["precision"]
    if scheme != SCHEME:
        yield Refusal("solver.scheme", f'"{scheme}"', f'keeps all threads straight; [capture.wrap] needs "{SCHEME}"')
    shape = scene.terms["target"]
    if shape not in (*CONVEX, OF_CONVEX):
        known = ", ".join((*CONVEX, OF_CONVEX))
        expected = f"must be convex, or a union, where threads bend round it, one of {known}: [capture.wrap]"
        yield Refusal("target.shape", f'"{shape}"', expected)
    if precision != "double":
        yield Refusal("solver.precision", f'"{precision}"', 'must be "double" where threads bend: [capture.wrap]')


PART = Term(
    "threads between nodes bend round the edges of the target, without friction",
    ROWS,
    needs=("target", "contact"),
    excludes=("break",),
    tables=FOR_THREADS,
    extremes=EXTREMES,
    make=make,
    refuses=refuses,
)

FRICTION = Term(
    "threads between nodes bend round the edges of the target, and friction holds them there",
    (*ROWS, *friction_rows()),
    needs=("target", "contact"),
    excludes=("break",),
    tables=FOR_THREADS,
    extremes=EXTREMES,
    make=make,
    refuses=refuses,
)
