"""Bodies that turn: against an integration of six degrees of freedom in scipy, closed forms and conservation laws."""

import itertools
import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmu_src.instance import Instance, ModelFault
from fmu_src.tethered_deorbit import events, model
from fmu_src.tethered_deorbit.interface import BAD_ATTITUDE, BAD_INERTIA, HANDED_OVER, MODEL, START_STRETCHED
from tests.plain import PlainInstance, plain
from tests.tethered_deorbit.six_degrees import Body, Line, Tow
from tests.validation import Validated, closed_form

__all__ = ["plain"]

uncompiled = pytest.mark.usefixtures("plain")
FIELD_FREE = {"reel": "locked", "environment": "none", "target": "rigid"}
BOTH = FIELD_FREE | {"chaser": "rigid"}
ON_ORBIT = {"reel": "locked", "thrust": "along_track", "target": "rigid"}
REST, DIAMETER, MODULUS = 12.0, 1e-3, 60e9
STIFFNESS = MODULUS * math.pi * DIAMETER**2 / 4.0 / REST
M_C, M_T = 2000.0, 1000.0
REDUCED = M_C * M_T / (M_C + M_T)
INERTIA = np.array([[5000.0, 120.0, -60.0], [120.0, 2400.0, 40.0], [-60.0, 40.0, 6000.0]])
CHASER = np.array([[900.0, -30.0, 10.0], [-30.0, 1100.0, 0.0], [10.0, 0.0, 1300.0]])
ARM = np.array([0.4, -1.8, 0.3])
RADIUS = 7178137.0
MEAN_MOTION = math.sqrt(3.986004418e14 / RADIUS**3)


def six(matrix: np.ndarray) -> list[float]:
    return [matrix[0, 0], matrix[1, 1], matrix[2, 2], matrix[0, 1], matrix[0, 2], matrix[1, 2]]


def pair(terms: dict[str, str], arrays: dict[str, Any] | None = None, **parameters: float) -> Instance:
    """A pair handed over, parameters by name with __ for a dot, arrays by field."""
    given = {"start.condition": HANDED_OVER, "tether.damping_ratio": 0.0}
    i = Instance(MODEL, terms, given | {name.replace("__", "."): value for name, value in parameters.items()})
    i.array("start_relative_position")[:] = 0.5, 11.0, -0.4
    if "thrust" in terms and "thrust__level" not in parameters:
        i["thrust.level"] = 0.0
    if terms.get("target") == "rigid":
        i.array("target_inertia")[:] = six(INERTIA)
        i.array("target_attachment")[:] = ARM
    if terms.get("chaser") == "rigid":
        i.array("chaser_inertia")[:] = six(CHASER)
        i.array("chaser_attachment")[:] = 0.1, 1.1, -0.2
    for field, value in (arrays or {}).items():
        i.array(field)[:] = value
    return i.initialise()


def relative(i: Instance) -> tuple[np.ndarray, np.ndarray]:
    place = i.array("target_position") - i.array("chaser_position")
    return place, i.array("target_velocity") - i.array("chaser_velocity")


def momentum(i: Instance) -> np.ndarray:
    """Angular momentum about the joint centre of mass, spins included, inertial axes [N m s]."""
    place, speed = relative(i)
    spins = sum((i.array(f"{b}_spin") for b in ("target", "chaser") if i.interface.terms[b] == "rigid"), np.zeros(3))
    return np.asarray(REDUCED * np.cross(place, speed) + spins)


def matrix(i: Instance, body: str = "target") -> np.ndarray:
    w, *xyz = i.array(f"{body}_attitude")
    return np.asarray(Rotation.from_quat([*xyz, w]).as_matrix())


TUMBLING = {"target_start_rate": (0.03, 0.06, -0.04), "start_relative_velocity": (0.01, 0.02, 0.0)}


