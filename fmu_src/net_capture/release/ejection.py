"""The part of bullets that leave each in its own way: its rows, and what it refuses; kernels are in `held`."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from fmu_src.extremes import Extreme
from fmu_src.interface import Term, Variable
from fmu_src.net_capture.planes import MOST_BULLETS
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.net_capture.release import BOOKED
from fmu_src.net_capture.release.held import HELD_AND_TURNING, NO_WAY_OUT, NONE_LEAVES, SCHEME, make
from fmu_src.rows import output, parameter, peak, state


def ways(values: Mapping[str, float], number: int) -> list[tuple[float, float]]:
    """Speed along the shot and whole speed [m/s] of each bullet that leaves, relative to the chaser before."""
    found = []
    for i in range(1, number + 1):
        if not values[f"ejection.stays[{i}]"]:
            speed = values["bullets.speed"] + values[f"ejection.speed_error[{i}]"]
            angle = values["bullets.angle"] + values[f"ejection.angle_error[{i}]"]
            found.append((speed * math.cos(angle), speed))
    return found


def refuses(scene: Scene) -> Iterator[Refusal]:
    """Bullets that cannot leave, and what knows none that are held."""
    scheme = scene.terms.get("solver", SCHEME)
    if scheme != SCHEME:
        yield Refusal(
            "solver.scheme", f'"{scheme}"', f'knows no bullets that are held; [capture.ejection] needs "{SCHEME}"'
        )
    number = int(scene.terms["ejection"])
    if scene.terms["ejection"] != scene.terms["bullets"]:
        yield Refusal("ejection.number", str(number), f"must be {scene.terms['bullets']}, the number of bullets")
    stays, delay = scene.vector("ejection.stays", number), scene.vector("ejection.delay", number)
    if all(stays):
        yield Refusal("ejection.stays", "true for every bullet", "at least one must leave, or the net never does")
    speed, angle = scene.values["bullets.speed"], scene.values["bullets.angle"]
    errors = scene.vector("ejection.speed_error", number), scene.vector("ejection.angle_error", number)
    for bullet, (faster, wider) in enumerate(zip(*errors, strict=True), 1):
        if speed + faster <= 0.0 and not stays[bullet - 1]:
            expected = f"leaves bullet {bullet} no speed; must be more than -{speed:g} m/s, bullets.speed"
            yield Refusal("ejection.speed_error", f"{faster:g} m/s", expected)
        if math.cos(angle + wider) <= 0.0 and not stays[bullet - 1]:
            expected = f"leaves bullet {bullet} no speed along the shot; with bullets.angle it must be less than 90 deg"
            yield Refusal("ejection.angle_error", f"{math.degrees(wider):g} deg", expected)
    for bullet, late in enumerate(delay, 1):
        if late > scene.duration and not stays[bullet - 1]:
            yield Refusal(
                "ejection.delay",
                f"{late:g} s of bullet {bullet}",
                f"must be at most {scene.duration:g} s, the duration",
            )
    if "spin" in scene.terms and (any(stays) or any(delay)):
        turning = [scene.values["spin.rate"], *scene.vector("spin.chaser_rate")]
        if any(turning):
            expected = "must be 0 for every bullet: one that is held cannot go with a net or chaser that turns"
            yield Refusal("ejection.delay" if any(delay) else "ejection.stays", "late or staying", expected)


def part(number: int) -> Term:
    """The part for so many bullets."""

    def each(name: str, unit: str, text: str, low: float, high: float, **more: Any) -> Variable:
        return parameter(f"ejection.{name}[#]", unit, text, 0.0, low, high, shape=(number,), **more)

    return Term(
        f"{number} bullets that leave each in its own way: with errors, late, or not at all",
        (
            each("speed_error", "m/s", "of each bullet, on top of bullets.speed", -1e4, 1e4),
            each(
                "angle_error",
                "rad",
                "of each bullet, on top of bullets.angle",
                -0.5 * math.pi,
                0.5 * math.pi,
                display_unit="deg",
            ),
            each(
                "side_angle",
                "rad",
                "turn of each bullet's direction about the shot axis, from its diagonal",
                -math.pi,
                math.pi,
                display_unit="deg",
            ),
            each("delay", "s", "of each bullet: it is held until then, to the nearest substep", 0.0, 1e6),
            Variable(
                "ejection.stays[#]",
                "1",
                "parameter",
                "each bullet that does not leave at all",
                False,
                kind="Boolean",
                shape=(number,),
            ),
            peak("ejection.left[#]", "s", "when each bullet left, since the shot; -1 before", shape=(number,)),
            output("ejection.work", "J", "work done on bullets and chaser by the shot"),
            *BOOKED,
            Variable("ejection_held[#]", "1", "state", "bullets still held", 0, kind="Integer", shape=(number,)),
            state("ejection_velocity[#][#]", "m/s", "of each bullet as it leaves", shape=(number, 3)),
            state("ejection_place[#][#]", "m", "of each bullet while it is held, from the chaser", shape=(number, 3)),
            state("ejection_given[#]", "N.s", "impulse of the bullets that leave", shape=(3,)),
        ),
        faults=(NO_WAY_OUT, NONE_LEAVES, HELD_AND_TURNING),
        make=make,
        refuses=refuses,
        extremes=(
            Extreme(
                "one bullet stays",
                "the others fling the net round it",
                "energy_gained",
                {"ejection.stays[1]": 1.0},
                chief=True,
            ),
            Extreme(
                "one bullet a second late",
                "it leaves a net that is under way",
                "energy_gained",
                {"ejection.delay[1]": 1.0},
            ),
            Extreme(
                "one bullet ten times as fast",
                "it arrives long before the others",
                "energy_gained",
                {"ejection.speed_error[1]": lambda values: 9.0 * values["bullets.speed"]},
                duration=4.0,
            ),
        ),
    )


PARTS = {str(number): part(number) for number in range(3, MOST_BULLETS + 1)}
"""By the number of bullets."""
