"""Gas guns and springs: closed forms, what is kept with a valve of finite area, and shots per reservoir."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from fmu_src.interface import Undesigned
from fmu_src.net_capture.implied import rows
from fmu_src.net_capture.interface import GROUPS, MODEL
from fmu_src.net_capture.release import pneumatic, springs
from tests.conftest import FREE

HELIUM = 8.314462618 / 4.0026e-3


def values_of(kind, **change):
    variables = [v for v in MODEL.interface(FREE).variables if v.causality == "parameter"]
    asked = GROUPS["ejector"].terms[kind].asked
    found = {n: float(s) for v in (*variables, *asked) for n, s in zip(v.element_names(), v.starts(), strict=True)}
    return found | {name.replace("__", "."): value for name, value in change.items()}


def gun(**change):
    return pneumatic.gun_of(values_of("pneumatic", **{f"ejector__{k}": v for k, v in change.items()}), 4)


def told(kind, **change):
    terms = FREE | {"ejector": kind, "bullets": "4"}
    return {row.key: row.value for row in rows(values_of(kind, **change), terms)}


def test_work_is_that_of_the_isentrope():
    """p V^(5/3) constant, integrated over the way, after the gas has filled the chamber."""
    one = gun(chamber=5e-6, friction=30.0)
    section = math.pi / 4.0 * 1e-4
    first = 0.25e-4 + 5e-6
    pressure = 200e5 * 0.25e-4 / first
    work, _ = quad(lambda s: pressure * (first / (first + section * s)) ** (5.0 / 3.0) * section, 0.0, 0.1)
    found = pneumatic.blast(one)
    assert 0.5 * 0.5 * found.speed**2 == pytest.approx(work - 30.0 * 0.1, rel=1e-9)
    assert found.muzzle == pytest.approx(pressure * (first / (first + section * 0.1)) ** (5.0 / 3.0), rel=1e-12)
    assert pneumatic.blast(one._replace(ratio=1.4)).speed > 1.001 * found.speed


def test_a_wide_valve_is_one_that_opens_at_once():
    """And a narrow one gives less; the speed falls with its area."""
    ideal = pneumatic.blast(gun())
    wide = pneumatic.blast(gun(valve_area=3e-3))
    assert wide.speed == pytest.approx(ideal.speed, rel=2e-3)
    assert wide.muzzle == pytest.approx(ideal.muzzle, rel=5e-3)
    assert wide.left == pytest.approx(ideal.left, rel=5e-3)
    speeds = [pneumatic.blast(gun(valve_area=area)).speed for area in (1e-6, 3e-6, 1e-5)]
    assert speeds == sorted(speeds)
    assert speeds[0] < 0.9 * ideal.speed


@pytest.mark.parametrize("area", [3e-7, 3e-6])
def test_a_valve_keeps_the_energy(area):
    """What the gas has lost is what the bullet has and what friction took: reservoir and barrel are told by their
    pressures."""
    one = gun(valve_area=area, friction=20.0)
    found = pneumatic.blast(one)
    reservoir = 200e5 * found.left ** (5.0 / 3.0) * 0.25e-4
    barrel = found.muzzle * (1e-6 + math.pi / 4.0 * 1e-4 * 0.1)
    lost = (200e5 * 0.25e-4 * (1.0 + pneumatic.FIRST_GAS * 1e-6 / 0.25e-4) - reservoir - barrel) / (2.0 / 3.0)
    assert lost == pytest.approx(0.5 * 0.5 * found.speed**2 + 20.0 * 0.1, rel=1e-5)


def test_a_choked_nozzle():
    """The mass flow of helium, p sqrt(g/RT) (2/(g+1))^((g+1)/2(g-1)), whatever lies below the critical pressure; above
    it what Saint-Venant and Wantzel say; none between equal pressures."""
    choked = 1e6 * math.sqrt(5.0 / 3.0 / (HELIUM * 300.0)) * (3.0 / 4.0) ** 2
    assert pneumatic.nozzle(1e6, 300.0, 0.0, 5.0 / 3.0, HELIUM) == pytest.approx(choked, rel=1e-12)
    assert pneumatic.nozzle(1e6, 300.0, 4.8e5, 5.0 / 3.0, HELIUM) == pytest.approx(choked, rel=1e-12)
    density = 1e6 / (HELIUM * 300.0) * 0.8 ** (3.0 / 5.0)
    speed = math.sqrt(2.0 * 2.5 * HELIUM * 300.0 * (1.0 - 0.8**0.4))
    assert pneumatic.nozzle(1e6, 300.0, 8e5, 5.0 / 3.0, HELIUM) == pytest.approx(density * speed, rel=1e-12)
    assert pneumatic.nozzle(1e6, 300.0, 1e6, 5.0 / 3.0, HELIUM) == 0.0


def test_shots_per_reservoir():
    """Without friction and chamber each leaves V / (V + N A L) of the gas, and the speed goes with its root."""
    share = 1e-4 / (1e-4 + 4.0 * math.pi / 4.0 * 1e-4 * 0.1)
    one = gun(chamber=1e-15)
    assert pneumatic.blast(one).left == pytest.approx(share, rel=1e-9)
    speeds = [pneumatic.shot(one, k).speed for k in (1, 2, 5)]
    np.testing.assert_allclose(speeds, speeds[0] * share ** (np.array([0, 1, 4]) / 2.0), rtol=1e-9)
    count = math.floor(2.0 * math.log(0.5) / math.log(share)) + 1
    assert pneumatic.shots(one, 0.5) == count
    assert speeds[0] * share ** (count / 2.0) < 0.5 * speeds[0] <= speeds[0] * share ** ((count - 1) / 2.0)


def test_shooters_share_their_supply():
    """Four barrels on two reservoirs are as two on one; on one they are slower."""
    assert gun(supplies=2) == pneumatic.gun_of(values_of("pneumatic"), 2)
    assert (
        pneumatic.blast(gun()).speed < pneumatic.blast(gun(supplies=2)).speed < pneumatic.blast(gun(supplies=4)).speed
    )
    with pytest.raises(Undesigned, match="share 4 barrels evenly"):
        gun(supplies=3)


def test_a_spring_gives_its_energy():
    found = springs.push(values_of("springs", ejector__friction=3.0, ejector__plunger=0.1, ejector__rest_force=10.0))
    work, _ = quad(lambda s: 2000.0 * (0.05 - s) + 10.0 - 3.0, 0.0, 0.05)
    assert 0.5 * 0.6 * found.speed**2 == pytest.approx(work, rel=1e-12)
    assert found.impulse == pytest.approx(0.5 * found.speed, rel=1e-12)
    assert found.force == pytest.approx(110.0, rel=1e-12)
    free = springs.push(values_of("springs"))
    # alone it is a quarter of a swing: impulse s sqrt(k m), bounded whatever is asked of it
    assert free.impulse == pytest.approx(0.05 * math.sqrt(2000.0 * 0.5), rel=1e-12)


def designed(kind, terms=None, **change):
    values = values_of(kind, **change)
    asked = {name: value for name, value in values.items() if name.startswith("ejector.")}
    return GROUPS["ejector"].terms[kind].design(values, asked, {"bullets": "4", **(terms or {})})


def test_scatter_is_that_of_its_deviation_and_seed():
    found = designed("springs", {"ejection": "4"}, ejector__scatter=0.02, ejector__seed=5)
    speed = found.pop("bullets.speed")
    assert list(found) == [f"ejection.speed_error[{i}]" for i in range(1, 5)]
    assert designed("springs", {"ejection": "4"}, ejector__scatter=0.02, ejector__seed=6) != found
    many = [designed("springs", {"ejection": "4"}, ejector__scatter=0.02, ejector__seed=i) for i in range(500)]
    errors = np.array([[one[f"ejection.speed_error[{i}]"] for i in range(1, 5)] for one in many]) / speed
    assert errors.std() == pytest.approx(0.02, rel=0.06)
    assert abs(errors.mean()) < 0.002
    assert "ejection.speed_error[1]" not in designed("springs")


@pytest.mark.parametrize(
    ("kind", "change", "name"),
    [
        ("springs", {"ejector__friction": 1e3}, "ejector.friction"),
        ("springs", {"ejector__most_impulse": 1.5}, "ejector.most_impulse"),
        ("springs", {"ejector__scatter": 0.1}, "ejector.scatter"),
        ("pneumatic", {"ejector__friction": 1e5}, "ejector.friction"),
        ("pneumatic", {"ejector__friction": 900.0, "ejector__shot": 9}, "ejector.shot"),
        ("pneumatic", {"ejector__friction": 1500.0, "ejector__valve_area": 1e-8}, "ejector.friction"),
        ("pneumatic", {"ejector__supplies": 3.0}, "ejector.supplies"),
    ],
)
def test_what_does_not_work_is_refused(kind, change, name):
    with pytest.raises(Undesigned) as caught:
        designed(kind, **change)
    assert caught.value.name == name


def test_people_are_told(shoot):
    found = told("pneumatic")
    assert found["ejector.speed"] == pytest.approx(designed("pneumatic")["bullets.speed"], rel=1e-12)
    assert 0.0 < found["ejector.muzzle_pressure"] < 200e5
    assert found["ejector.shots"] >= 1.0
    assert told("springs")["ejector.impulse"] == pytest.approx(0.05 * math.sqrt(1000.0), rel=1e-12)
