"""What becomes of a case by what was measured of it, and what a tow is measured by."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from dcone_cosim.cases.cost import Cost
from dcone_cosim.criteria import Criterion, Evidence
from dcone_cosim.phases.removal_criteria import criteria as of_removal
from dcone_cosim.phases.removal_criteria import pushed
from dcone_cosim.quantities import Quantity
from dcone_cosim.stability.judge import (
    ACCURATE,
    FAILED,
    REFUSED,
    STABLE,
    agreement,
    falls,
    refusal,
    sameness,
    suited,
    unlike,
    verdict,
)
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.oscillators import damped_snap_peak, line_stiffness, reduced_mass


def share(value: float, key: str = "energy_gained") -> Criterion:
    return Criterion(key, "energy gained", value, "1", 0.01, 0.05)


def test_a_verdict_follows_the_worst() -> None:
    assert verdict([share(0.001)], "energy_gained").kind == ACCURATE
    assert verdict([share(0.001), share(0.02)], "energy_gained").kind == STABLE
    found = verdict([share(0.02), share(0.06, "depth"), share(0.07)], "energy_gained")
    assert (found.kind, found.text) == (FAILED, "energy gained: 7 %, more than 5 %")
    assert verdict([share(math.nan)], "energy_gained").kind == FAILED


def test_a_case_whose_own_criterion_was_not_looked_at_is_red() -> None:
    assert verdict([share(0.001)], "depth").kind == FAILED


def test_a_refusal_counts_with_its_bound_alone() -> None:
    assert refusal("must be at most 12 m").kind == REFUSED
    assert refusal("start.relative_position is zero: the line has no direction").kind == REFUSED
    assert refusal("cannot be done").kind == FAILED


def test_a_cost_is_told_with_its_steps() -> None:
    assert Cost(11550.0, 2.1e10).told() == "about 3.2 h (2.1e+10 steps of 0.55 us)"


def curve(values: np.ndarray) -> list[Quantity]:
    return [Quantity("mouth", "mouth area", values.tolist(), "m2", 100.0, "the flat net's area")]


def test_a_chaotic_run_is_compared_while_its_twin_stays_with_it() -> None:
    time = np.linspace(0.0, 10.0, 101)
    here = 50.0 + time
    twin = here + np.where(time > 5.0, 5.0, 0.0)
    finer = here + np.where(time > 5.0, 30.0, 0.5)
    found = agreement(curve(here), curve(finer), curve(twin), 101)
    assert found.value == pytest.approx(0.005)
    assert agreement(curve(here), curve(finer), curve(here), 101).value == pytest.approx(0.3)
    early = here + np.where(time > 1.0, 5.0, 0.0)
    assert math.isinf(agreement(curve(here), curve(finer), curve(early), 101).value)


def test_a_tow_is_compared_in_what_its_twin_comes_to_as_well() -> None:
    """Its first tugs until the twin's are others, its mean tension if the twin has the same; and nothing else."""

    def tow(times: list[float], mean: float) -> list[Quantity]:
        return [
            Quantity("tug_times", "times of the first 5 tugs", times, "s"),
            Quantity("mean_tension", "mean tension", [mean], "N"),
        ]

    here, finer = tow([10.0, 20.0, 30.0, 40.0, 50.0], 2.0), tow([10.0, 20.1, 30.0, 50.0, 90.0], 2.4)
    assert agreement(here, finer, None).value == pytest.approx(4.0 / 9.0)
    assert agreement(here, finer, tow([10.0, 20.0, 30.0, 47.0, 91.0], 1.8)).value == pytest.approx(0.1 / 20.1)
    assert agreement(here, finer, tow([10.0, 20.0, 30.0, 47.0, 91.0], 2.0)).value == pytest.approx(1.0 / 6.0)
    assert math.isinf(agreement(here, finer, tow([11.0, 12.0, 13.0, 14.0, 15.0], 1.8)).value)


def test_what_an_accuracy_does_not_mean_is_compared_where_there_is_nothing_else() -> None:
    """As of an FMU from elsewhere that has a separation and no line."""
    apart = [Quantity("separation", "separation over time", [10.0, 10.2], "m", 10.2, "its largest", False)]
    finer = [Quantity("separation", "separation over time", [10.0, 10.5], "m", 10.5, "its largest", False)]
    pull, other = ([Quantity("mean_tension", "mean tension", [value], "N")] for value in (1.0, 1.001))
    assert agreement(apart, finer, None).value == pytest.approx(0.3 / 10.2)
    assert agreement([*apart, *pull], [*finer, *other], None).value == pytest.approx(0.001 / 1.001)
    assert math.isinf(agreement(apart, pull, None).value)


def test_a_finer_run_that_differs_much_is_red() -> None:
    here = 50.0 + np.linspace(0.0, 10.0, 101)
    for off, kind in ((0.5, ACCURATE), (3.0, STABLE), (6.0, FAILED)):
        assert verdict([agreement(curve(here), curve(here + off), None, 101)], "agrees").kind == kind
    assert verdict([unlike("it grazes")], "agrees").kind == STABLE


