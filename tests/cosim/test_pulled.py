"""By how much a captured net gives: measured on one that is known, handed over, told, and refused where it is none."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from dcone_cosim import pulled
from dcone_cosim.errors import HANDOFF_FAILED, SUCCESS, HandoffError, InputError
from dcone_cosim.loading import load
from dcone_cosim.master import run_scene
from dcone_cosim.phases.second_tow import GIVES, SecondTow, TowHandover
from dcone_cosim.progress import Progress
from dcone_cosim.pulled import COMPLIANCE, Pulled, pull, warnings
from dcone_cosim.reports import summary
from fmu_src.net_capture import pull_off
from tests.cosim.conftest import scene_of
from tests.cosim.mock_components import MockCapture, MockRemoval

FORCE, DELAY, RAMP, WHOLE = 10.0, 1.0, 2.0, 3.0
LOOSE, TIGHT = 0.05, 4e-3
"""How far the vertex of the stand-in is drawn before its net holds [m], and how it gives then [m/N]."""


class PulledCapture(MockCapture):
    """One whose net is drawn by LOOSE at first, of which nothing comes back, and gives as a spring beside that."""

    def __init__(
        self, ends: float = 2.0, loose: float = LOOSE, tight: float = TIGHT, creep: float = 0.0, **more: Any
    ) -> None:
        super().__init__(reports=True, **more)
        self.stood, self.loose, self.tight, self.creep = ends, loose, tight, creep
        values = {"force": FORCE, "delay": DELAY, "ramp": RAMP, "duration": WHOLE}
        for name, value in values.items():
            self.declare([f"pull_off.{name}"], "parameter", value)
        self.declare(["pull_off.drawn", "pull_off.load"], "output")
        self.declare(["pull_off.stands"], "output", kind="Integer")

    def get(self, names: Any) -> dict[str, float]:
        """By type, as of FMUs, whatever the order in which they were asked for."""
        return dict(sorted(super().get(names).items()))

    def refresh(self) -> None:
        super().refresh()
        since = self.since - self.instant - DELAY
        left = 2.0 * RAMP + WHOLE - since
        load = FORCE * max(0.0, min(1.0, since / RAMP, left / RAMP))
        self.values["pull_off.load"] = load
        crept = self.creep * max(0.0, min(since - RAMP, WHOLE))
        self.values["pull_off.drawn"] = (self.loose if since > 0.0 else 0.0) + self.tight * load + crept
        self.values["pull_off.stands"] = 0.0 if since <= 0.0 else 1.0 if left > 1e-9 else self.stood


class NetRemoval(MockRemoval):
    """One that takes a net's compliance over."""

    def __init__(self, name: str = "net.compliance", **more: Any) -> None:
        super().__init__(**more)
        self.declare([name], "parameter", 1e-3)


def handed_over(how: str, capture: MockCapture | None = None, removal: MockRemoval | None = None) -> Any:
    own, taken = capture or PulledCapture(), removal or NetRemoval()
    made = {"capture": own, "removal": taken}
    scene = scene_of("capture", "removal", compare_without_recoil=False, net_compliance=how)
    return run_scene(scene, lambda phase, name: made[phase], Progress()), taken


@pytest.mark.parametrize(("how", "gives"), [("first_pull", LOOSE / FORCE + TIGHT), ("drawn_tight", TIGHT)])
def test_it_is_handed_over_as_the_scene_says(how: str, gives: float) -> None:
    run, removal = handed_over(how)
    assert run.exit_code == SUCCESS
    assert removal.values["net.compliance"] == pytest.approx(gives, rel=1e-9)
    row = next(row for row in run.handovers["removal"].rows if row.quantity == COMPLIANCE)
    assert row.closed
    assert (row.before, row.unit) == (removal.values["net.compliance"], "m/N")
    told = run.handovers["removal"].told()["net"]
    assert told["handed_over"] == how
    assert told["stays"] == {"value": pytest.approx(LOOSE), "unit": "m"}
    assert told["load"]["value"] == FORCE
    findings = {row.key: row.value for row in summary.findings(run)}
    assert findings["net_compliance"] == pytest.approx(gives)
    assert findings["net_drawn"] == pytest.approx(LOOSE + TIGHT * FORCE)


def test_nothing_of_the_pull_is_in_the_rest() -> None:
    """All else is handed over as without it; a net that was not to be pulled is not."""
    run, _ = handed_over("first_pull")
    capture = PulledCapture()
    other, removal = handed_over("given", capture)
    assert "net" not in other.handovers["removal"].told()
    assert removal.values["net.compliance"] == 1e-3
    same = {k: v for k, v in run.left["capture"].items() if not k.startswith("net.")}
    assert same == other.left["capture"]
    assert capture.time == other.phases["capture"].located


