"""Other programs on our problems: each written anew, and near the truth at a fine tolerance."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

import numpy as np
import pytest

from dcone_cosim.accuracy import peers
from dcone_cosim.accuracy.peers import net, tow
from dcone_cosim.accuracy.peers.peer import Peer
from dcone_cosim.accuracy.plan import Planned, Planner
from dcone_cosim.accuracy.settings import Setting
from dcone_cosim.accuracy.work import measure
from dcone_cosim.cases.alone import Alone
from dcone_cosim.progress import Progress
from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from tests.conftest import FREE
from tests.consistency.test_table2 import REFERENCE
from tests.net_capture.memory import shown
from tests.validation import Validated, other_code


@pytest.fixture(scope="module")
def pair() -> dict[str, float]:
    return Planner(Alone("table2-deorbit", ["removal.duration=70 min"], None), "removal", Progress())._begun()


def found(peer: Peer, values: dict[str, float], size: float, instants: Any) -> dict[str, Any]:
    return {q.key: np.array(q.values) for q in peer.run(values, size, tuple(instants)).quantities}


@pytest.mark.parametrize("peer", tow.PEERS, ids=lambda peer: peer.name)
def test_a_tow_against_quadruple_precision(peer: Peer, pair: dict[str, float]) -> None:
    """The same first five tugs as the reference integration, at a fine tolerance; a mass 1 % off is seen."""
    if find_spec(peer.package) is None:
        pytest.skip(f"{peer.name} is not installed")
    instants, exact = np.arange(60.0, 4200.1, 60.0), np.array(REFERENCE["B"][1])
    mine = found(peer, pair, peer.sizes[-1], instants)
    np.testing.assert_allclose(mine["tug_times"], exact[:, 0], rtol=1e-8)
    np.testing.assert_allclose(mine["tug_peaks"], exact[:, 2], rtol=2e-6)
    heavier = found(peer, pair | {"target.mass": 1.01 * pair["target.mass"]}, peer.sizes[-1], instants)
    assert np.abs(heavier["tug_peaks"] / exact[:, 2] - 1.0).max() > 1e-4


def test_what_a_tow_is_judged_by_is_what_scipy_finds() -> None:
    """Mean tension, orbit, radius and separation of our run, each against the same from scipy's states."""
    planner = Planner(Alone("table2-deorbit", ["removal.duration=70 min", "removal.macro_step=2 min"], None), "removal",
                      Progress())  # fmt: skip
    (case,) = planner.cases(Planned(Setting("", "", 1.0, ())), 1).values()
    mine = measure(case).samples
    theirs = {q.key: np.array(q.values) for q in tow.by_scipy(planner._begun(), 1e-13, case.instants).quantities}
    for key in ("mean_tension", "largest_tug", "separation", "radius", "semi_major_axis"):
        np.testing.assert_allclose(mine[key]["values"], theirs[key], rtol=1e-7, err_msg=key)
    # an error is relative to how far the orbit falls, and to how far a radius swings
    axis, radius = theirs["semi_major_axis"], theirs["radius"]
    assert mine["semi_major_axis"]["scale"] == pytest.approx(abs(axis[-1] - axis[0]), rel=0.1)
    assert mine["radius"]["scale"] == pytest.approx(np.ptp(radius), rel=0.1)
    assert mine["separation"]["scale"] == pytest.approx(theirs["separation"].max(), rel=1e-3)


@pytest.fixture(scope="module")
def opening() -> tuple[dict[str, float], Any, Any]:
    """A small net at the shot, instants, and the mouth that our model has then, with small steps."""
    given = {"net.side": 4.0, "net.mesh": 1.0, "net.fold_side": 0.5, "net.damping_ratio": 0.05}
    ours = Instance(MODEL, FREE, given | {"solver.step_ratio": 0.05}).initialise()
    values = {name: float(ours[name]) for name in ours.interface.references}
    for number, place in enumerate(shown(ours), start=1):
        values |= {f"node[{number}].position[{i}]": float(x) for i, x in enumerate(place, start=1)}
    areas, instants = [], np.arange(0.1, 0.91, 0.1)
    for _ in instants:
        ours.step(0.1)
        areas.append(ours["mouth.area"])
    return values, instants, np.array(areas)


@pytest.mark.parametrize("peer", net.PEERS, ids=lambda peer: peer.name)
def test_a_net_against_ours(validated: Validated, peer: Peer, opening: tuple[dict[str, float], Any, Any]) -> None:
    """A net of 25 knots opens to the same mouth; MuJoCo's damps slack threads, and opens less."""
    if find_spec(peer.package) is None:
        pytest.skip(f"{peer.name} is not installed")
    values, instants, ours = opening
    mine = found(peer, values, peer.sizes[-1], instants)["mouth_area"]
    if peer.name == "MuJoCo":
        assert np.abs(mine - ours).max() / 16.0 > 0.05
    else:
        anew = other_code(f"{peer.name}, the net written anew")
        validated(anew, "net of 25 knots: mouth area over 0.9 s", ours, mine, "m2", abs=1e-3 * 16.0)
    assert ours.max() > 4.0


def test_the_problem_is_that_of_the_fmu(opening: tuple[dict[str, float], Any, Any]) -> None:
    values, _, _ = opening
    made = net.problem(values)
    assert made.masses.sum() == pytest.approx(values["catch.mass"], rel=1e-12)
    momentum = made.masses @ made.rates
    catch = np.array([values[f"catch.velocity[{i}]"] for i in (1, 2, 3)])
    np.testing.assert_allclose(momentum, values["catch.mass"] * catch, rtol=1e-2, atol=1e-9)


def test_a_peer_is_tried_only_on_what_it_can_compute(monkeypatch: pytest.MonkeyPatch) -> None:
    def names(scene: str, *settings: str) -> list[str]:
        return [peer.name for _, peer in peers.peers_of(Alone(scene, settings, None).scene.phases[0], notes)]

    notes: list[str] = []
    monkeypatch.setattr(peers, "find_spec", lambda name: object())
    assert names("mission") == []
    assert names("reel-control") == []
    assert names("electric-tug") == names("edt") == names("release-and-cut") == []
    assert names("table2-deorbit") == [peer.name for peer in tow.PEERS]
    assert "MuJoCo" not in names("deployment")  # too many nodes for it
    assert "MuJoCo" in names("deployment", "capture.net.mesh=2 m")
    assert names("deployment", 'capture.gravity.law="hill"', "capture.net.segments=1") == []
    assert notes == []
    monkeypatch.setattr(peers, "find_spec", lambda name: None if name == "heyoka" else object())
    assert "heyoka Taylor" not in names("table2-deorbit")
    assert "pip install" in notes[0]