def reference(i: Instance, zeta: float, radius: float = 0.0, thrust: float = 0.0) -> tuple[Tow, np.ndarray]:
    """The same pair for scipy, and its start: an orbit in the plane of axes 1 and 2, from axis 1."""

    def bodies(role: str, mass: float) -> Body:
        if i.interface.terms[role] == "point":
            return Body(mass, np.eye(3), np.zeros(3))
        a, b, c, d, e, f = i.array(f"{role}_inertia")
        return Body(mass, np.array([[a, d, e], [d, b, f], [e, f, c]]), i.array(f"{role}_attachment").copy())

    def along_track(r: np.ndarray, v: np.ndarray) -> np.ndarray:
        along = np.cross(np.cross(r, v), r)
        return np.asarray(thrust * along / np.linalg.norm(along))

    line = Line(REST, STIFFNESS, 2.0 * zeta * math.sqrt(STIFFNESS * REDUCED))
    tow = Tow(bodies("chaser", M_C), bodies("target", M_T), line, radius, along_track if thrust else None)
    turning = MEAN_MOTION if radius else 0.0
    start = np.zeros(36)
    apart = i.array("start_relative_position")
    parting = i.array("start_relative_velocity") + np.cross([0.0, 0.0, turning], apart)
    for k, (body, share) in enumerate((("chaser", -M_T / (M_C + M_T)), ("target", M_C / (M_C + M_T)))):
        start[6 * k : 6 * k + 3], start[6 * k + 3 : 6 * k + 6] = share * apart, share * parting
        start[12 + 9 * k : 21 + 9 * k] = np.eye(3).ravel()
        if i.interface.terms[body] == "rigid":
            start[12 + 9 * k : 21 + 9 * k] = matrix(i, body).ravel()
            start[30 + 3 * k : 33 + 3 * k] = i.array(f"{body}_rate")
    return tow, start


def differences(i: Instance, tow: Tow, after: np.ndarray) -> dict[str, float]:
    """Largest differences: of tugs, relative to their size but for the time [s]; of places and rates, SI."""
    count = int(i["tether.tug_count"])
    assert count == len(tow.tugs)
    found = np.array([[i[f"tug[{count - k}].{what}"] for what in ("time", "speed", "peak")] for k in range(count)])
    wanted = np.array([[tug.time, tug.speed, tug.peak] for tug in tow.tugs])
    off = np.abs(found - wanted)
    place, rate = relative(i)
    return {
        "time": float(off[:, 0].max()),
        "speed": float((off[:, 1] / wanted[:, 1]).max()),
        "peak": float((off[:, 2] / wanted[:, 2]).max()),
        "place": float(np.abs(place - (after[6:9] - after[0:3])).max()),
        "velocity": float(np.abs(rate - (after[9:12] - after[3:6])).max()),
        "attitude": float(np.abs(matrix(i) - after[21:30].reshape(3, 3)).max()),
        "rate": float(np.abs(i.array("target_rate") - after[33:36]).max()),
    }


@pytest.mark.parametrize("body", ["target", pytest.param("both", marks=pytest.mark.evidence)])
def test_three_tugs_on_an_orbit(body: str) -> None:
    """A tumbling pair with gravity gradient and thrust: tugs, attitude and rates of scipy's DOP853 at 1e-12."""
    terms = ON_ORBIT | ({"chaser": "rigid"} if body == "both" else {})
    arrays = TUMBLING | ({"chaser_start_rate": (-0.02, 0.01, 0.03)} if body == "both" else {})
    given = {"orbit__inclination": 0.0, "tether__damping_ratio": 0.05, "thrust__level": -8.0}
    i = pair(terms, arrays, **given)
    tow, start = reference(i, 0.05, RADIUS, -8.0)
    end = 100.0 if body == "both" else 200.0
    after = tow.run(start, end)
    i.step(end)
    assert len(tow.tugs) >= 3
    off = differences(i, tow, after)
    allowed = {"time": 1e-8, "speed": 1e-8, "peak": 1e-6, "place": 1e-8, "velocity": 1e-9, "attitude": 1e-9}
    for what, most in (allowed | {"rate": 1e-10}).items():
        assert off[what] < most, what


def test_without_its_gradient_the_field_does_not_turn_a_body() -> None:
    seen = {}
    for on in (True, False):
        i = pair(ON_ORBIT, {"target_start_rate": (0.0, 0.0, 0.0)}, target__gravity_gradient=on)
        i["thrust.level"] = 0.0
        i.step(60.0)
        seen[on] = float(np.linalg.norm(i.array("target_rate")))
    assert seen[False] == 0.0
    assert seen[True] > 1e-6


# --------------------------------------------------------------------------------------------------------- closed forms


