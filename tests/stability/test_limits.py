"""Limits against what they are derived from: rounding, other forces in a snap, an order; estimates; stopped runs."""

from __future__ import annotations

import math
import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from dcone_cosim import build
from dcone_cosim.cases.alone import Alone, Fmus
from dcone_cosim.cases.cost import estimate
from dcone_cosim.criteria import Criterion, Evidence
from dcone_cosim.errors import FmuError
from dcone_cosim.phases.capture_criteria import criteria as of_capture
from dcone_cosim.phases.capture_criteria import spacing
from dcone_cosim.progress import Progress
from dcone_cosim.scene.data import Scene
from dcone_cosim.stability.judge import FAILED, REFUSED
from dcone_cosim.stability.plan import AS_IT_IS, _Maker
from dcone_cosim.stability.work import _stopped
from orbital.oscillators import damped_snap_peak
from tests.conftest import FREE
from tests.stability import COARSE_NET

SHOT = {
    **COARSE_NET,
    "solver.step_ratio": 0.0,
    **{f"chaser.start_position[{axis}]": (0.0, -20.0, 0.0)[axis - 1] for axis in (1, 2, 3)},
    **{f"chaser.start_velocity[{axis}]": 0.0 for axis in (1, 2, 3)},
    **{f"shot.axis[{axis}]": 0.0 for axis in (1, 2, 3)},
}


def flown(precision: str, off: float = 0.0) -> Evidence:
    """A second of a shot whose catch is so far off its way [m]."""
    time, substep = np.array([0.0, 0.5, 1.0]), 1e-4
    momentum = next(row.value for row in build.implied("net_capture", SHOT, FREE) if row.key == "shot.momentum")
    mass = 0.33 + 2.0 + 0.15
    columns = {
        "time": time,
        "solver.substep": np.full(3, substep),
        "energy.kinetic": np.full(3, 9.0),
        "energy.remainder": np.zeros(3),
        "catch.mass": np.full(3, mass),
        **{f"catch.position[{axis}]": np.zeros(3) for axis in (1, 3)},
        "catch.position[2]": -20.0 + (momentum / mass + off) * time,
    }
    for bullet in (1, 2, 3, 4):
        columns |= {
            f"bullet[{bullet}].position[{i}]": np.full(3, place) for i, place in ((1, 0.1), (2, -20.0), (3, 0.1))
        }
    return Evidence(columns, SHOT, {**FREE, "precision": precision}, 1.0)


def limits(evidence: Evidence) -> dict[str, Criterion]:
    return {one.key: one for one in of_capture(evidence)}


def test_numbers_of_24_bits_lie_as_far_apart_as_the_standard_says() -> None:
    """Between 16 and 32 m: 2^(4 - 23) m."""
    assert spacing(flown("single")).tolist() == [2.0**-19] * 3


def test_the_book_of_24_bits_is_not_judged_and_a_run_of_53_is_asked_instead() -> None:
    for scheme in ("leapfrog", "rk4", "xpbd"):
        terms = {**FREE, "solver": scheme, "precision": "single"}
        assert {"energy_gained", "energy_lost"} <= set(build.instead("net_capture", terms))
        assert build.reference("net_capture", terms) == {"precision": "double"}
        assert build.reference("net_capture", {**terms, "precision": "double"}) == {}
    assert build.instead("net_capture", {**FREE, "precision": "single"})["energy_gained"] == "agrees"
    assert "energy_gained" not in build.instead("net_capture", {**FREE, "precision": "double"})


def test_a_case_of_24_bits_is_compared_with_one_of_53() -> None:
    settings = ('capture.net.mesh="4 m"', 'capture.solver.precision="single"')
    maker = _Maker(Alone("deployment", settings, None), "capture", settings, Fmus(Progress()), 1.0, False)
    (own,) = Alone("deployment", settings, None).scene_of("capture", settings).phases
    finest = maker._finest(own, AS_IT_IS)
    assert 'capture.solver.precision="double"' in finest
    assert any(one.startswith("capture.solver.step_ratio") for one in finest)


def test_the_way_of_24_bits_may_be_off_by_half_a_number_a_substep() -> None:
    most = 0.5 * 2.0**-19 * 1e4
    for off, red in ((0.9 * most, False), (1.2 * most, True)):
        one = limits(flown("single", off))["flight"]
        assert (one.value > one.stable) is red
        assert limits(flown("double", off))["flight"].value > 1e-7


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.5, 1.0, 3.0])
@pytest.mark.parametrize("preload", [0.01, 0.3, 3.0])
def test_a_force_that_acts_in_a_snap_adds_no_more_than_twice_itself(zeta: float, preload: float) -> None:
    """m x'' = P - k x - c x', from x = 0 at v: mass, stiffness and speed 1."""

    def change(_: float, state: np.ndarray) -> list[float]:
        return [state[1], preload - state[0] - 2.0 * zeta * state[1]]

    time = np.linspace(0.0, 12.0, 4000)
    x, v = solve_ivp(change, (0.0, 12.0), [0.0, 1.0], t_eval=time, rtol=1e-10, atol=1e-12).y
    peak = float((x + 2.0 * zeta * v).max())
    alone = damped_snap_peak(1.0, 1.0, 1.0, zeta)
    assert -1e-6 < peak - alone <= 2.0 * preload + 1e-6
    assert zeta > 0.0 or preload < 1.0 or peak - alone > preload


