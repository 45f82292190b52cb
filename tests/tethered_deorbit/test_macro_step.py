"""Communication points read the trajectory and leave no trace in it; saved states go on as if nothing had been."""

import math

import numpy as np
import pytest

from fmu_src.instance import Instance, ModelFault
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.frames import orbital_basis, relative_to_orbital, state_to_orbital
from orbital.kepler import elements_to_state

TERMS = {"reel": "locked", "thrust": "along_track"}
END = 7000.0
BUFFERS = (
    *("state_basis", "state_vector", "state_dense_ready"),
    *("tether_tension_peak", "tether_tension_least", "state_peak", "state_least"),
)
"""Fields that may depend on when one looked: room for vectors, a flag for lazy work, the last macro step's extremes."""


def tow(**parameters: float) -> Instance:
    return Instance(MODEL, TERMS, {k.replace("__", "."): v for k, v in parameters.items()}).initialise()


def run(step: float, end: float = END, **parameters: float) -> Instance:
    i = tow(**parameters)
    for _ in range(round(end / step)):
        i.step(step)
    return i


def fingerprint(i: Instance) -> dict[str, bytes]:
    return {n: i.record[n].tobytes() for n in i.record.dtype.names if n not in BUFFERS}


@pytest.mark.parametrize("zeta", [0.0, 0.05])
def test_same_bits_whatever_the_macro_step(zeta: float) -> None:
    expected = fingerprint(run(1.0, tether__damping_ratio=zeta))
    for step in (7.0, 1000.0, END):
        assert fingerprint(run(step, tether__damping_ratio=zeta)) == expected
    other = fingerprint(run(1000.0, tether__damping_ratio=zeta, tether__rest_length=12.0 + 1e-12))
    assert [n for n in ("tug_time", "tug_peak", "center_position", "relative_position") if other[n] != expected[n]]


def test_same_bits_at_common_times_and_tiny_steps() -> None:
    """Inside a tug, at macro steps far below the integrator's own."""
    fine, coarse = tow(), tow()
    fine.step(1119.0)
    coarse.step(1119.0)
    for _ in range(15):
        coarse.step(0.125)
        for _ in range(128):
            fine.step(2.0**-10)
        assert fingerprint(fine) == fingerprint(coarse)
    assert fine["tether.tug_count"] == 1


def test_drifting_communication_points() -> None:
    """t += 0.1 misses the round numbers: the trajectory does not notice, and a step of no length changes nothing."""
    drifting, exact = run(0.1, 1200.0), run(1200.0, 1200.0)
    for name in ("tug_time", "tug_peak", "tug_speed"):
        assert np.array_equal(drifting.record[name], exact.record[name])
    before = drifting.record.tobytes(), drifting.work.tobytes()
    drifting.step(0.0)
    assert (drifting.record.tobytes(), drifting.work.tobytes()) == before
    drifting.time += 1.0
    with pytest.raises(ModelFault, match="communication point"):
        drifting.step(1.0)


def test_tension_peak_sees_between_the_points() -> None:
    i = tow(tether__damping_ratio=0.0)
    i.step(1110.0)
    assert i["tether.tension_peak"] == 0.0
    i.step(60.0)
    assert i["tether.tension"] == 0.0
    assert i["tether.tension_peak"] == i["tug[1].peak"]
    assert i["tether.tension_peak"] == pytest.approx(3.1852257630, rel=1e-9)  # table2_reference.json, case A
    i.step(60.0)
    assert i["tether.tension_peak"] == 0.0


def test_nothing_of_the_future() -> None:
    """A tug is seen from its instant on, not before, and its peak grows until it is over."""
    i = tow(tether__damping_ratio=0.0)
    i.step(1119.0083)
    assert (i["tether.tug_count"], i["tug[1].time"], i["tether.taut"]) == (0, 0.0, 0)
    i.step(1e-4)
    assert i["tether.tug_count"] == 1
    assert i["tether.taut"] == 1
    peaks = []
    for _ in range(140):
        i.step(0.01)
        peaks.append(i["tug[1].peak"])
        if i["tether.taut"]:
            assert i["tether.tension"] <= peaks[-1] * (1.0 + 1e-12)
    assert all(np.diff(peaks) >= -1e-12)
    assert peaks[20] < 0.5 * peaks[-1]


def test_saved_in_the_middle_of_a_tug() -> None:
    i = tow()
    i.step(1119.4)
    assert i["tether.taut"] == 1
    record, work, time = i.record.copy(), i.work.copy(), i.time
    i.step(3000.0)
    expected = i.record.tobytes(), i.work.tobytes()
    other = Instance(MODEL, TERMS)
    other.record[:], other.work, other.time = record, work, time
    other.step(3000.0)
    assert (other.record.tobytes(), other.work.tobytes()) == expected
    other.record[:], other.work, other.time = record, work, time
    other.work[6] += 1e-12
    other.step(3000.0)
    assert other.work.tobytes() != expected[1]


def test_initialised_anew() -> None:
    """Nothing of an earlier run is left, in which there were tugs and another thrust."""
    i = tow()
    i.step(5000.0)
    i["thrust.offset"] = 1e-3
    i.step(10.0)
    i["thrust.offset"] = 0.0
    i.initialise(0.0).step(2000.0)
    fresh = tow()
    fresh.step(2000.0)
    assert fingerprint(i) == fingerprint(fresh)