def test_a_scheme_leaves_out_what_means_nothing_with_it_and_has_limits_of_its_own() -> None:
    found = suited([share(0.06), share(0.06, "bound"), share(0.06, "agrees")], {"bound": ""}, {"agrees": (0.02, 0.1)})
    assert [(one.key, one.accurate, one.stable) for one in found] == [
        ("energy_gained", 0.01, 0.05),
        ("agrees", 0.02, 0.1),
    ]


def test_other_macro_steps_give_the_same() -> None:
    end = [Quantity("mouth", "mouth area", [5.0], "m2", 100.0, "the flat net's area")]
    off = [Quantity("mouth", "mouth area", [5.001], "m2", 100.0, "the flat net's area")]
    assert verdict([sameness(end, end)], "same").kind == ACCURATE
    assert verdict([sameness(end, off)], "same").kind == FAILED
    assert verdict([sameness(end, [])], "same").kind == FAILED


def test_an_error_must_fall_with_more_than_the_first_power() -> None:
    at = {order: falls([share(1e-3)], [share(1e-3 / 4.0**order)], 2e-6) for order in (1, 2)}
    assert verdict([at[2]], "order").kind == ACCURATE
    assert verdict([at[1]], "order").kind == FAILED


MASSES = {"chaser.mass": 2000.0, "target.mass": 1000.0}
LINE = {
    "tether.rest_length": 12.0,
    "reel.length_offset": 0.0,
    "tether.youngs_modulus": 60e9,
    "tether.diameter": 1e-3,
    "tether.damping_ratio": 0.05,
    "orbit.altitude": 800e3,
    "orbit.eccentricity": 0.0,
}


def tow(peak: float, length: float = 12.0, tension: float = 0.0, newest: float = 119.5) -> Evidence:
    """A locked line without thrust, whose first tug had this peak [N], and the newest, since some instant [s], 1 N."""
    ones = np.ones(3)
    columns = {
        "time": np.array([0.0, 60.0, 120.0]),
        "tether.tension": tension * ones,
        "tether.tension_peak": peak * ones,
        "tether.tension_least": 0.0 * ones,
        "tether.impulse": np.array([0.0, 1.0, 2.0]),
        "tether.length": length * ones,
    }
    return Evidence(columns, {**MASSES, **LINE}, {"reel": "locked"}, 120.0, [(30.0, peak, 0.01), (newest, 1.0, 0.001)])


def red(evidence: Evidence) -> set[str]:
    return {one.key for one in of_removal(evidence) if not one.value <= one.stable}


def test_a_snap_is_held_against_its_closed_form_from_both_sides() -> None:
    stiffness = line_stiffness(60e9, 1e-3, 12.0)
    peak = damped_snap_peak(0.01, stiffness, reduced_mass(2000.0, 1000.0), 0.05)
    assert red(tow(peak)) == set()
    assert red(tow(1.05 * peak)) == {"snap"}
    assert red(tow(0.95 * peak)) == {"snap"}
    # 1 N is two thirds of what a millimetre per second gives; half a vibration takes 1.3 s
    assert red(tow(peak, newest=118.0)) == {"snap"}


def test_a_snap_on_a_body_that_turns_is_judged_where_it_is_quick() -> None:
    """The line's own motion has 2.4 rad/s: with 0.05 rad/s twice the hardest peak is red, with 1 not told."""
    hardest = 0.01 * math.sqrt(line_stiffness(60e9, 1e-3, 12.0) * reduced_mass(2000.0, 1000.0))
    for spin, told in ((0.05, True), (1.0, False)):
        rates = {f"target.start_rate[{axis}]": spin if axis == 3 else 0.0 for axis in (1, 2, 3)}
        plain = tow(2.0 * hardest)
        turning = Evidence(
            plain.columns, {**plain.values, **rates}, {"reel": "locked", "target": "box"}, 120.0, plain.tugs
        )
        assert ("snap" in {one.key for one in of_removal(turning)}) is told
        assert ("snap" in red(turning)) is told


def test_a_line_neither_pushes_nor_is_longer_than_its_tension_makes_it() -> None:
    stiffness = line_stiffness(60e9, 1e-3, 12.0)
    peak = damped_snap_peak(0.01, stiffness, reduced_mass(2000.0, 1000.0), 0.05)
    assert red(tow(peak, 12.0 + 0.99 * peak / stiffness)) == set()
    assert red(tow(peak, 12.0 + 1.05 * peak / stiffness)) == {"longer"}
    assert red(tow(peak, tension=-0.1)) == {"pushes"}
    assert red(tow(math.nan)) >= {"finite"}


