"""The pull on the closed net: a pulse of the tug's height, and what is kept of what the net bears."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from dcone_cosim.cases.alone import Alone
from dcone_cosim.cases.rows import Row
from dcone_cosim.contract import OUTCOMES
from dcone_cosim.progress import Progress
from dcone_cosim.sizing import closed_net
from dcone_cosim.sizing.closed_net import Pull, borne
from tests.cosim.conftest import scene_of

CAUGHT = 0.2


class Net:
    """A net that is caught after a while, and of which a thread bears twice what pulls at it."""

    def __init__(self, turns: float = 0.0) -> None:
        """turns: rate of the target, and of the net about it [rad/s]"""
        self.turns = turns
        self.time = self.pull = self.peak = self.impulse = 0.0
        self.pulls: list[tuple[float, float, float]] = []

    def set(self, values: Mapping[str, float]) -> None:
        self.pull = values.get(closed_net.PULL, self.pull)

    def enter_initialisation(self, start: float, stop: float | None = None) -> None:
        self.time = start

    def exit_initialisation(self) -> None:
        pass

    def step(self, time: float, size: float) -> None:
        assert time == pytest.approx(self.time)
        self.pulls.append((time, size, self.pull))
        self.peak, self.impulse = 2.0 * self.pull, self.impulse + 3.0 * self.pull * size
        self.time += size

    def get(self, names: Sequence[str]) -> dict[str, float]:
        known = {
            "captured": float(self.time > CAUGHT),
            "outcome": float(OUTCOMES.index("captured" if self.time > CAUGHT else "flying")),
            "thread.tension_peak": self.peak,
            "contact.impulse": self.impulse,
            "enclosure.share": 0.97,
            **dict.fromkeys(closed_net.PLACES, 0.0),
        }
        # the net slides a tenth of a metre a second, on a target that lies a quarter turn about its third axis
        known["catch.position[1]"] = 2.0 + 0.1 * self.time
        known["target.position[2]"] = 1.0
        known["target.attitude[1]"] = known["target.attitude[4]"] = math.sqrt(0.5)
        if self.turns:
            angle = self.turns * self.time
            known["catch.position[1]"], known["catch.position[2]"] = 2.0 * math.cos(angle), 1.0 + 2.0 * math.sin(angle)
            known["target.attitude[1]"], known["target.attitude[4]"] = math.cos(0.5 * angle), math.sin(0.5 * angle)
        return {name: known[name] for name in names}


def pulled(tug: float, lasts: float = 1.3) -> tuple[dict[str, float], Net]:
    net: Any = Net()
    case = Pull("key", scene_of("capture"), tug=tug, light=0.8, lasts=lasts)
    return closed_net._pulled(case, net), net


def test_the_pulse_is_a_half_wave_of_the_tugs_height() -> None:
    found, net = pulled(40.0)
    assert max(pull for *_, pull in net.pulls) == pytest.approx(40.0, rel=2e-3)
    begin = next(time for time, _, pull in net.pulls if pull > 1.0)
    given = sum(size * pull for time, size, pull in net.pulls if begin <= time < begin + 1.3)
    assert given == pytest.approx(40.0 * 1.3 * 2.0 / math.pi, rel=5e-3), "the impulse of half a sine"
    assert found["thread"] == pytest.approx(80.0, rel=2e-3)
    assert found["contact"] == pytest.approx(120.0, rel=2e-3)
    assert found["drawn"] == pytest.approx(1.6, rel=0.06)
    assert found["slip"] == pytest.approx(0.1 * (1.3 + closed_net.AFTER), rel=0.03)
    early = [pull for time, _, pull in net.pulls if time < CAUGHT]
    assert not np.any(early), "nothing pulls while the net flies"


def test_a_net_that_turns_with_the_target_does_not_slide() -> None:
    net: Any = Net(turns=0.3)
    found = closed_net._pulled(Pull("key", scene_of("capture"), tug=40.0, light=0.8, lasts=1.3), net)
    assert found["slip"] == pytest.approx(0.0, abs=1e-12)


def test_the_pulse_does_not_fall_below_the_light_pull() -> None:
    """As a long one would, at its edges."""
    _, net = pulled(40.0, lasts=400.0)
    begin = next(time for time, _, pull in net.pulls if pull > 1.0)
    late = [pull for time, _, pull in net.pulls if time > begin]
    assert min(late) == 0.8


def test_each_start_is_run_with_the_pulse_and_without(monkeypatch: pytest.MonkeyPatch) -> None:
    """The light pull is a fiftieth of the tug in both; a scene without a capture has none."""
    monkeypatch.setattr(closed_net, "Fmus", lambda progress: SimpleNamespace(of=lambda scene: {}))
    found = closed_net.cases(Alone("mission", (), None), 40.0, 1.3, 2, Progress())
    assert [(one.seed, one.tug, one.light, one.lasts) for one in found] == [
        (seed, tug, 0.8, 1.3) for seed in (0, 1) for tug in (0.0, 40.0)
    ]
    assert len({one.key for one in found}) == 4
    assert closed_net.cases(Alone("table2-deorbit", (), None), 40.0, 1.3, 2, Progress()) == []


def test_without_the_pulse_the_light_pull_goes_on() -> None:
    found, _ = pulled(0.0)
    assert found["thread"] == pytest.approx(1.6, rel=1e-6)


def test_a_run_that_fails_is_told() -> None:
    case = Pull("key", scene_of("capture"), tug=5.0)
    (one,) = borne([case], {"key": Row("key", "failed", 5, "no capture\nwithin 3 s")})
    assert math.isnan(one.thread)
    assert one.failure == "within 3 s"