@pytest.mark.parametrize("start", [5.0, 100.0, -50.0, 1e6])
def test_same_bits_whatever_the_start_time(start: float) -> None:
    """Everything counts from the start of the instance; only the fields that keep that start differ."""

    def begun(start: float, **parameters: float) -> Instance:
        i = Instance(MODEL, TERMS, parameters).initialise(start)
        for step in (1000.0, 0.25, 3000.0, 60.0):
            i.step(step)
        i["thrust.offset"] = 0.001
        i.step(1000.0)
        return i

    at_zero, elsewhere = fingerprint(begun(0.0)), fingerprint(begun(start))
    assert [n for n in at_zero if at_zero[n] != elsewhere[n]] == ["state_start"]
    assert begun(start)["tug[1].time"] < 5060.25
    spoilt = fingerprint(begun(start, **{"start.separation": 10.0 + 1e-12}))
    assert spoilt["tug_time"] != at_zero["tug_time"]


def test_communication_points_at_a_late_start() -> None:
    """t += 0.1 from 1e6 s, whose last digit is 1e-10 s: steps are taken, a gap is refused and told in that clock."""
    i = Instance(MODEL, TERMS).initialise(1e6)
    for _ in range(3000):
        i.step(0.1)
    exact = run(300.0, 300.0)
    assert i["separation"] == pytest.approx(exact["separation"], abs=1e-9)
    i.time += 0.01
    with pytest.raises(ModelFault, match=r"communication point.* at 1000300 s"):
        i.step(0.1)


def as_parameters(i: Instance) -> Instance:
    """A new instance that starts, by hand-over, in the present state of another on a circular orbit."""
    rate = math.sqrt(EARTH_MU / (EARTH_EQUATORIAL_RADIUS + i["orbit.altitude"]) ** 3)
    other = Instance(MODEL, TERMS)
    other["start.condition"] = HANDED_OVER
    other["orbit.true_anomaly"] = math.remainder(rate * i.time, math.tau)
    r, v, basis = np.zeros(3), np.zeros(3), np.zeros((3, 3))
    semi = EARTH_EQUATORIAL_RADIUS + i["orbit.altitude"]
    elements_to_state(r, v, semi, 0.0, i["orbit.inclination"], 0.0, 0.0, other["orbit.true_anomaly"], EARTH_MU)
    turning = orbital_basis(basis, r, v)
    position, velocity = np.zeros(3), np.zeros(3)
    center = i.array("center_position").copy(), i.array("center_velocity").copy()
    state_to_orbital(position, velocity, r, v, basis, turning, *center)
    other.array("start_center_position")[:] = position
    other.array("start_center_velocity")[:] = velocity
    apart, parting = (i.array(f"target_{x}") - i.array(f"chaser_{x}") for x in ("position", "velocity"))
    relative_to_orbital(position, velocity, basis, turning, apart, parting)
    other.array("start_relative_position")[:] = position
    other.array("start_relative_velocity")[:] = velocity
    return other


def test_changed_thrust_is_a_new_start() -> None:
    i = tow()
    i.step(600.0)
    fresh = as_parameters(i)
    i["thrust.offset"] = 0.004
    fresh["thrust.level"] = -0.006
    fresh.initialise(600.0)
    i.step(2500.0)
    fresh.step(2500.0)
    assert i["tether.tug_count"] == fresh["tether.tug_count"] > 0
    assert i["tug[1].time"] == pytest.approx(600.0 + fresh["tug[1].time"], abs=1e-3)
    assert i["separation"] == pytest.approx(fresh["separation"], abs=1e-5)
    assert i["separation"] != pytest.approx(run(3100.0, 3100.0)["separation"], abs=1e-3)
    used = (600.0 * 0.01 + 2500.0 * 0.006) / (3000.0 * 9.80665)
    assert i["chaser.propellant"] == pytest.approx(used, rel=1e-12)


def test_changed_reel_length() -> None:
    """Hauling in a taut line pulls at once, also before the next step (REFRESH); a metre more makes it slack."""
    i = tow()
    i.step(1119.4)
    tension, stretch = i["tether.tension"], i["tether.length"] - 12.0
    speed = i["tether.length_rate"]
    i["reel.length_offset"] = -1e-3
    i.refresh()
    stiffness = 60e9 * math.pi * 1e-6 / 4.0 / (12.0 - 1e-3)
    damping = 0.1 * math.sqrt(stiffness * 2000.0 / 3.0)
    hauled = stiffness * (stretch + 1e-3) + damping * speed
    assert i["tether.tension"] == pytest.approx(hauled, rel=1e-9) != tension
    i["reel.length_offset"] = 0.0
    i.refresh()
    assert i["tether.tension"] == tension
    i["reel.length_offset"] = 1.0
    i.step(1e-6)
    assert (i["tether.taut"], i["tether.tension"], i["tether.tug_count"]) == (0, 0.0, 1)
    i["reel.length_offset"] = -1e-3
    i.step(1e-6)
    assert i["tether.tug_count"] == 2
    assert i["tether.tension"] == pytest.approx(hauled, rel=1e-3)
    i["reel.length_offset"] = -13.0
    with pytest.raises(ModelFault, match="length"):
        i.step(1.0)