def test_a_scheme_that_turns_is_held_to_its_step() -> None:
    """`ros2`: h v/R, a hundredth of it accurate; and nothing of the leapfrog."""
    own = build.within("net_capture", SHOT | {"solver.step_ratio": 10.0}, {**FREE, "solver": "ros2"})
    finer = build.within("net_capture", SHOT | {"solver.step_ratio": 1.0}, {**FREE, "solver": "ros2"})
    accurate, stable = own["angular_momentum"]
    assert accurate == pytest.approx(0.01 * stable)
    assert stable == pytest.approx(10.0 * finer["angular_momentum"][1])
    assert build.within("net_capture", SHOT, {**FREE, "solver": "leapfrog"}) == {}
    assert build.within("net_capture", SHOT, {**FREE, "solver": "xpbd"})["agrees"] == (0.01, math.sqrt(0.05))


class Rows(dict[str, float]):
    """The last row of a run, standing for its recorder."""

    def last(self) -> dict[str, float]:
        return self


@pytest.mark.parametrize(("duration", "opens"), [(2.0, False), (16.0, True)])
def test_an_estimate_follows_a_net_that_opens(duration: float, opens: bool) -> None:
    """A folded net costs 1 ms a second, an open one 30: the price grows evenly until bullets have spread it."""
    settings = (f'capture.duration="{duration} s"', 'capture.macro_step="0.01 s"')
    alone = Alone("deployment", settings, None)
    scene = alone.scene_of("capture", settings)
    (own,) = scene.phases
    values = {**own.main.defaults, **own.main.parameters}
    opened = (values["net.side"] - values["net.fold_side"]) / (
        math.sqrt(2.0) * math.sin(values["bullets.angle"]) * values["bullets.speed"]
    )
    assert (opened < duration) is opens

    def spent(time: float, flat: bool) -> float:
        if flat:
            return 30e-3 * time
        grown = np.minimum(np.linspace(0.0, time, 10001) / opened, 1.0)
        return float(np.mean(1e-3 + 29e-3 * grown) * time)

    def run(short: Scene) -> Any:
        (phase,) = short.phases
        flat = phase.main.parameters.get("net.fold_side", 0.0) > 0.99 * values["net.side"]
        rows = Rows({"solver.steps": 1e4 * phase.duration})
        return SimpleNamespace(error=None, ended_by="", cpu=spent(phase.duration, flat), recorder=rows)

    cost = estimate(scene, run)
    assert cost is not None
    assert cost.cpu == pytest.approx(spent(duration, False), rel=0.25)
    assert cost.steps == pytest.approx(1e4 * duration, rel=1e-3)


OWN_WORDS = "removal stopped at t = 7 s in a step of 1 s:\n  {}\n  (x.fmu: fmi2DoStep gave Error)"


@pytest.mark.parametrize(
    ("words", "kind"),
    [
        ("over more edges than are followed: 64 of a box (index 0, value 0, at 7.5 s)", REFUSED),
        ("the state is no longer finite (index 0, value 0, at 7.5 s)", FAILED),
    ],
)
def test_a_run_that_stops_is_refused_by_its_bound_alone(words: str, kind: str) -> None:
    scene = Alone("tumbling-target", (), None).scene_of("removal")
    cell: Any = SimpleNamespace(scene=scene)
    phase: Any = SimpleNamespace(error=FmuError(OWN_WORDS.format(words)), end=7.0)
    well, ill = (Criterion("longer", "stretch", value, "1", 0.001, 0.01) for value in (0.0, 0.02))
    assert _stopped(cell, phase, [well]).kind == kind
    assert _stopped(cell, phase, [ill]).kind == FAILED, "it was wrong before it stopped"
    (own,) = scene.phases
    foreign: Any = SimpleNamespace(scene=replace(scene, phases=(replace(own, main=replace(own.main, fmu=object())),)))
    assert _stopped(foreign, phase, [well]).kind == FAILED


def test_a_case_that_hangs_ends_its_process_and_one_that_is_slow_does_not() -> None:
    """A wait that uses no processor, and work that uses more of it than is allowed; work within it goes on, however
    long the machine takes for it."""
    waits, works = "time.sleep(30)", "\nwhile time.process_time() < begin + {}: pass"
    for body, code in ((waits, 70), (works.format(30.0), 70), (works.format(0.3), 0)):
        text = (
            "import time; from dcone_cosim.stability.work import _patience\n"
            f"with _patience(0.5):\n begin = time.process_time()\n {body.strip()}"
        )
        found = subprocess.run([sys.executable, "-c", text], check=False, capture_output=True, text=True, timeout=60)
        assert found.returncode == code, found.stderr
        assert ("had not ended" in found.stderr) is (code == 70)
