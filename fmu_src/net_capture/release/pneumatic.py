"""Bullets shot by gas from a reservoir, all the barrels on it at once.

Each barrel has its share of the reservoir. Gas goes through a valve of effective area `a` into the chamber behind the
bullet, and pushes it along the barrel:

    dm/dt = a p sqrt(g/(R T)) f,    dE_r/dt = -dm/dt c_p T,    dE_b/dt = dm/dt c_p T - p_b A v,    m dv/dt = p_b A - F

f   that of a nozzle, choked or not, with p and T of the gas upstream

A valve that opens wholly at once keeps both pressures the same, and the speed has a closed form: the gas fills the
chamber freely, then expands with p V^g constant,

    N (m v2 / 2 + F L) = p1 V1/(g - 1) (1 - (V1/V2)^(g-1)),   V1 = V + N V_c,  V2 = V1 + N A L,  p1 = p V/V1

Between shots the valve is shut and the reservoir comes back to its temperature: what is left of its gas, expanded with
p V^g constant all the time, is `(p2/p)^(1/g)` of it, and so is the next shot's pressure.

Valid    an ideal gas (helium at 200 bar and 293 K fills 9 % more), no heat taken on the way, no vacuum leaks, a chaser
         heavy against the bullets; a bullet that stops in its barrel stays there
Source   one-dimensional gas dynamics, such as Shapiro, The dynamics and thermodynamics of compressible fluid flow
         (1953), ch. 4; R from CODATA 2018 and the standard atomic weights
Checked  tests/net_capture/test_ejectors.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from fmu_src.implied import Implied
from fmu_src.interface import Undesigned
from fmu_src.rows import at_least_zero, choice, parameter, positive

Values = Mapping[str, float]

MOLAR_GAS_CONSTANT = 8.314462618
"""J/(mol K), CODATA 2018."""
GASES = {"helium": (5.0 / 3.0, 4.0026e-3), "nitrogen": (1.4, 28.014e-3), "argon": (5.0 / 3.0, 39.948e-3)}
"""Ratio of specific heats, molar mass [kg/mol]."""
MOST_SHOTS = 10_000
FIRST_GAS = 1e-6
"""Share of the reservoir's pressure in the chamber before the valve opens: what a numeric start needs."""
EVEN = 1e-5
"""Difference of two pressures, over the higher, below which the flow between them is in proportion to it."""
LONGEST = 10.0
"""Seconds within which a bullet has to come out."""

ROWS = (
    choice("ejector.gas", "in the reservoir", tuple(GASES)),
    positive("ejector.pressure", "Pa", "in the reservoir before its first shot", 200e5, display_unit="bar"),
    positive("ejector.volume", "m3", "of each reservoir", 1e-4),
    positive("ejector.temperature", "K", "of the gas before each shot", 293.15),
    parameter(
        "ejector.supplies", "1", "reservoirs, among which the barrels are shared evenly", 1, 1, 8, kind="Integer"
    ),
    positive("ejector.bore", "m", "of each barrel", 0.01),
    positive("ejector.barrel_length", "m", "way of each bullet in its barrel", 0.1),
    positive("ejector.chamber", "m3", "behind each bullet before it moves", 1e-6),
    at_least_zero(
        "ejector.valve_area", "m2", "effective area of each barrel's valve; zero: it opens wholly at once", 0.0
    ),
    at_least_zero("ejector.friction", "N", "on each bullet in its barrel", 0.0),
    parameter("ejector.shot", "1", "which shot from these reservoirs it is", 1, 1, MOST_SHOTS, kind="Integer"),
    parameter("ejector.least_share", "1", "of the first shot's speed that a shot must have to count", 0.9, 0.01, 1.0),
)


class Gun(NamedTuple):
    """One barrel with its share of the reservoir, SI.

    ratio, gas   of specific heats [1], R of the gas [J/(kg K)]
    """

    ratio: float
    gas: float
    pressure: float
    volume: float
    temperature: float
    chamber: float
    section: float
    length: float
    valve: float
    friction: float
    mass: float


class Blast(NamedTuple):
    """What one shot comes to.

    speed       of the bullet as it leaves                     [m/s]
    muzzle      pressure behind it then                        [Pa]
    left        share of the reservoir's gas that is still in it
    """

    speed: float
    muzzle: float
    left: float


def gun_of(values: Values, barrels: int) -> Gun:
    """A barrel of a scene with so many; `Undesigned` where they cannot be shared."""
    supplies = int(values["ejector.supplies"])
    if barrels % supplies != 0:
        raise Undesigned("ejector.supplies", str(supplies), f"must share {barrels} barrels evenly")
    ratio, molar = list(GASES.values())[int(values["ejector.gas"])]
    return Gun(
        ratio,
        MOLAR_GAS_CONSTANT / molar,
        values["ejector.pressure"],
        values["ejector.volume"] * supplies / barrels,
        values["ejector.temperature"],
        values["ejector.chamber"],
        0.25 * math.pi * values["ejector.bore"] ** 2,
        values["ejector.barrel_length"],
        values["ejector.valve_area"],
        values["ejector.friction"],
        values["bullets.mass"],
    )


def blast(gun: Gun) -> Blast | None:
    """One shot; None where the bullet does not come out.

    Checked  tests/net_capture/test_ejectors.py
    """
    return _through_valve(gun) if gun.valve > 0.0 else _at_once(gun)