def test_a_tug_through_the_centre_of_mass_is_that_of_a_point() -> None:
    """To rounding: first tugs, impulse and places of a pair whose attachments are the centres."""
    arrays: dict[str, Any] = {"start_relative_velocity": (0.01, 0.02, 0.0)}
    turning = arrays | {"target_attachment": (0.0, 0.0, 0.0), "target_start_rate": (0.3, 0.1, 0.2)}
    rigid, point = pair(FIELD_FREE, turning), pair(FIELD_FREE | {"target": "point"}, arrays)
    for i in (rigid, point):
        i.step(600.0)
    assert point["tether.tug_count"] == rigid["tether.tug_count"] == 1
    for name in ("tug[1].time", "tug[1].speed", "tug[1].peak", "tether.impulse", "separation"):
        assert rigid[name] == pytest.approx(point[name], rel=1e-11), name


def test_an_off_centre_snap_moves_the_effective_mass(validated: Validated) -> None:
    """v sqrt(k m), 1/m = 1/m_r + (a x n).I^-1 (a x n): of a line so stiff that nothing turns in the meantime."""
    n, v = np.array([0.0, 1.0, 0.0]), 0.05
    arm = np.array([1.5, -1.0, 0.5])
    apart = REST * n - arm - 1e-3 * n
    arrays = {"target_attachment": arm, "start_relative_position": apart, "start_relative_velocity": v * n}
    stiff = 1e3
    i = pair(FIELD_FREE, arrays, tether__youngs_modulus=MODULUS * stiff)
    i.step(1.0)
    lever = np.cross(arm, n)
    mass = 1.0 / (1.0 / REDUCED + lever @ np.linalg.solve(INERTIA, lever))
    assert mass < 0.8 * REDUCED
    formula = closed_form("v sqrt(k m), 1/m = 1/m_r + (a x n).I^-1 (a x n)")
    expected = v * math.sqrt(STIFFNESS * stiff * mass)
    validated(formula, "off-centre snap: peak", i["tug[1].peak"], expected, "N", rel=1e-4)
    assert not i["tether.taut"]
    assert i["tether.impulse"] == pytest.approx(2.0 * mass * v, rel=1e-4)
    assert i["tether.length_rate"] == pytest.approx(-v, rel=5e-3)  # it turns on until the second is over


def test_small_librations_under_the_gradient(validated: Validated) -> None:
    """Pitch of a slack pair's target, axis 2, of the least moment, upright: 2 pi/(n sqrt(3 (I1 - I2)/I3))."""
    inertia = np.diag([6000.0, 2400.0, 5000.0])
    tilt = 1e-2
    # axis 2 of the body along the radius: a quarter turn about axis 3, and a little more
    half = 0.5 * (-0.5 * math.pi + tilt)
    arrays = {
        "target_inertia": six(inertia),
        "target_attachment": (0.0, 0.0, 0.0),
        "target_start_attitude": (math.cos(half), 0.0, 0.0, math.sin(half)),
    }
    i = pair(ON_ORBIT, arrays, target__rate_frame=1, tether__rest_length=1000.0)
    pace = MEAN_MOTION * math.sqrt(3.0 * (6000.0 - 2400.0) / 5000.0)
    quarter = 0.5 * math.pi / pace
    angles = []
    for k in (0.98, 0.02, 0.02):
        i.step(k * quarter)
        up = i.array("target_position") / np.linalg.norm(i.array("target_position"))
        along = i.array("target_velocity") / np.linalg.norm(i.array("target_velocity"))
        axis = matrix(i)[:, 1]
        angles.append(math.atan2(float(axis @ along), float(axis @ up)))
    assert angles[0] * angles[2] < 0.0
    slope = (angles[2] - angles[0]) / (0.04 * quarter)
    crossing = quarter * 0.98 - angles[0] / slope
    formula = closed_form("2 pi/(n sqrt(3 (I1 - I2)/I3))")
    validated(formula, "pitch libration of a target: period", 4.0 * crossing, 4.0 * quarter, "s", rel=2e-4)


# --------------------------------------------------------------------------------------------------------- conservation


@pytest.mark.parametrize("terms", [FIELD_FREE, BOTH])
def test_field_free_momentum_and_energy(terms: dict[str, str]) -> None:
    """Through tugs: angular momentum about the joint centre of mass, spins included, to 1e-12, and energy."""
    i = pair(terms, TUMBLING | ({"chaser_start_rate": (0.02, 0.0, -0.05)} if terms is BOTH else {}))
    before, energy = momentum(i), i["energy.relative"]
    parting = i.array("center_velocity").copy()
    worst, drift = 0.0, 0.0
    for _ in range(300):
        i.step(1.0)
        worst = max(worst, float(np.abs(momentum(i) - before).max() / np.linalg.norm(before)))
        drift = max(drift, abs(i["energy.relative"] / energy - 1.0))
    assert i["tether.tug_count"] >= 2
    assert worst < 1e-12
    assert drift < 1e-11
    assert i.array("center_velocity") == pytest.approx(parting, abs=1e-16)


