"""Springs at the bullets draw the mouth together, as the spring reels of the paper's breadboard do.

A reel's spring pulls with a force that grows with the cord that is out, or is the same whatever is out, up to a limit:

    F(L) = min(F_most, F0 + c (L - L_lock))

A brake that grows with speed, as of a governor, lets it run at v0 without load: it takes F - T, and so the reel turns
at v0 (1 - T / F), the law of `reels`. With a pawl it never pays out; without one a tension above F draws cord off
against spring and brake. A locked pair is held.

Source   springs instead of winches: Benvenuto and Lavagna (D-CoNe), section 5; the governor and the pawl are ours
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fmu_src.extremes import Extreme
from fmu_src.interface import Term
from fmu_src.net_capture.closing import Closing
from fmu_src.net_capture.closing.part import EXTREMES, FASTEST, refuses, rows
from fmu_src.net_capture.closing.reels import TOO_MANY_RINGS, Drive, make_reels
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.rows import at_least_zero, choice, output, positive, state
from orbital.kernel import kernel

PULLED = ("holds", "pays_out")
"""What a reel does under a tension above its spring's force."""


@kernel
def force(p, length):
    """Force [N] of a spring with so much cord out [m].

    Checked  tests/net_capture/test_springs.py
    """
    return min(p.closing_force_limit, p.closing_force + p.closing_force_rate * (length - p.closing_lock_length))


@kernel
def slope(p, length):
    """Its derivative [N/m].

    Checked  tests/net_capture/test_springs.py
    """
    return p.closing_force_rate if force(p, length) < p.closing_force_limit else 0.0


@kernel
def pays_out(p):
    """Whether a larger tension draws cord off.

    Checked  tests/net_capture/test_springs.py
    """
    return p.closing_pulled == 1


@kernel
def energy(p, length):
    """Energy [J] that a spring gives until its pair is locked, with so much cord out [m]: the integral of its force.

    Checked  tests/net_capture/test_springs.py
    """
    out = length - p.closing_lock_length
    growing = out
    if p.closing_force_rate > 0.0:
        growing = min(out, (p.closing_force_limit - p.closing_force) / p.closing_force_rate)
    rising = growing * (p.closing_force + 0.5 * p.closing_force_rate * growing)
    return rising + p.closing_force_limit * (out - growing)


@kernel
def note(p):
    """Energy left in the springs, and what their brakes have taken of what they gave [J].

    Checked  tests/net_capture/test_springs.py
    """
    left = 0.0
    for i in range(p.net_corners):
        left += energy(p, p.cord_length[i])
    if p.closing_t_start < 0.0:
        p.spring_full = left
    p.closing_spring_energy = left
    p.closing_braked = p.spring_full - left - p.closing_work


def make(composition: Any) -> Closing:
    """Kernels of the springs on the cord along the rim of the composition's net."""
    return make_reels(composition, Drive(force, slope, pays_out, note))


def refuses_springs(scene: Scene) -> Iterator[Refusal]:
    """What no reel refuses, and a limit below the least force."""
    yield from refuses(scene)
    least, most = scene.values["closing.force"], scene.values["closing.force_limit"]
    if most < least:
        expected = f"must be at least {least:g} N, closing.force, with which a spring pulls at the lock length"
        yield Refusal("closing.force_limit", f"{most:g} N", expected)


PART = Term(
    "cord between neighbouring bullets, drawn by springs with a brake",
    (
        *rows("springs"),
        positive(
            "closing.speed", "m/s", "of each reel without load, which its brake sets: a 24 m side in 5 s", 5.0, FASTEST
        ),
        positive("closing.force", "N", "of each spring when its pair is locked: the stall force of a winch", 5.0),
        at_least_zero("closing.force_rate", "N/m", "by which it is larger for each metre of cord out", 0.0),
        positive("closing.force_limit", "N", "largest force of a spring", 20.0),
        choice("closing.pulled", "what a reel does under a tension above its spring's force", PULLED),
        output("closing.spring_energy", "J", "left in the springs, until all pairs are locked"),
        output("closing.braked", "J", "taken by the reels' brakes, and what the springs gave to slack cord"),
        state("spring_full", "J", "in the springs before they start"),
    ),
    faults=(TOO_MANY_RINGS,),
    make=make,
    refuses=refuses_springs,
    extremes=(
        *EXTREMES,
        Extreme(
            "springs that pay out under a stiff cord",
            "each tug draws cord off against a weak spring",
            "energy_gained",
            {"closing.force": 0.1, "closing.pulled": 1},
        ),
    ),
)
