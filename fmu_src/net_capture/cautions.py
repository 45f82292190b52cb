"""What a user may not expect of a shot."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import pairwise

from fmu_src.cautions import Caution, Seen, heavily_damped, low
from fmu_src.net_capture.appendage import placed
from fmu_src.net_capture.entered import by_the_end
from fmu_src.net_capture.hinge.numbers import BODY
from fmu_src.net_capture.implied import open_loop, substeps
from fmu_src.net_capture.interface import GROUPS, TARGETS
from fmu_src.net_capture.pull_off import PULLED, WAITING
from fmu_src.net_capture.schemes import Needs
from fmu_src.net_capture.self_contact.holding import holding_speed, thread_thickness
from fmu_src.net_capture.shapes import Point
from fmu_src.net_capture.shapes.seams import open_seams
from fmu_src.net_capture.wrapping import CONVEX

Values = Mapping[str, float]

FLAT = {"square": ("net.side", "net.side"), "rectangle": ("net.width", "net.height")}
"""Sides of the nets whose area is their product."""
LEFT_OVER = 0.01
"""Share of the energy that came in which the scheme may gain or lose without a word."""


def before(values: Values, given: Collection[str], terms: Mapping[str, str]) -> Iterator[Caution]:
    """From what the scene says."""
    for sentence in low(values["orbit.altitude"]) if "orbit.altitude" in values else ():
        yield Caution("orbit.altitude", sentence)
    yield from heavily_damped("net.damping_ratio", values.get("net.damping_ratio"), "a thread's going taut")
    yield from heavily_damped("closing.damping_ratio", values.get("closing.damping_ratio"), "the cord's going taut")
    if "closing" in terms and "target" in terms:
        yield from _open_loops(values, terms)
        yield from _small_nets(values, terms)
    if terms.get("target") == "union":
        for one, two in open_seams(values):
            yield Caution(
                "target.parts",
                f"pieces {one} and {two} touch in a line or a point, or leave a narrow slit between them: there nodes "
                "of the net can slide beneath the one that stands out; let it reach in by a centimetre or two",
            )
    if values.get("solver.step_ratio", 0.0) > 0.0:
        yield from _long_steps(values, terms)
    if "self_contact" in terms:
        yield from _too_fast(values, terms)
    if BODY in values:
        bound, usual = substeps(values, terms)
        ratio = values.get("solver.step_ratio", 0.0)
        yield from placed.cautions(values, ratio * bound if ratio > 0.0 else usual)


def _too_fast(values: Values, terms: Mapping[str, str]) -> Iterator[Caution]:
    """Threads that meet at the bullets' speed go through each other.

    Checked  tests/net_capture/test_self_contact.py
    """
    thickness, speed = thread_thickness(values, GROUPS["net"].terms[terms["net"]].checks), values["bullets.speed"]
    duration, ratio = values["self_contact.duration"], values["self_contact.damping_ratio"]
    holds = holding_speed(thickness, duration, ratio)
    if speed > holds:
        yield Caution(
            "self_contact.duration",
            f"threads of {1e3 * thickness:.3g} mm hold each other up to {holds:.3g} m/s, and bullets leave at "
            f"{speed:.3g} m/s: some may go through, which self_contact.passed counts; {duration * holds / speed:.2g} s "
            "would hold, at shorter substeps, and so would thicker ones",
        )


def _open_loops(values: Values, terms: Mapping[str, str]) -> Iterator[Caution]:
    """A mouth that stays open beside its cord: wider there than the target is round."""
    girth, rings = TARGETS[terms["target"]].checks.girth(values), values["closing.rings"]
    loop = open_loop(values, terms)
    if loop > girth:
        needed = math.ceil(loop * (rings + 1) / girth) - 1
        yield Caution(
            "closing.rings",
            f"with {rings:.0f} the closed mouth keeps loops of {loop:.3g} m, and {girth:.3g} m let this "
            f"target pass: a capture may come to nothing within a minute; {needed} would hold it",
        )


def _small_nets(values: Values, terms: Mapping[str, str]) -> Iterator[Caution]:
    """A flat net smaller than the target's surface: it counts as captured once its mouth is no longer than the girth P,
    and such a mouth leaves at most P^2 / 4 pi of that surface bare.

    Checked  tests/net_capture/test_small_nets.py
    """
    if terms["net"] not in FLAT or terms["target"] not in CONVEX:
        return
    shape = TARGETS[terms["target"]].checks
    net, whole = math.prod(values[name] for name in FLAT[terms["net"]]), surface_area(*shape.surface(values))
    girth = shape.girth(values)
    if net < whole:
        yield Caution(
            FLAT[terms["net"]][0],
            f"{net:.4g} m2 of net are to close round {whole:.4g} m2 of target: a mouth of its girth, {girth:.3g} m, "
            f"leaves at most {girth**2 / (4.0 * math.pi):.3g} m2 of that bare, so it can hardly count as captured",
        )


def surface_area(corners: Sequence[Point], faces: Sequence[Sequence[int]]) -> float:
    """Area of plane faces told by the numbers of their corners [m2].

    Checked  tests/net_capture/test_small_nets.py
    """
    total = 0.0
    for face in faces:
        first, *others = (corners[number] for number in face)
        for one, other in pairwise(others):
            a, b = ([q - p for p, q in zip(first, corner, strict=True)] for corner in (one, other))
            normal = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
            total += 0.5 * math.hypot(*normal)
    return total


def _long_steps(values: Values, terms: Mapping[str, str]) -> Iterator[Caution]:
    """A substep that the scene gives, longer than its damping allows."""
    bound, accurate = substeps(values, terms)
    ratio, enough, needs = values["solver.step_ratio"], accurate / bound, _needs(terms)
    if ratio > enough * (1.0 + 1e-9):
        yield Caution(
            "solver.step_ratio",
            f"{ratio:g} is more than this damping allows: the mouth area may be off by more than "
            f"{100.0 * needs.keeps:g} %{' and the energy by more than 1 %' if needs.keeps_energy else ''}; "
            f"{math.floor(1e3 * enough) / 1e3:g} would hold {'them' if needs.keeps_energy else 'it'}, and so does "
            "leaving it out",
        )


def after(values: Values, given: Collection[str], terms: Mapping[str, str], seen: Seen) -> Iterator[Caution]:
    """From what came out."""
    yield from _unbalanced(values, terms, seen)
    yield from _taken_back(seen)
    yield from _not_pulled(seen)
    yield from _passed(seen)
    yield from _short_of_bound(seen)


def _needs(terms: Mapping[str, str]) -> Needs:
    """What the scheme wants."""
    found: Needs = GROUPS["solver"].terms[terms.get("solver", "leapfrog")].checks
    return found


def _unbalanced(values: Values, terms: Mapping[str, str], seen: Seen) -> Iterator[Caution]:
    """An energy book that leaves over more than a hundredth of what came in: the scheme's own error."""
    left, entered = seen("energy.remainder"), by_the_end(seen)
    if left is None or entered is None:
        return
    size = max(abs(left.least), abs(left.largest))
    if size > LEFT_OVER * entered:
        yield Caution(
            "energy.remainder",
            f"the book leaves {size:.2g} J over of the {entered:.3g} J that came in, {100.0 * size / entered:.2g} %: "
            f"the scheme's own error, which falls {_needs(terms).falls}",
        )