def test_on_an_orbit_the_spin_changes_by_the_torque_of_the_gradient() -> None:
    """A slack target: the spin against the integral of the torque on eight mass points with its inertia."""
    inertia = np.diag([6000.0, 2400.0, 5000.0])
    trace = 0.5 * np.trace(inertia)
    size = np.sqrt((trace - np.diag(inertia)) / 2.0)
    points = np.vstack([np.diag(size), -np.diag(size)])
    i = pair(ON_ORBIT, TUMBLING | {"target_inertia": six(inertia)}, tether__rest_length=1000.0)
    before = i.array("target_spin").copy()
    nodes, weights = np.polynomial.legendre.leggauss(6)
    step, gained = 2.0, np.zeros(3)
    for _ in range(60):
        at = 0.0
        for node, weight in zip(nodes, weights, strict=True):
            then = 0.5 * step * (1.0 + node)
            i.step(then - at)
            at = then
            center, turned = i.array("target_position"), matrix(i)
            r = np.linalg.norm(center)
            for point in points:
                d = turned @ point
                # what turns is the gradient's part across the arm
                gained += 0.5 * step * weight * np.cross(d, 3.0 * 3.986004418e14 / r**5 * (center @ d) * center)
        i.step(step - at)
    change = i.array("target_spin") - before
    assert np.linalg.norm(change) > 1e-3
    assert change == pytest.approx(gained, abs=1e-9 * float(np.linalg.norm(before)))


def test_undamped_on_an_orbit_the_energy_stays() -> None:
    """The Jacobi integral with that of the turning, over a day of tugs: to first order in length over radius."""
    arrays = {"target_start_rate": (0.0, 0.002, 0.001), "start_relative_position": (6.0, 7.0, 0.0)}
    i = pair(ON_ORBIT, arrays, target__rate_frame=1)
    energy = i["energy.relative"]
    i.step(86400.0)
    assert i["tether.tug_count"] > 10
    assert i["energy.relative"] == pytest.approx(energy, abs=2e-5 * abs(energy))


@pytest.mark.evidence
@pytest.mark.parametrize("target", ["point", "rigid"])
def test_undamped_energy_over_a_day(target: str) -> None:
    """0.155 J of relative motion, and a target that tumbles at 5 deg/s: over a day of tugs 1e-9 of the 0.155 J stay."""
    own = 0.155
    parting = math.sqrt(2.0 * own / REDUCED) * np.array([0.5, 0.8, 0.3]) / math.sqrt(0.98)
    arrays: dict[str, Any] = {"start_relative_position": (6.0, 7.0, 0.0), "start_relative_velocity": parting}
    if target == "rigid":
        arrays["target_start_rate"] = np.radians([1.0, 2.0, 4.5])
    i = pair({"reel": "locked", "environment": "none", "target": target, "solver": "gauss"}, arrays)
    energy, worst = i["energy.relative"], 0.0
    for _ in range(144):
        i.step(600.0)
        worst = max(worst, abs(i["energy.relative"] - energy))
    assert i["tether.tug_count"] > 50
    assert worst < 1e-9 * own


# ----------------------------------------------------------------------------------------------------------------- cost


def hanging(target: str) -> dict[str, Any]:
    """A pair upright on its taut line; a target that turns has its attachment below it, spins about the line at 5 deg/s
    and swings."""
    arm = 0.0 if target == "point" else 1.0
    values: dict[str, Any] = {
        "start.condition": HANDED_OVER,
        "start_relative_position": [REST + 1e-5 + arm, 0.0, 0.0],
        "thrust.level": -0.01,
    }
    if target != "point":
        values |= {
            "target_inertia": [6666.7, 2666.7, 6666.7, 0.0, 0.0, 0.0],
            "target_attachment": [0.0, -arm, 0.0],
            "target_start_attitude": [math.sqrt(0.5), 0.0, 0.0, -math.sqrt(0.5)],
            "target_start_rate": [0.0, math.radians(5.0), math.radians(0.1)],
        }
    if target == "box":
        values["target_size"] = [4.0, 2.0 * arm, 4.0]
    return values