def test_a_line_of_nodes_takes_it_at_its_end() -> None:
    run, removal = handed_over("drawn_tight", removal=NetRemoval("lumped.end_compliance"))
    assert run.exit_code == SUCCESS
    assert removal.values["lumped.end_compliance"] == pytest.approx(TIGHT)


def test_what_the_removal_holds_is_judged() -> None:
    run, _ = handed_over("first_pull", removal=NetRemoval(tampered={"net.compliance": 9.000001e-3}))
    assert run.exit_code == HANDOFF_FAILED
    assert COMPLIANCE in run.message


@pytest.mark.parametrize(
    ("capture", "removal", "said"),
    [
        (PulledCapture(ends=3.0), NetRemoval(), "slips off"),
        (PulledCapture(ends=1.0), NetRemoval(), "did not end within 8 s"),
        (PulledCapture(loose=-0.05), NetRemoval(), "which is no compliance"),
        (MockCapture(reports=True), NetRemoval(), "lacks pull_off.stands"),
        (PulledCapture(), MockRemoval(), COMPLIANCE),
    ],
)
def test_what_is_no_compliance_is_refused(capture: MockCapture, removal: MockRemoval, said: str) -> None:
    run, _ = handed_over("first_pull", capture, removal)
    assert run.exit_code == HANDOFF_FAILED
    assert said in run.message


def test_steps_that_do_not_see_the_load_are_told() -> None:
    capture = PulledCapture()
    capture.enter_initialisation(0.0)
    capture.step(0.0, capture.instant)
    with pytest.raises(HandoffError, match="macro steps of 4 s do not see 10 N"):
        pull(capture, capture.instant, 4.0)


def test_a_first_tug_far_from_the_load_is_warned_of() -> None:
    net = Pulled(1e-2, 1e-3, 10.0, 0.05)
    assert not list(warnings("removal", net, 6.0))
    for peak in (4.9, 20.1):
        (said,) = warnings("removal", net, peak)
        assert "measured at 10 N" in said


@pytest.mark.parametrize(("creep", "told"), [(0.0, False), (1e-3, False), (4e-3, True), (-4e-3, True)])
def test_a_net_that_is_drawn_on_under_the_whole_load_is_warned_of(creep: float, told: bool) -> None:
    """Its way is then that of no load: over WHOLE seconds it changes by `creep` times as many, of (LOOSE + TIGHT F)."""
    capture = PulledCapture(creep=creep)
    capture.enter_initialisation(0.0)
    capture.step(0.0, capture.instant)
    net = pull(capture, capture.instant, 0.1)
    assert net.gave_way == pytest.approx(creep * WHOLE, abs=1e-9)
    assert Pulled.of(net.left(), "drawn_tight") == replace(net, how="drawn_tight")
    said = list(warnings("removal", net, FORCE))
    assert len(said) == told
    assert all(f"changed by {creep * WHOLE:.3g} m" in text for text in said)


def test_a_second_tow_has_the_same_net() -> None:
    """What the first gives is handed on; a net in one tow alone, or of another compliance, is a mistake."""
    gives = "removal.net.compliance=5 mm/N"
    for own, said in ((), "holds the target in both tows"), (("second_tow.net.compliance=1 mm/N",), "is set by the"):
        with pytest.raises(InputError) as stop:
            load("two-tows", (gives, *own))
        assert said in str(stop.value)
    scene = load("two-tows", (gives, "second_tow.net={}"))
    tow = scene.phases[1]
    assert GIVES in SecondTow.takes_too
    left = {name: 1.0 for name in (*SecondTow.takes, GIVES)} | {"center.position[3]": 7e6}
    record = TowHandover(0.0, 0.0, tow, left | {GIVES: 5e-3}, None)
    assert record.parameters(NetRemoval())[GIVES] == 5e-3


PULL = ("capture.pull_off.force=10 N", "capture.pull_off.after=captured")


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ((), "needs the table [capture.pull_off]"),
        (PULL, "needs the table [removal.net]"),
        ((*PULL, "removal.net.compliance=1 mm/N"), "is handed over by handoff.net_compliance"),
        (
            (*PULL, "capture.hand_over=settled", "capture.settling.speed=0.1 m/s"),
            'must be capture.hand_over, "settled"',
        ),
    ],
)
def test_scenes_in_which_it_means_nothing_are_refused(settings: tuple[str, ...], said: str) -> None:
    with pytest.raises(InputError) as stop:
        load("mission", ("handoff.net_compliance=first_pull", *settings))
    assert said in str(stop.value)


def test_what_the_net_says_of_its_test_is_read_as_it_is_meant() -> None:
    """The master knows the two outcomes by their numbers alone."""
    assert (pulled.HELD, pulled.SLIPPED_OFF) == (pull_off.HELD, pull_off.SLIPPED_OFF)
