"""A breadboard that is similar to a capture: everything smaller, at the same speeds.

With a share s of every length and of every time, masses take s3, and what has the dimension kg^a m^b s^c takes
s^(3a + b + c): speeds, stresses, moduli and densities stay, forces and stiffness EA take s2, angular rates 1/s. Then
the equations of net, bullets, target and winches are the same, and so is every angle, share and ratio over t/s.

Valid    without gravity, air or anything else that has a scale of its own: what these break, the comments say
Source   dimensional analysis, as in Buckingham, Phys. Rev. 4 (1914) 345
Checked  tests/cosim/test_scaled.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from dcone_cosim import build
from dcone_cosim.errors import InputError
from dcone_cosim.scene.data import SHARED, PhaseScene, Scene
from dcone_cosim.scene.toml_lines import Path
from dcone_cosim.scenes.text import with_values
from dcone_cosim.units import by_name, written

CAPTURE = "capture"
OF_NATURE = (SHARED, "gravity", "air")
"""Tables whose values are those of a place, and stay."""
STANDARD_GRAVITY = 9.80665
DIGITS = 12


def share_of(text: str) -> float:
    """A share as told, `1/16` or `0.0625`; `InputError` for anything but one above 0 and up to 1."""
    try:
        share = float(Fraction(text.strip()))
    except (ValueError, ZeroDivisionError):
        share = math.nan
    if not 0.0 < share <= 1.0:
        raise InputError(f"--scaled {text}: expected a share above 0 and up to 1, such as 1/16")
    return share


def power(unit: str) -> int:
    """That of the share by which a quantity of this FMI unit is scaled.

    Checked  tests/cosim/test_scaled.py
    """
    dimension = by_name(unit).dimension
    if dimension is None:
        return 0
    mass, length, time = dimension[:3]
    return 3 * mass + length + time


def scaled(text: str, scene: Scene, share: float) -> tuple[str, list[str]]:
    """The text of a scene's capture at that share, and what is to be known of it, line by line.

    text     of the scene, which `scene` has been read from
    """
    if not scene.phases or scene.phases[0].name != CAPTURE:
        raise InputError(f"{scene.name} does not begin with a capture; only a capture can be scaled")
    phase = scene.phases[0]
    if phase.others:
        raise InputError(f"{scene.name} has further components in its capture; only a capture by itself can be scaled")
    changes: dict[Path, Any] = dict(_times(phase, share)) | dict(_values(phase, share))
    changes["title",] = f"{scene.title}, at {share:g}"
    changes["phases",] = [CAPTURE]
    return with_values(text, changes), list(_comments(scene, phase, share))


def _times(phase: PhaseScene, share: float) -> Iterator[tuple[Path, Any]]:
    told = {"macro_step": phase.macro_step, "duration": phase.duration, "after_capture": phase.options.after_capture}
    for key, value in told.items():
        if math.isfinite(value):
            yield (CAPTURE, key), _text(share * value, "s")
    if phase.options.snapshots:
        yield (CAPTURE, "snapshots"), [_text(share * time, "s") for time in phase.options.snapshots]


def _values(phase: PhaseScene, share: float) -> Iterator[tuple[Path, Any]]:
    """Every value that changes, those left at their defaults too."""
    main = phase.main
    interface = build.CATALOGUE[main.model].interface(main.terms)
    values = {**main.defaults, **main.asked, **main.parameters}
    for row in build.settable(interface):
        exponent = power(row.unit)
        names = list(row.element_names())
        if row.kind != "Real" or not exponent or row.section in OF_NATURE or not all(name in values for name in names):
            continue
        numbers = [values[name] * share**exponent for name in names]
        if any(numbers) and row.key and all(map(math.isfinite, numbers)):
            told = [_text(number, row.unit) for number in numbers]
            yield (CAPTURE, row.section, row.key), told if row.shape else told[0]


def _text(value: float, unit: str) -> str:
    return written(value, unit, DIGITS)


def _comments(scene: Scene, phase: PhaseScene, share: float) -> Iterator[str]:
    values = phase.main.values
    rows = {row.key: row.value for row in build.implied(phase.main.model, values, phase.main.terms)}
    side = max(build.mouth_sides(values, phase.main.terms), default=math.nan)
    fall = 0.5 * STANDARD_GRAVITY * (share * phase.duration) ** 2
    thick = rows.get("thread.diameter", math.nan) * share
    yield f"Similar to {scene.name!r} at s = {share:g}: lengths and times x s at the same speeds, masses x s3,"
    yield "forces and EA x s2, angular rates x 1/s. The mouth opens as there, over t/s. What can not be kept:"
    yield f"- gravity: on the ground what flies falls {fall:.3g} m in {share * phase.duration:.3g} s,"
    yield f"  and the net is {share * side:.3g} m wide; in orbit the frame would have to turn faster."
    yield '  Try it: [capture.gravity] law = "uniform", or "history" on a parabola.'
    yield "- drag: there is none in orbit. In air it takes s2, as all forces do; but threads of s times the diameter"
    yield "  have Reynolds numbers s times as large, so their drag coefficient is another. Try it: [capture.air]."
    yield f"- E: kept with the same fibre alone, as threads of {1e3 * thick:.3g} mm. With any other the opening"
    yield "  stays nearly the same, and tensions go with sqrt(E): say what a laboratory's thread has."