def _short_of_bound(seen: Seen) -> Iterator[Caution]:
    """A substep longer than the bound of what turned out to be taut, or to touch."""
    for name, so, instead in (
        (
            "solver.margin_least",
            "a substep was {} times the bound of the threads that were taut in truth",
            "leave it out",
        ),
        (
            "self_contact.margin_least",
            "so many threads touched at one node that a substep was {} times the bound",
            "a longer self_contact.duration",
        ),
    ):
        margin = seen(name)
        if margin is not None and margin.least < 1.0:
            times = f"{1.0 / margin.least:.3g}"
            yield Caution(name, f"{so.format(times)}: choose a smaller solver.step_ratio, or {instead}")


def _passed(seen: Seen) -> Iterator[Caution]:
    """Threads that went through the target, or may have."""
    for name, said in (
        ("wrap.passed", "taut threads went through the target {} times"),
        ("wrap.passed_slack", "it was lost {} times how a slack thread lies, which may have gone through"),
        ("self_contact.passed", "threads of the net went through each other {} times"),
    ):
        passed = seen(name)
        if passed is not None and passed.last > 0.0:
            yield Caution(name, f"{said.format(f'{passed.last:.0f}')}: less holds than it seems")


def _taken_back(seen: Seen) -> Iterator[Caution]:
    """A capture that did not last."""
    captured, lost = seen("t_capture"), seen("t_lost")
    if captured is not None and lost is not None and lost.last >= 0.0:
        yield Caution(
            "t_lost", f"the target, captured at {captured.last:.4g} s, was out of the net at {lost.last:.4g} s"
        )


def _not_pulled(seen: Seen) -> Iterator[Caution]:
    """A pull-off test that did not come to its end, though the target was captured."""
    captured, stands = seen("captured"), seen("pull_off.stands")
    if captured is not None and captured.last > 0.0 and stands is not None and stands.last in (WAITING, PULLED):
        yield Caution(
            "pull_off.stands",
            f"the phase ended while the net was {'pulled' if stands.last == PULLED else 'still to be pulled'}: raise "
            "duration or after_capture",
        )
