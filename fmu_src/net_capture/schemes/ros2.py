"""ROS2, linearly implicit and L-stable: order 2 at any dashpot, for threads too stiff or too damped to be followed.

    (1 - gamma h A) k1 = f(y),   (1 - gamma h A) k2 = f(y + h k1) - 2 k1,   y' = y + h (3 k1 + k2)/2
    gamma = 1 - 1/sqrt(2)

Of second order with any A whatever, as long as both stages have the same. So A is what can be solved well: the taut
threads as springs and dashpots where they are as the substep begins, see `held` and `conjugate`. Positions are
eliminated; what is solved for is the acceleration a in (M + g D + g2 K) a = M b, g = gamma h,

    first stage    M b = F(x, v) - g K v,                          x rate: v + g a1
    second stage   M b = F(x2, v2) - 2 M a1 - g K (-v + (1 - 2 gamma) h a1),  x2 = x + h v + h g a1,  v2 = v + h a1
    x' = x + h v + h (h + g) a1 / 2 + h g a2 / 2,   v' = v + h (3 a1 + a2)/2

A thread that pulls as the substep begins is a spring with a dashpot, pushing too, until it ends: for a net so linear
L-stability means that no energy is gained. One that is slack is in A if it is taut in either stage or at the end, and
the substep is tried again until none is left out. What would go taut is thereby stopped at once, without the rebound.

No bound of stability; forces twice and two linear equations each time a substep is tried. Order 1 where a dashpot makes
the tension jump as a thread goes taut. It needs a step far beyond the leapfrog's to be worth its price: strong dashpots
allow that, the swings of stiff threads do not. An impulse within a substep would spoil it, so it goes without contact
and closing.

Momentum holds to rounding, angular momentum to its order. `thread.dissipated` is what the impulses of the dashpots did;
what the scheme takes of swings that it does not follow is in `energy.remainder`.

Source   Verwer, Spee, Blom and Hundsdorfer, SIAM J. Sci. Comput. 20 (1999) 1456, ROS2; W-methods: Steihaug and
         Wolfbrandt, Math. Comp. 33 (1979) 521
Checked  tests/net_capture/test_schemes.py, tests/net_capture/test_stiff.py
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from fmu_src.interface import Term, fault
from fmu_src.net_capture.formulas import longest_step
from fmu_src.net_capture.planes import FX, INVERSE_MASS, NODE_PLANES, P, U, X
from fmu_src.net_capture.schemes import MOST_RATIO, UNBOUNDED, Needs, Scheme, unbounded
from fmu_src.net_capture.schemes.conjugate import make_solver
from fmu_src.net_capture.schemes.held import RESIDUAL, SOLUTION, make_held
from fmu_src.net_capture.schemes.in_step import make_in_step, make_rouse, make_rouse_all
from fmu_src.net_capture.threads import make_threads
from fmu_src.rows import count
from orbital.kernel import kernel

START, STRAIN_RATE, BARE, BARE_SECOND, FIRST, SECOND = (NODE_PLANES + 3 * i for i in range(6))
"""Node planes: positions at the start of the substep, velocities of which the strain is taken (at first: positions
guessed for the end), accelerations by the forces alone at either stage, those of both stages a1 and a2."""
OWN_PLANES = 18
GAMMA = 1.0 - math.sqrt(0.5)
LONGEST = 2.5
"""Default substep times omega, at most."""
KEEPS = 0.01
"""Of the mouth area."""
TAKES_OF_ITSELF = {**UNBOUNDED, "energy_lost": "agrees"}
"""What it takes of swings that it does not follow is booked to nothing; whether that matters a finer run tells."""
MOST_TRIES = 100
"""Of one substep: each lists threads that the last one has left out."""

NOT_SOLVED = fault(
    "substep_not_solved",
    "solver.step_ratio",
    "the equations of a substep were not solved: the conjugate gradients do not converge, or more and more threads go "
    "taut; lower solver.step_ratio",
)


@kernel
def accurate_step(stiffness_rate, damping_rate):
    """Step [s] that keeps the mouth area within 1 %, and swings of threads no more.

        h = min(0.3 + 7.5 zeta, 2.5) / omega,   zeta omega = damping_rate,   omega^2 = 2 stiffness_rate

    stiffness_rate, damping_rate   as for `formulas.longest_step`

    What the scheme takes of a swing that it does not follow must be what the dashpots would have taken: without them
    the longest of these steps makes the mouth's curve wrong by half.

    Valid    measured with Table 1's net, damping ratio 0.106 over 15 s (0.3 %) and 10 over 8 s
    Source   ours: tests/net_capture/evidence/schemes.py
    Checked  tests/net_capture/test_stiff.py
    """
    omega = math.sqrt(2.0 * stiffness_rate)
    return min(0.3 + 7.5 * damping_rate / omega, LONGEST) / omega


def turns(values: Mapping[str, float], step: float) -> Mapping[str, tuple[float, float]]:
    """Angular momentum is kept to the scheme's order, not to rounding: accurate to a hundredth of h v/R, stable to all
    of it.

    The pulls of the second stage are solved for with the directions of the first, a substep older: a thread of tension
    T whose ends cross it at v leaves a couple T h v, and half of its impulse belongs to that stage, h T h v / 2. Over a
    rebound threads pass on twice the shot's momentum P, so they leave h v P of the P R that the shot has about the
    target.

    step    h     substep                                         [s]
            v     speed of the bullets                            [m/s]
            R     distance of the muzzle from the target          [m]
    """
    away = math.sqrt(sum(values[f"chaser.start_position[{axis}]"] ** 2 for axis in (1, 2, 3)))
    most = step * values["bullets.speed"] / max(away, 1.0)
    return {"angular_momentum": (0.01 * most, most)}


def make(composition: Any) -> Scheme:
    """Kernels of the scheme with the composition's gravity and pulls."""
    node_plane, reals_of, lanes = composition.memory.node_plane, composition.memory.reals, composition.lanes
    load, store, splat, width = lanes.load, lanes.store, lanes.splat, lanes.width
    threads, pulls, gravity = make_threads(composition, P, -1), composition.pulls, composition.gravity
    pull_now, pull_shown = threads.pull_now, threads.pull_shown
    pull_nodes, pull_nodes_shown, book = pulls.pull, pulls.pull_shown, pulls.book
    bends, accelerate = gravity.bends, gravity.accelerate
    copy, no_force, take_over, place = make_in_step(composition)
    held, kept, put_back = make_held(composition, threads.taut), composition.peaks.kept, composition.peaks.put_back
    nodes, vector, clear, gather = held.nodes, held.vector, held.clear, held.gather
    hold, dissipate = held.hold, held.dissipate
    strain, solve = make_solver(composition, held)
    not_solved = composition.code(NOT_SOLVED.name)

    @kernel
    def combine(p, work, target, first, second, b, third, c):
        """Three planes of x + b y + c z, each from three others.

        Checked  tests/net_capture/test_schemes.py
        """
        reals, slots = reals_of(work), p.node_slots
        y, z = splat(b), splat(c)
        for i in range(0, 3 * slots, width):
            summed = load(reals, i + first * slots) + y * load(reals, i + second * slots)
            store(reals, i + target * slots, summed + z * load(reals, i + third * slots))

    @kernel
    def begin(p, work):
        """Positions and velocities belong to the same instant already.

        Checked  tests/net_capture/test_schemes.py
        """
        take_over(p, work)
        p.solver_iterations = 0
        p.solver_tries = 0
        p.solver_unsolved = 0

    @kernel
    def turn_into_rates(p, work, target):
        """Accelerations by the forces and by gravity at the positions in X and the velocities in P; no force is left.

        Checked  tests/net_capture/test_schemes.py
        """
        reals, slots = reals_of(work), p.node_slots
        for axis in range(3):
            for i in range(0, slots, width):
                force = load(reals, i + (FX + axis) * slots)
                store(reals, i + (target + axis) * slots, force * load(reals, i + INVERSE_MASS * slots))
                store(reals, i + (FX + axis) * slots, splat(0.0))
        if bends:
            at = p.scratch[0:3]
            speed = p.scratch[3:6]
            out = p.scratch[6:9]
            inverse = node_plane(p, work, INVERSE_MASS)
            for i in range(slots):
                if inverse[i] > 0.0:
                    for axis in range(3):
                        at[axis] = node_plane(p, work, X + axis)[i]
                        speed[axis] = node_plane(p, work, P + axis)[i]
                    accelerate(p, out, at, speed)
                    for axis in range(3):
                        node_plane(p, work, target + axis)[i] += out[axis]

    @kernel
    def stage(p, work, target, bare, strained, guess, share):
        """Accelerations of a stage: those by the forces alone, and at the listed nodes what the matrix makes of them.

        bare             planes of the accelerations by the forces, less twice the first stage's at the second
        strained         planes of the velocities of which g K is taken
        guess, share     planes of the accelerations to begin from, and how much of them

        Checked  tests/net_capture/test_schemes.py
        """
        slot, residual, solution = nodes(p, work), vector(p, work, RESIDUAL), vector(p, work, SOLUTION)
        for axis in range(3):
            rate = node_plane(p, work, bare + axis)
            first = node_plane(p, work, guess + axis)
            for i in range(p.matrix_nodes):
                residual[3 * i + axis] = rate[slot[i]]
                solution[3 * i + axis] = share * first[slot[i]]
        strain(p, work, strained)
        if not solve(p, work, GAMMA * p.solver_substep):
            p.solver_unsolved = 1
        copy(p, work, bare, target)
        for axis in range(3):
            rate = node_plane(p, work, target + axis)
            for i in range(p.matrix_nodes):
                rate[slot[i]] = solution[3 * i + axis]

    @kernel
    def attempt(p, work, known):
        """Both stages with the threads listed, up to the positions and velocities of the end in X and P; 1 if none
        was left out, 0 if any at the end, -1 if any at the second stage, which is then not solved.

        known    whether SECOND holds the second stage of an earlier attempt

        Checked  tests/net_capture/test_stiff.py
        """
        h = p.solver_substep
        g = GAMMA * h
        p.solver_tries += 1
        stage(p, work, FIRST, BARE, U, FIRST, 1.0)
        combine(p, work, X, START, U, h, FIRST, h * g)
        combine(p, work, P, U, FIRST, h, FIRST, 0.0)
        if gather(p, work, START, X, g) > 0:
            return -1
        noted = kept(p)
        pull_now(p, work)
        put_back(p, noted)
        hold(p, work)
        pull_nodes(p, work)
        turn_into_rates(p, work, BARE_SECOND)
        combine(p, work, BARE_SECOND, BARE_SECOND, FIRST, -2.0, FIRST, 0.0)
        combine(p, work, STRAIN_RATE, U, U, -2.0, FIRST, h - 2.0 * g)
        if known:
            stage(p, work, SECOND, BARE_SECOND, STRAIN_RATE, SECOND, 1.0)
        else:
            stage(p, work, SECOND, BARE_SECOND, STRAIN_RATE, FIRST, -1.0)
        combine(p, work, X, START, U, h, FIRST, 0.5 * h * (h + g))
        combine(p, work, X, X, SECOND, 0.5 * h * g, SECOND, 0.0)
        combine(p, work, P, U, FIRST, 1.5 * h, SECOND, 0.5 * h)
        return 1 if gather(p, work, START, X, g) == 0 else 0

    @kernel
    def step(p, work):
        """A substep, tried until no thread was left out that is taut in it.

        Checked  tests/net_capture/test_schemes.py
        """
        h = p.solver_substep
        copy(p, work, X, START)
        pull_now(p, work)
        pull_nodes(p, work)
        book(p, 0.5 * h)
        turn_into_rates(p, work, BARE)
        clear(p, work)
        gather(p, work, START, START, GAMMA * h)
        combine(p, work, STRAIN_RATE, X, U, h, U, 0.0)
        gather(p, work, START, STRAIN_RATE, GAMMA * h)
        combine(p, work, FIRST, X, X, -1.0, X, 0.0)
        found = -1
        known = False
        for _ in range(MOST_TRIES):
            found = attempt(p, work, known)
            known = known or found >= 0
            if found > 0 or p.solver_unsolved != 0:
                break
        if found <= 0:
            p.solver_unsolved = 1
        book(p, 0.5 * h)
        dissipate(p, work, START, FIRST, SECOND, GAMMA * h)
        copy(p, work, P, U)

    @kernel
    def stopped(p):
        """Code of what stopped the last substep, 0 for nothing.

        Checked  tests/net_capture/test_stiff.py
        """
        if p.solver_unsolved == 0:
            return 0
        p.fault_value = p.solver_step_ratio
        return not_solved

    @kernel
    def show(p, work):
        """The same, and the power of the dashpots [W].

        Checked  tests/net_capture/test_schemes.py
        """
        place(p, work)
        pull_shown(p, work)
        pull_nodes_shown(p, work)
        no_force(p, work)

    return Scheme(0.0, held.words, begin, step, place, threads.stored, show, fault=stopped)


PART = Term(
    "linearly implicit Rosenbrock scheme ROS2, L-stable, of order 2: for threads with strong dashpots, opening alone",
    (
        *unbounded(KEEPS),
        count("solver.iterations", "iterations of the conjugate gradients so far"),
        count("solver.tries", "attempts at substeps so far, one or more for each"),
        count("solver_unsolved", "whether the last substep was not solved", "state"),
        count("matrix_nodes", "nodes at which threads of the matrix end", "state"),
        count("matrix_threads", "threads of the matrix", "state"),
    ),
    make=make,
    excludes=("contact", "closing"),
    faults=(NOT_SOLVED,),
    checks=Needs(
        make_rouse,
        make_rouse_all,
        OWN_PLANES,
        longest_step,
        accurate_step,
        factors=(8.0, 4.0, 2.0, 1.0, 0.5, 0.25),
        steepest=MOST_RATIO,
        keeps=KEEPS,
        keeps_energy=False,
        follows=False,
        instead=TAKES_OF_ITSELF,
        within=turns,
    ),
)
