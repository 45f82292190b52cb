"""The default substep follows the damping: 0.3 % of the mouth area and 1 % of the energy, whatever the ratio."""

import json

import pytest

from tests.net_capture.evidence import steps


@pytest.mark.parametrize("ratio", [0.0, 0.0225, 0.106, 1.0])
def test_the_default_keeps_area_and_energy(shoot, ratio):
    """A thin slice: a coarser net, until chaos sets in after 6 s. The whole is `evidence.steps`."""
    net = shoot({"net.mesh": 2.0, "net.damping_ratio": ratio})
    fine = shoot({"net.mesh": 2.0, "net.damping_ratio": ratio, "solver.step_ratio": share(net) / 4.0})
    for one in (net, fine):
        one.step(6.0)
    assert net["mouth.area"] == pytest.approx(fine["mouth.area"], rel=3e-3)
    assert net["energy.total"] == pytest.approx(fine["energy.total"], abs=0.01 * 9.0)
    assert abs(net["energy.remainder"]) < 0.01 * 9.0


def share(net):
    return net["solver.substep"] / net["solver.stability_bound"]


def test_nine_tenths_of_the_bound_would_not_do_undamped(shoot):
    """The twin: the default of version 0.2.0."""
    net = shoot({"net.damping_ratio": 0.0, "solver.step_ratio": 0.9})
    net.step(15.0)
    assert abs(net["energy.remainder"]) > 0.1 * 9.0


def judge(rows):
    for row in rows:
        assert abs(row["largest_mouth_percent"]) < 0.3
        assert row["mouth_curve_percent"] < 0.3 + 3.0 * row["mouth_curve_standard_error"]
        assert row["energy_percent"] < 1.0
        assert row["remainder_percent"] < 1.0


def test_the_stored_result_meets_what_is_said():
    result = json.loads(steps.RESULT.read_text())
    assert [row["damping_ratio"] for row in result["rows"]] == list(steps.RATIOS)
    judge(result["rows"])


@pytest.mark.evidence
def test_the_default_over_ensembles():
    """Every flight again; the stored result follows."""
    judge(steps.main()["rows"])