@pytest.mark.parametrize("target", ["rigid", "box"])
def test_a_tumbling_target_takes_the_steps_of_a_point(target: str) -> None:
    """Its attachment goes round, and the steps do not have to follow it: in plain coordinates they were 2.5 times as
    many."""
    counts = []
    for kind in ("point", target):
        i = Instance(MODEL, ON_ORBIT | {"target": kind})
        for name, value in hanging(kind).items():
            if isinstance(value, list):
                i.array(name)[:] = value
            else:
                i[name] = value
        i.initialise()
        i.step(250.0)
        assert (i["tether.taut"], i["tether.tug_count"]) == (1, 1)
        counts.append(i["solver.steps"] + i["solver.rejected"])
    assert counts[1] < 1.3 * counts[0]


@uncompiled
def test_the_slope_of_the_tension_is_that_of_its_course(monkeypatch: pytest.MonkeyPatch) -> None:
    """What says where a step is to be searched for a change: over each step, against the difference of its ends."""
    ends: list[tuple[float, float, float, float]] = []

    def watched(*arguments: Any) -> events.Events:
        made = make_events(*arguments)

        def signals(record: Any, state: Any, rate: Any, elapsed: float) -> Any:
            found = made.signals(record, state, rate, elapsed)
            ends.append((record[0].state_begin, elapsed, found[events.TENSION], found[events.TENSION_SLOPE]))
            return found

        return made._replace(signals=signals)

    make_events = events.make_events
    monkeypatch.setattr(model, "make_events", watched)
    i = PlainInstance(MODEL, ON_ORBIT, hanging("rigid") | {"tether.damping_ratio": 1.0})
    i.step(60.0)
    late = [(a, b) for a, b in itertools.pairwise(ends) if a[0] == b[0] > 20.0 and a[1] == 0.0 < b[1]]
    changes = np.array([b[2] - a[2] for a, b in late])
    by_slope = np.array([0.5 * b[1] * (a[3] + b[3]) for a, b in late])
    assert len(late) > 20
    assert by_slope == pytest.approx(changes, abs=1e-2 * float(np.abs(changes).max()))


# ------------------------------------------------------------------------------------------------------ starts, outputs


def test_what_a_rate_is_relative_to() -> None:
    """Inertial space; the orbital frame, n about axis 3; the line of centres as it turns."""
    attitude = Rotation.from_euler("xyz", (0.3, -0.5, 0.7))
    x, y, z, w = attitude.as_quat()
    place, speed = np.array([3.0, 9.0, 2.0]), np.array([0.02, -0.01, 0.03])
    frame = np.array([0.0, 0.0, MEAN_MOTION])
    inertial = speed + np.cross(frame, place)
    expected = {0: np.zeros(3), 1: frame, 2: np.cross(place, inertial) / (place @ place)}
    for choice, turning in expected.items():
        arrays = {
            "target_start_attitude": (w, x, y, z),
            "target_start_rate": (0.01, 0.02, 0.03),
            "start_relative_position": place,
            "start_relative_velocity": speed,
        }
        i = pair(ON_ORBIT, arrays, target__rate_frame=choice, orbit__inclination=0.0)
        wanted = np.array([0.01, 0.02, 0.03]) + attitude.inv().apply(turning)
        assert i.array("target_rate") == pytest.approx(wanted, abs=1e-13)
        assert matrix(i) == pytest.approx(attitude.as_matrix(), abs=1e-13)
        assert i.array("target_spin") == pytest.approx(attitude.apply(INERTIA @ wanted), rel=1e-12)
        assert i["target.spin_energy"] == pytest.approx(0.5 * wanted @ INERTIA @ wanted, rel=1e-12)


def test_length_is_between_the_attachments() -> None:
    i = pair(BOTH, TUMBLING)
    i.step(5.0)
    place, _ = relative(i)
    vector = place + matrix(i) @ ARM - matrix(i, "chaser") @ np.array([0.1, 1.1, -0.2])
    assert i["tether.length"] == pytest.approx(float(np.linalg.norm(vector)), rel=1e-12)
    assert i["separation"] == pytest.approx(float(np.linalg.norm(place)), rel=1e-12)