def _at_once(gun: Gun) -> Blast | None:
    """With a valve that opens wholly at once."""
    first = gun.volume + gun.chamber
    last = first + gun.section * gun.length
    pressure = gun.pressure * gun.volume / first
    less = gun.ratio - 1.0
    work = pressure * first / less * (1.0 - (first / last) ** less) - gun.friction * gun.length
    if work <= 0.0 or pressure * gun.section <= gun.friction:
        return None
    muzzle = pressure * (first / last) ** gun.ratio
    return Blast(math.sqrt(2.0 * work / gun.mass), muzzle, (muzzle / gun.pressure) ** (1.0 / gun.ratio))


def nozzle(pressure: float, temperature: float, behind: float, ratio: float, gas: float) -> float:
    """Flow [kg/(s m2)] of a nozzle from one pressure to a lower one behind it [Pa].

    Source   Shapiro (1953), eq. 4.14 to 4.17: above the critical ratio of pressures the flow is choked
    """
    critical = (2.0 / (ratio + 1.0)) ** (ratio / (ratio - 1.0))
    share = max(behind / pressure, critical)
    # the root is infinitely steep where pressures meet: there a straight line
    even = max(1.0 - (1.0 - share) / EVEN, 0.0)
    share = min(share, 1.0 - EVEN)
    shape = share ** (2.0 / ratio) - share ** ((ratio + 1.0) / ratio)
    flow = pressure * math.sqrt(2.0 * ratio / (ratio - 1.0) * shape / (gas * temperature))
    return float((1.0 - even) * flow)


def _through_valve(gun: Gun) -> Blast | None:
    """With a valve of finite area, by the equations of the module; state: gas and energy on both sides, way, speed."""
    from scipy.integrate import solve_ivp

    less, gas = gun.ratio - 1.0, gun.gas
    heat = gas / less
    start = gun.pressure * gun.volume / (gas * gun.temperature)
    little = FIRST_GAS * gun.pressure * gun.chamber / (gas * gun.temperature)

    def room(way: float) -> float:
        return gun.chamber + gun.section * way

    def rates(time: float, y: Any) -> list[float]:
        here, energy_here, there, energy_there, way, speed = y
        first, second = less * energy_here / gun.volume, less * energy_there / room(way)
        if first >= second:
            temperature = energy_here / (here * heat)
            flow = gun.valve * nozzle(first, temperature, second, gun.ratio, gas)
        else:
            temperature = energy_there / (there * heat)
            flow = -gun.valve * nozzle(second, temperature, first, gun.ratio, gas)
        carried = flow * gun.ratio * heat * temperature
        pushed = second * gun.section - gun.friction
        if way <= 0.0:
            pushed = max(pushed, 0.0)
        return [-flow, -carried, flow, carried - second * gun.section * speed, speed, pushed / gun.mass]

    def out(time: float, y: Any) -> float:
        return float(y[4] - gun.length)

    def stuck(time: float, y: Any) -> float:
        return float(y[5] + 1e-9)

    out.terminal = stuck.terminal = True  # type: ignore[attr-defined]
    begin = [start, start * heat * gun.temperature, little, little * heat * gun.temperature, 0.0, 0.0]
    found = solve_ivp(rates, (0.0, LONGEST), begin, method="LSODA", rtol=1e-9, atol=1e-12, events=(out, stuck))
    if found.y_events is None or not len(found.y_events[0]):
        return None
    here, _, _, energy_there, way, speed = found.y_events[0][0]
    return Blast(float(speed), float(less * energy_there / room(way)), float(here / start))


def shot(gun: Gun, number: int) -> Blast:
    """That shot from the reservoir; `Undesigned` where its bullet does not come out."""
    found = blast(gun)
    if found is None:
        raise Undesigned("ejector.friction", f"{gun.friction:g} N", "must be less: the bullets do not come out")
    for count in range(2, number + 1):
        gun = gun._replace(pressure=gun.pressure * found.left)
        found = blast(gun)
        if found is None:
            raise Undesigned("ejector.shot", str(number), f"must be less than {count}: then no bullet comes out")
    return found


def shots(gun: Gun, least: float) -> int:
    """How many shots have at least that share of the first one's speed, up to MOST_SHOTS.

    Checked  tests/net_capture/test_ejectors.py
    """
    first = blast(gun)
    found, count = first, 0
    while first is not None and found is not None and found.speed >= least * first.speed and count < MOST_SHOTS:
        gun = gun._replace(pressure=gun.pressure * found.left)
        count += 1
        found = blast(gun)
    return count


def rows(values: Values, barrels: int) -> Iterator[Implied]:
    """For people and machines."""
    gun = gun_of(values, barrels)
    found = shot(gun, int(values["ejector.shot"]))
    yield Implied("ejector.speed", "speed that the gas gives a bullet", found.speed, "m/s")
    yield Implied("ejector.muzzle_pressure", "pressure behind a bullet as it leaves", found.muzzle, "Pa")
    yield Implied("ejector.left", "share of the reservoir's gas that a shot leaves", found.left, "")
    label = f"shots per reservoir with {100.0 * values['ejector.least_share']:g} % of the first one's speed"
    yield Implied("ejector.shots", label, float(shots(gun, values["ejector.least_share"])), "")
