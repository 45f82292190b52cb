"""Whether a shot can reach its target at all: necessary conditions, in closed form, for a clear refusal before any run.

They are bounds, not a prediction: a scene that passes may still miss, and only the run tells.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

FALLEN_BACK = 2.0
"""A net flies on about as far again as it took to open while it falls back: at Table 1's shot the mouth, full at 21.5
m, is below a tenth of its area beyond 40 m (measured with this model, undisturbed, damping ratio 0.106)."""


class Refusal(NamedTuple):
    """A value that makes the shot impossible: FMI name, the value as text, what was expected."""

    name: str
    value: str
    expected: str


def _vector(parameters: Mapping[str, float], name: str) -> list[float]:
    return [float(parameters[f"{name}[{i}]"]) for i in (1, 2, 3)]


def opening_distance(side: float, fold_side: float, speed: float, angle: float) -> float:
    """Distance [m] flown by the bullets when, unhindered, they have spread to the corners of the flat net.

        z = (a - a0) / (sqrt(2) tan(alpha))

    side       a      of the flat net                  [m]
    fold_side  a0     of the folded net                [m]
    speed      V0     of the bullets                   [m/s]
    angle      alpha  from the shot axis               [rad]

    Valid    a lower bound of where the mouth is largest: the net holds the bullets back
    """
    return (side - fold_side) / (math.sqrt(2.0) * math.tan(angle)) if speed > 0.0 and angle > 0.0 else math.inf


def refusals(parameters: Mapping[str, float], duration: float = math.inf) -> list[Refusal]:
    """Why a shot can not reach its target: empty if nothing speaks against it.

    parameters   values by FMI name [SI]; names of terms that are not in the scene may be missing
    duration     of the capture phase [s]
    """
    if "target.size[1]" not in parameters:
        return []
    found = []
    chaser = _vector(parameters, "chaser.start_position")
    size = _vector(parameters, "target.size")
    axis = _vector(parameters, "shot.axis")
    distance = math.hypot(*chaser)
    where = f"{distance:.4g} m from the target"
    side = float(parameters["net.side"])
    speed = float(parameters["bullets.speed"])
    angle = float(parameters["bullets.angle"])
    near = distance - 0.5 * math.hypot(*size)
    tether = parameters.get("tether.length")
    if tether is not None and tether < distance:
        found.append(
            Refusal("tether.length", f"{tether:g} m", f"at least {distance:.4g} m, the distance to the target")
        )
    girth = 2.0 * (sum(size) - max(size))
    if 4.0 * side <= girth:
        found.append(
            Refusal("net.side", f"{side:g} m", f"more than {girth / 4:.4g} m: the mouth must go round the target")
        )
    forward = speed * math.cos(angle)
    if forward <= 1e-9:
        found.append(
            Refusal("bullets.speed", f"{speed:g} m/s", "a speed along the shot axis, or the net never arrives")
        )
    elif near / forward > duration:
        expected = (
            f"at most {forward * duration + distance - near:.4g} m: the net flies {forward:.3g} m/s for {duration:g} s"
        )
        found.append(Refusal("chaser.start_position", where, expected))
    limit = FALLEN_BACK * opening_distance(side, float(parameters["net.fold_side"]), speed, angle)
    if forward > 1e-9 and near > limit:
        expected = f"at most {limit + distance - near:.4g} m: farther out the net has fallen back on itself"
        found.append(Refusal("chaser.start_position", where, expected))
    length = math.hypot(*axis)
    if length > 0.0 and distance > 0.0:
        along = -sum(a * c for a, c in zip(axis, chaser, strict=True)) / length
        beside = math.sqrt(max(distance * distance - along * along, 0.0))
        if along <= 0.0 or beside > 0.5 * side + 0.5 * math.hypot(*size):
            found.append(
                Refusal(
                    "shot.axis", f"passes {beside:.4g} m beside the target", f"within {0.5 * side:.4g} m of its centre"
                )
            )
    return found