def test_macro_steps_change_nothing() -> None:
    """The same bits for steps of 0.7 and of 70 s, through tugs, in which axes turn and attitudes are set to length."""
    ends = []
    for step, count in ((0.7, 300), (70.0, 3)):
        i = pair(ON_ORBIT, TUMBLING, thrust__level=-2.0)
        for _ in range(count):
            i.step(step)
        ends.append([i[f"tug[{k}].{what}"] for k in range(1, 5) for what in ("time", "peak")])
        ends[-1] += i.array("target_attitude").tolist()
    assert ends[0][:8] == ends[1][:8]
    assert ends[0] == pytest.approx(ends[1], rel=1e-12)


@pytest.mark.parametrize(
    "terms", [ON_ORBIT, pytest.param(ON_ORBIT | {"chaser": "rigid"}, marks=pytest.mark.evidence), BOTH]
)
def test_rates_of_outputs(terms: dict[str, str]) -> None:
    """Against differences of fourth order, slack and taut."""
    for apart in (9.0, 15.0):
        arrays = TUMBLING | {"start_relative_position": (2.0, apart, 1.0)}
        i = pair(terms, arrays, tether__youngs_modulus=6e6)
        i.step(0.5)
        names = [n for n, _, v, _ in i.interface.scalars() if v.causality == "output" and v.rate]
        seen, step = [], 0.02
        for k in range(5):
            i.step(step)
            seen.append({name: i[name] for name in names})
            if k == 2:
                i.differentiate()
                rates = {name: i.rate(name) for name in names}
        assert bool(i["tether.taut"]) == (apart > 12.0)
        assert {"target.attitude[1]", "target.spin[2]", "target.spin_energy", "separation"} <= set(names)
        for name in names:
            if name.startswith(("center", "altitude", "energy.orbital")) or name.endswith(("radius", "tion[1]")):
                continue
            v = [s[name] for s in seen]
            difference = (v[0] - 8.0 * v[1] + 8.0 * v[3] - v[4]) / (12.0 * step)
            noise = 3e-15 * max(abs(x) for x in v) / step
            assert rates[name] == pytest.approx(difference, rel=2e-6, abs=1e-9 + noise), name


@pytest.mark.parametrize(
    ("arrays", "code"),
    [
        ({"target_inertia": (1.0, 1.0, 3.0, 0.0, 0.0, 0.0)}, BAD_INERTIA),
        ({"target_inertia": (1.0, 1.0, 1.0, 2.0, 0.0, 0.0)}, BAD_INERTIA),
        ({"target_inertia": (math.nan, 1.0, 1.0, 0.0, 0.0, 0.0)}, BAD_INERTIA),
        ({"target_start_attitude": (1.0, 1.0, 0.0, 0.0)}, BAD_ATTITUDE),
    ],
)
def test_what_no_body_has_is_refused(arrays: dict[str, Any], code: int) -> None:
    with pytest.raises(ModelFault, match=next(f.text for f in MODEL.faults if f.code == code)[:20]):
        pair(FIELD_FREE, arrays)


def test_a_start_is_stretched_between_the_attachments() -> None:
    """12 m apart with the attachments 1.8 m inside, the line is slack; pointing outwards it would be stretched."""
    values = {"start.condition": 2, "start.separation": 12.0, "tether.rest_length": 11.0}
    for y, refused in ((-1.8, False), (1.8, True)):
        i = Instance(MODEL, FIELD_FREE, values)
        i.array("target_attachment")[:] = 0.0, y, 0.0
        if refused:
            with pytest.raises(ModelFault, match=next(f.text for f in MODEL.faults if f.code == START_STRETCHED)[:20]):
                i.initialise()
        else:
            i.initialise()
            assert i["tether.length"] == pytest.approx(10.2, rel=1e-14)


@pytest.mark.evidence
def test_a_linear_reel_feeds_forward_the_tide_on_the_centres() -> None:
    """At its commanded length, aligned and at rest, the line has 3 n^2 m_r (l_c + a), a the length of the arm."""
    arm = 1.5
    values = {"start.condition": HANDED_OVER, "reel.length": 11.0, "thrust.level": 0.0}
    i = Instance(MODEL, {"reel": "linear", "thrust": "along_track", "target": "rigid"}, values)
    i.array("target_attachment")[:] = -arm, 0.0, 0.0
    i.array("start_relative_position")[:] = 11.0 + arm, 0.0, 0.0
    i.initialise()
    assert i["tether.length"] == pytest.approx(11.0, rel=1e-12)
    assert i["tether.tension"] == pytest.approx(3.0 * MEAN_MOTION**2 * REDUCED * (11.0 + arm), rel=1e-9)
