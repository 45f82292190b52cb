"""Why a tow with the values of a scene cannot begin, told before anything is built."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np
import numpy.typing as npt

from fmu_src.tethered_deorbit.body_rows import NOT_OF_A_BODY
from fmu_src.tethered_deorbit.interface import CONDITIONS, EQUAL_VELOCITY, HANDED_OVER
from fmu_src.tethered_deorbit.optional_rows import POINTS_ONLY, SETTLING_LAWS, not_mapped
from fmu_src.tethered_deorbit.reel_refusals import of_reel
from orbital.constants import EARTH_EQUATORIAL_RADIUS

Refusal = tuple[str, str, str]
"""FMI name, its value as text, what was expected."""
Matrix = npt.NDArray[np.float64]
NOTCH = 2
ROUNDING = 1e-9
"""Of a moment of inertia, as the kernels have it."""
ORBITAL = {"oblateness": "zonal", "air": "law", "third_bodies": "which", "shadow": "shape", "electrodynamic": "field"}
"""Groups that mean nothing without an orbit, and the key by which a scene names their terms."""


def refusals(terms: Mapping[str, str], values: Mapping[str, float], handed_over: bool) -> Iterator[Refusal]:
    """What does not go together.

    terms         by group
    values        every parameter by FMI name, SI
    handed_over   the tow begins with what the phase before hands over

    Checked  tests/cosim/test_tow_refusals.py
    """
    yield from _of_orbit(terms, values)
    yield from _of_inertias(terms, values, handed_over)
    yield from _of_parts(terms, values)
    if not (handed_over or values["start.condition"] == HANDED_OVER):
        yield from _of_start(terms, values)


def _of_orbit(terms: Mapping[str, str], values: Mapping[str, float]) -> Iterator[Refusal]:
    """A perigee a (1 - e) within the Earth."""
    if terms.get("environment") == "none" or not {"orbit.altitude", "orbit.eccentricity"} <= values.keys():
        return
    axis, eccentricity = EARTH_EQUATORIAL_RADIUS + values["orbit.altitude"], values["orbit.eccentricity"]
    perigee = axis * (1.0 - eccentricity)
    if perigee < EARTH_EQUATORIAL_RADIUS:
        most = 1.0 - EARTH_EQUATORIAL_RADIUS / axis
        below = 1e-3 * (EARTH_EQUATORIAL_RADIUS - perigee)
        text = f"has its perigee {below:.4g} km below the equatorial radius; with this altitude at most {most:.4g}"
        yield "orbit.eccentricity", f"{eccentricity:g}", text


def _of_inertias(terms: Mapping[str, str], values: Mapping[str, float], handed_over: bool) -> Iterator[Refusal]:
    """Of bodies that turn, of an appendage, and of what the target is without that; of a target that is handed over
    the last is not known."""
    given = [role for role in ("target", "chaser", "appendage") if f"{role}.inertia[1]" in values]
    wrong = [role for role in given if not _is_of_a_body(_inertia(values, role), thin=role == "appendage")]
    for role in wrong:
        yield f"{role}.inertia", _inertia_given(values, role), NOT_OF_A_BODY
    if "appendage" not in given or "target" not in given or wrong or handed_over:
        return
    mass, whole = values["appendage.mass"], values["target.mass"]
    if mass >= whole:
        return  # told by `_of_appendage`
    center = np.array([values[f"appendage.center[{i}]"] for i in (1, 2, 3)])
    apart = mass * whole / (whole - mass) * (center @ center * np.eye(3) - np.outer(center, center))
    if not _is_of_a_body(_inertia(values, "target") - _inertia(values, "appendage") - apart, thin=True):
        text = "leaves no body of the target: target.inertia has that of the appendage in it, about the common centre"
        yield "appendage.inertia", _inertia_given(values, "appendage"), text


def _inertia(values: Mapping[str, float], role: str) -> Matrix:
    """Matrix of inertia [kg m2], (3, 3)."""
    i11, i22, i33, i12, i13, i23 = (values[f"{role}.inertia[{i}]"] for i in range(1, 7))
    return np.array([[i11, i12, i13], [i12, i22, i23], [i13, i23, i33]])


def _inertia_given(values: Mapping[str, float], role: str) -> str:
    told = ", ".join(f"{values[f'{role}.inertia[{i}]']:g}" for i in range(1, 7))
    return f"[{told}] kg m2"


def _is_of_a_body(inertia: Matrix, thin: bool) -> bool:
    """Whether a body can have that inertia; a thin one may have no moment about an axis, within rounding."""
    least, _, greatest = np.linalg.eigvalsh(inertia)
    trace = float(np.trace(inertia))
    return bool((least >= -ROUNDING * trace if thin else least > 0.0) and greatest <= 0.5 * trace * (1.0 + ROUNDING))


def _of_parts(terms: Mapping[str, str], values: Mapping[str, float]) -> Iterator[Refusal]:
    if "aocs" in terms and terms.get("chaser") == "point":
        yield "aocs.frequency", f"{values['aocs.frequency']:g} rad/s", "needs a chaser that turns, chaser.body = rigid"
    if "appendage" in terms:
        yield from _of_appendage(terms, values)
    if "engine" in terms and values["engine.propellant"] >= values["chaser.mass"]:
        text = f"must be less than chaser.mass, {values['chaser.mass']:g} kg, of which it is a part"
        yield "engine.propellant", f"{values['engine.propellant']:g} kg", text
    if "engine" in terms and values["engine.tank_radius"] > 0.0:
        yield from _of_tank(terms, values)
    if "burn" in terms:
        yield from _of_burns(terms, values)
    for group, key in ORBITAL.items():
        if group in terms and terms.get("environment") == "none":
            yield f"{group}.{key}", terms[group], "needs an orbit; leave the table out, or environment.field = none"
    if terms.get("release") in ("altitude", "perigee") and terms.get("environment") == "none":
        yield f"release.{terms['release']}", terms["release"], "needs an orbit; take release.when = time"
    if "electrodynamic" in terms and (terms.get("target"), terms.get("chaser")) != ("point", "point"):
        yield (
            "electrodynamic.field",
            terms["electrodynamic"],
            "spans two points; take target.body and chaser.body = point",
        )
    if "power" in terms and terms.get("engine") == "chemical":
        yield "power.source", terms["power"], "feeds an electric engine; take engine.kind = electric"
    if "level" in terms and terms["reel"] not in SETTLING_LAWS:
        text = f"a line settles with reel.law = {' or '.join(SETTLING_LAWS)} alone; leave the table out, or take that"
        yield "level.detail", terms["level"], text
    if terms.get("level") in POINTS_ONLY:
        for group, term in not_mapped(terms).items():
            text = f"does not go with {group} = {term}: it carries two points"
            if terms["level"] == "averaged":
                text += ", central gravity and thrust along_track"
            yield "level.detail", terms["level"], text
    yield from of_reel(values, terms)


def _of_appendage(terms: Mapping[str, str], values: Mapping[str, float]) -> Iterator[Refusal]:
    given = f"{values['appendage.mass']:g} kg"
    if terms.get("target") == "point":
        yield "appendage.mass", given, "needs a target that turns, target.body = rigid, box, cylinder or hull"
    elif values["appendage.mass"] >= values["target.mass"]:
        text = f"must be less than target.mass, {values['target.mass']:g} kg, of which it is a part"
        yield "appendage.mass", given, text
    if not any(values[f"appendage.axis[{i}]"] for i in (1, 2, 3)):
        yield "appendage.axis", "0, 0, 0", "must have a direction"


def _of_tank(terms: Mapping[str, str], values: Mapping[str, float]) -> Iterator[Refusal]:
    given = f"{values['engine.tank_radius']:g} m"
    if terms.get("chaser") == "point":
        yield "engine.tank_radius", given, "needs a chaser that turns, chaser.body = rigid"
        return
    inertia = _inertia(values, "chaser")
    least = 0.5 * float(np.trace(inertia)) - float(np.linalg.eigvalsh(inertia)[-1])
    taken = values["engine.propellant"] * values["engine.tank_radius"] ** 2
    if not 0.5 * taken < least:
        text = (
            f"the empty chaser would be no body: at most {math.sqrt(2.0 * least / values['engine.propellant']):.4g} m"
        )
        yield "engine.tank_radius", given, text


def _of_burns(terms: Mapping[str, str], values: Mapping[str, float]) -> Iterator[Refusal]:
    stiff = terms["reel"] != "commanded" and values.get("reel.proportional_gain", 1.0) > 0.0
    if values["burn.edge"] == NOTCH and not stiff:
        yield "burn.edge", "notch", "needs a line with a stiffness of its own; take a step or a ramp"
    if terms["burn"] == "arcs" and terms.get("environment") == "none":
        yield "burn.half_width", f"{values['burn.half_width']:g} rad", "arcs need an orbit; take burn.when = timed"
    if terms["burn"] == "timed" and values["burn.duration"] == 0.0 and not stiff:
        yield "burn.duration", "0 s", "stands for the period of the line, and this line has none; give a duration"


def _arm(values: Mapping[str, float], role: str) -> float:
    """How far from the centre of mass of a body that turns the line is made fast [m]."""
    return math.hypot(*(values[f"{role}.attachment[{axis}]"] for axis in (1, 2, 3)))


def _of_start(terms: Mapping[str, str], values: Mapping[str, float]) -> Iterator[Refusal]:
    if terms.get("environment") == "none" and values["start.condition"] != EQUAL_VELOCITY:
        given = CONDITIONS[int(values["start.condition"])]
        yield "start.condition", given, "needs an orbit; without a field take equal_velocity or handed_over"
        return
    separation, rest_length = values["start.separation"], values.get("tether.rest_length", math.inf)
    turning = [role for role in ("chaser", "target") if terms.get(role) != "point"]
    if turning:
        # how far the attachments are apart, the attitudes say: at least so far
        least = separation - sum(_arm(values, role) for role in turning)
        if least > rest_length:
            text = (
                f"leaves the attachments at least {least:g} m apart: at most tether.rest_length, {rest_length:g} m, or "
                "the locked line would start stretched"
            )
            yield "start.separation", f"{separation:g} m", text
        return
    attachment = values["target.attachment_distance"]
    longest = rest_length + attachment
    if separation > longest:
        sum_of = "tether.rest_length" + (" + target.attachment_distance" if attachment else "")
        text = f"must be at most {sum_of}, {longest:g} m, or the locked line would start stretched"
        yield "start.separation", f"{separation:g} m", text
    elif separation <= attachment:
        text = f"must exceed target.attachment_distance, {attachment:g} m: the line ends there"
        yield "start.separation", f"{separation:g} m", text
