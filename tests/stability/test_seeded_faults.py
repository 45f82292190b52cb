"""A fault put into a net or a tow on purpose turns its case red; without it the same case is not."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from dcone_cosim import build
from dcone_cosim.criteria import Criterion, Evidence
from dcone_cosim.phases.capture_criteria import criteria
from dcone_cosim.stability.judge import ACCURATE, FAILED, falls, suited, verdict
from fmu_src.instance import Instance
from fmu_src.net_capture.planes import P, U
from tests.conftest import FREE
from tests.net_capture.memory import planes
from tests.stability import COARSE_NET

NET = {"net.mesh": 3.0, "chaser.start_position[2]": -20.0}
END, LOOK = 6.0, 0.05
Flaw = Callable[[Instance], Any]


def flown(
    shoot: Any, values: Mapping[str, float], flaw: Flaw | None = None, end: float = END, look: float = LOOK
) -> Evidence:
    """A net in free flight; the flaw is put in before every substep."""
    net = shoot({**NET, **values})
    outputs = [n for n, _, v, _ in net.interface.scalars() if v.causality == "output"]
    settable = [n for n, _, v, _ in net.interface.scalars() if v.causality in ("parameter", "input")]
    columns: dict[str, list[float]] = {name: [] for name in ("time", *outputs)}
    given = {name: float(net[name]) for name in settable}

    def record() -> None:
        columns["time"].append(net.time)
        for name in outputs:
            columns[name].append(net[name])

    record()
    parts = round(look / net["solver.substep"]) if flaw is not None else 1
    for number in range(1, round(end / look) + 1):
        for _ in range(parts):
            if flaw is not None:
                flaw(net)
            net.step(look / parts)
        net.time = number * look
        record()
    found = {name: np.array(values, dtype=float) for name, values in columns.items()}
    return Evidence(found, given, {**FREE, "precision": "double"}, end)


def late(net: Instance) -> None:
    """Dashpots see velocities half a substep back, not the predicted ones: a scheme of first order."""
    nodes = planes(net)
    nodes[P : P + 3] = nodes[U : U + 3]


def nothing(net: Instance) -> None:
    """No flaw."""


def judged(evidence: Evidence) -> tuple[str, str]:
    found = verdict(list(criteria(evidence)), "energy_rises")
    return found.kind, found.text


@pytest.mark.parametrize("ratio", [0.0, 0.106, 1.0])
def test_a_sound_net_is_not_red(shoot: Any, ratio: float) -> None:
    assert judged(flown(shoot, {"net.damping_ratio": ratio})) == (ACCURATE, "")


def test_a_flipped_damping_sign_is_red(shoot: Any) -> None:
    """Dashpots that give: the book closes all the same, since what they give is booked."""
    evidence = flown(shoot, {"net.damping_ratio": -0.005, "solver.step_ratio": 0.1})
    broken = {one.key for one in criteria(evidence) if not one.value <= one.stable}
    assert broken == {"thread_takes", "energy_rises"}
    assert judged(evidence)[0] == FAILED


@pytest.mark.parametrize("ratio", [0.0, 0.106])
def test_a_step_a_fifth_above_the_bound_is_red(shoot: Any, ratio: float) -> None:
    """By the bound itself, whatever the damping; without damping by the energy too."""
    evidence = flown(shoot, {"net.damping_ratio": ratio, "solver.step_ratio": 1.2}, end=12.0)
    broken = {one.key for one in criteria(evidence) if not one.value <= one.stable}
    assert broken == ({"bound", "energy_gained", "energy_rises"} if ratio == 0.0 else {"bound"})
    assert judged(evidence)[0] == FAILED


def ringing(shoot: Any, share: float, flaw: Flaw) -> list[Criterion]:
    """A net taut from the start, at a share of its default substep."""
    values = {"net.damping_ratio": 0.5, "net.fold_side": 24.0 * (1.0 - 1e-9), "bullets.angle": 1.5}
    usual = shoot({**NET, **values})
    ratio = share * usual["solver.substep"] / usual["solver.stability_bound"]
    return list(criteria(flown(shoot, {**values, "solver.step_ratio": ratio}, flaw, 0.02, 0.01)))


def test_a_dashpot_half_a_substep_late_is_red(shoot: Any) -> None:
    """Its scheme is of first order: a step four times finer leaves a quarter of the error or more, not a sixteenth."""
    sound, faulty = (falls(ringing(shoot, 1.0, flaw), ringing(shoot, 0.25, flaw), 2e-6) for flaw in (nothing, late))
    assert sound.value < 1.0 / 16.0
    assert faulty.value > 1.0 / 5.0
    assert verdict([sound], "order").kind == ACCURATE
    assert verdict([faulty], "order").kind == FAILED


def held_apart(share: float, scheme: str = "leapfrog") -> set[str]:
    """Criteria that a flat net breaks whose rim alone holds that share of the shot's 9 J, and that books nothing."""
    side, strength = 24.0, 70e9 * 0.33 / (1440.0 * 2.0 * 9.0 * 24.0)  # EA of 9 threads each way
    apart = side + math.sqrt(share * 9.0 * 2.0 * side / (4.0 * strength))
    corners = ((0.0, 0.0), (apart, 0.0), (apart, apart), (0.0, apart))
    columns = {f"bullet[{b}].position[{i}]": np.zeros(2) for b in range(1, 5) for i in (1, 2, 3)}
    for bullet, corner in enumerate(corners, 1):
        for axis, place in enumerate(corner, 1):
            columns[f"bullet[{bullet}].position[{axis}]"][1] = place
    columns |= {"time": np.array([0.0, 1.0]), "energy.kinetic": np.array([9.0, 0.0])}
    columns |= {"energy.remainder": np.array([0.0, 9.0])}
    values = {**COARSE_NET, "net.side": side}
    terms = {**FREE, "solver": scheme}
    found = suited(criteria(Evidence(columns, values, terms, 1.0)), build.instead("net_capture", terms), {})
    return {one.key for one in found if not one.value <= one.stable}


def test_a_rim_stretched_by_more_than_the_shot_had_is_red() -> None:
    """Whatever a scheme books: one whose energies mean nothing is asked for it in their place."""
    assert held_apart(0.99) == {"energy_lost"}
    assert held_apart(1.1) == {"energy_lost", "stretch"}
    assert held_apart(0.99, "xpbd") == set()
    assert held_apart(1.1, "xpbd") == {"stretch"}