def adrift(thrust: float, told: float) -> Evidence:
    """Two bodies and a slack line for ten minutes, by Hill's equations; and the thrust that the scene tells.

    x'' = 3 n2 x + 2 n y',   y'' = -2 n x' - F/m_c
    """
    rate = math.sqrt(EARTH_MU / (EARTH_EQUATORIAL_RADIUS + LINE["orbit.altitude"]) ** 3)
    mass, chaser = reduced_mass(2000.0, 1000.0), MASSES["chaser.mass"]

    def change(_: float, state: np.ndarray) -> list[float]:
        x, _, u, v = state
        return [u, v, 3.0 * rate**2 * x + 2.0 * rate * v, -2.0 * rate * u - thrust / chaser]

    time = np.linspace(0.0, 600.0, 200)
    found = solve_ivp(change, (0.0, time[-1]), [1.0, 10.0, 0.0, 0.0], t_eval=time, rtol=1e-10, atol=1e-12).y
    x, y, u, v = found
    columns = {
        "time": time,
        "relative.position[1]": x,
        "relative.position[2]": y,
        "separation": np.hypot(x, y),
        "energy.relative": mass * (0.5 * (u**2 + v**2) - 1.5 * rate**2 * x**2),
        "center.semi_major_axis": np.full(len(time), EARTH_EQUATORIAL_RADIUS + LINE["orbit.altitude"]),
    }
    values = {**MASSES, **LINE, "tether.damping_ratio": 0.0, "thrust.level": told, "thrust.offset": 0.0}
    return Evidence(columns, values, {"reel": "locked", "thrust": "along_track"}, float(time[-1]))


def test_under_thrust_the_integral_of_the_relative_motion_is_kept() -> None:
    assert "jacobi" in {one.key for one in of_removal(adrift(-0.02, -0.02))}
    assert red(adrift(-0.02, -0.02)) == set()
    assert red(adrift(0.0, 0.0)) == set()
    for told in (0.02, 0.0):
        assert red(adrift(-0.02, told)) & {"jacobi", "jacobi_falls"}


def test_what_a_thruster_gives_of_which_some_meets_the_target() -> None:
    """By the momentum of what was burnt at 300 s, half of it against the target at the end, of a pair that is
    10 kg and then 20 kg lighter; without an engine the masses stay, without a push all of it counts."""
    columns = {
        "time": np.array([0.0, 1.0, 2.0]),
        "chaser.propellant": np.array([0.0, 10.0, 20.0]),
        "plume.share": np.array([0.0, 0.0, 0.5]),
    }
    exhaust = 300.0 * 9.80665
    values = {**MASSES, "thrust.level": -1.0, "thrust.offset": 0.0, "thrust.specific_impulse": 300.0}
    for terms, pushes, expected in (
        ({"engine": "chemical", "plume": "beam"}, 1.0, [-10.0 * exhaust / 2995.0, -7.5 * exhaust / 2985.0]),
        ({"engine": "chemical", "plume": "beam"}, 0.0, [-10.0 * exhaust / 2995.0, -10.0 * exhaust / 2985.0]),
        ({"burn": "timed"}, 1.0, [-10.0 * exhaust / 3000.0, -10.0 * exhaust / 3000.0]),
        ({}, 1.0, [-1.0 / 3000.0, -1.0 / 3000.0]),
    ):
        evidence = Evidence(columns, {**values, "plume.pushes": pushes}, {"thrust": "along_track", **terms}, 2.0)
        assert pushed(evidence).tolist() == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("message", "kind"),
    [
        ('line 12: capture.net.mesh = "0.1 m": must be at least 0.2 m', REFUSED),
        ('line 12: capture.net.mesh = "0.1 m": is not possible', FAILED),
        ("--set removal.tether.rest_length=12 m: removal.tether.rest_length = 12: cannot be", FAILED),
        ("--set removal.tether.rest_length=12 m: removal.tether.rest_length = 12: must exceed 20 m", REFUSED),
        ("the net is bad (net.mesh, value 0.1, at 0 s)", FAILED),
        ('--set removal.start.relative_position=["0 m", "0 m", "0 m"]: start.relative_position is zero: no direction '
         "(start.relative_position[1], value 0, at 0 s)", REFUSED),
        ("too long: about 31 s (6.6e+06 steps of 4.7 us), and 20 s are allowed", REFUSED),
    ],
)  # fmt: skip
def test_a_line_number_or_the_value_given_is_no_bound(message: str, kind: str) -> None:
    assert refusal(message).kind == kind


def test_a_wound_line_is_no_longer_than_it_is_stretched() -> None:
    """Beyond what is wound out by T/k and no more; the same line with one millimetre beyond that is found."""
    values = {"tether.youngs_modulus": 60e9, "tether.diameter": 1e-3, "tether.rest_length": 12.0}
    stiffness = line_stiffness(60e9, 1e-3, 14.0)
    wound, peak = np.array([12.0, 13.0, 14.0]), np.array([0.0, 1.0, 2.0])
    columns = {"time": np.arange(3.0), "reel.paid_out": wound, "tether.tension_peak": peak}
    for beyond, limit in ((0.0, 1e-9), (1e-3, math.inf)):
        columns["tether.length"] = wound + peak / stiffness + beyond * (peak > 1.0)
        evidence = Evidence(columns, values, {"reel": "schedule"}, 3.0)
        (found,) = [one for one in of_removal(evidence) if one.key == "longer"]
        assert found.value <= limit
        assert (found.value > found.stable) == (beyond > 0.0)
