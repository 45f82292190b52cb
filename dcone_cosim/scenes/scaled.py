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
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from typing import Any, NamedTuple

from dcone_cosim import build
from dcone_cosim.errors import InputError
from dcone_cosim.phases import kinds
from dcone_cosim.scene.data import SHARED, PhaseScene, Scene, TableFile
from dcone_cosim.scene.expected import Expected
from dcone_cosim.scene.toml_lines import Path, dotted, given_at
from dcone_cosim.scenes.keys import phase_keys
from dcone_cosim.scenes.lines import DIAMETER
from dcone_cosim.scenes.tables import entry_keys
from dcone_cosim.scenes.text import put
from dcone_cosim.units import by_name, written

CAPTURE = "capture"
OF_NATURE = (SHARED, "gravity", "air")
"""Tables whose values are those of a place, and stay."""
LEFT_OUT = ("handoff", "sizing")
"""Tables at the top that say nothing of a capture alone."""
STANDARD_GRAVITY = 9.80665
DIGITS = 12


class Scaled(NamedTuple):
    """A scene at a share.

    text      as TOML
    comments  what is to be known of it, line by line
    files     name and text of each file that it names and has beside it, by the key that names it
    """

    text: str
    comments: list[str]
    files: dict[Path, tuple[str, str]]


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


def scaled(text: str, scene: Scene, share: float, name: str) -> Scaled:
    """A scene's capture at that share.

    text     of the scene, which `scene` has been read from
    name     with which the names of its files begin
    """
    if not scene.phases or scene.phases[0].name != CAPTURE:
        raise InputError(f"{scene.name} does not begin with a capture; only a capture can be scaled")
    import tomlkit

    phase = scene.phases[0]
    if phase.others:
        raise InputError(f"{scene.name} has further components in its capture; only a capture by itself can be scaled")
    document = tomllib.loads(text)
    dropped = [table for table in document if table in LEFT_OUT or (table != CAPTURE and table in kinds())]
    document = {table: value for table, value in document.items() if table not in dropped}
    document[CAPTURE].pop("parameters", None)  # every value is told by its key
    files = {table.path: (f"{name}-{table.file.name}", text) for table, text in _files(phase, share)}
    changes = {
        ("title",): f"{scene.title}, at {share:g}",
        ("phases",): [CAPTURE],
        **dict(_times(phase, document[CAPTURE], share)),
        **dict(_values(phase, share)),
        **dict(_sections(phase, share)),
        **dict(_entries(phase, document, share)),
        **{path: copy for path, (copy, _) in files.items()},
    }
    for path, value in changes.items():
        put(document, path, value)
    comments = [*_comments(scene, phase, share), *_kept(phase, document), *_dropped(dropped)]
    return Scaled(tomlkit.dumps(document), comments, files)


def _times(phase: PhaseScene, table: Mapping[str, Any], share: float) -> Iterator[tuple[Path, Any]]:
    """What concerns the phase itself: what the scene says, and the times that it leaves at their defaults."""
    told = {"macro_step": phase.macro_step, "duration": phase.duration, "after_capture": phase.options.after_capture}
    for key, value in told.items():
        if math.isfinite(value):
            yield (CAPTURE, key), _text(share * value, "s")
    for key, expected in phase_keys(CAPTURE).items():
        if key in table and key not in told and power(expected.unit):
            yield (CAPTURE, key), _scaled(table[key], expected, share)


def _values(phase: PhaseScene, share: float) -> Iterator[tuple[Path, Any]]:
    """Every value that changes, those left at their defaults too; none that follows from others."""
    main = phase.main
    interface = build.CATALOGUE[main.model].interface(main.terms)
    values = {**main.defaults, **main.asked, **main.parameters}
    follow = {*interface.follows, *main.designed}
    for row in build.settable(interface):
        exponent = power(row.unit)
        names = list(row.element_names())
        if row.kind != "Real" or not exponent or row.section in OF_NATURE or not all(name in values for name in names):
            continue
        numbers = [values[name] * share**exponent for name in names]
        if any(numbers) and row.key and not follow & {row.name, *names} and all(map(math.isfinite, numbers)):
            told = [_text(number, row.unit) for number in numbers]
            yield (CAPTURE, row.section, row.key), told if row.shape else told[0]


def _sections(phase: PhaseScene, share: float) -> Iterator[tuple[Path, Any]]:
    """Diameters of lines that are no parameters of the model."""
    for table, line in phase.main.lines.items():
        if line.diameter is not None:
            yield (CAPTURE, table, DIAMETER), _text(share * line.diameter, "m")


def _entries(phase: PhaseScene, document: Mapping[str, Any], share: float) -> Iterator[tuple[Path, Any]]:
    """Tables that the scene gives entry by entry, such as the parts of a target."""
    main = phase.main
    for table in build.CATALOGUE[main.model].interface(main.terms).sources:
        path: Path = (CAPTURE, *table.name.split("."))
        keys = entry_keys(table)
        for place, entry in enumerate(given_at(document, path) or () if table.entry else ()):
            for key, value in entry.items():
                if power(keys[key].expected.unit):
                    yield (*path, place, key), _scaled(value, keys[key].expected, share)


def _files(phase: PhaseScene, share: float) -> Iterator[tuple[TableFile, str]]:
    """Tables that files have, and their text; none that has its unit from a value of the scene, or is of a place."""
    interface = build.CATALOGUE[phase.main.model].interface(phase.main.terms)
    known = {table.name: table for table in (*interface.tables, *interface.sources)}
    for name, table in phase.main.tables.items():
        if known[name].counted_in or table.path[1] in OF_NATURE:
            continue
        rewritten = known[name].rewritten
        if rewritten is None:
            text = f"{dotted(table.path)} names {table.file.name}, which cannot be scaled: {known[name].description}"
            raise InputError(text)
        yield table, rewritten(table.file, lambda unit: share ** power(unit))


def _scaled(given: Any, expected: Expected, share: float) -> str | list[str]:
    """What a scene says, times the share's power of its unit."""
    read, factor = expected.read(given), share ** power(expected.unit)
    if isinstance(read, list):
        return [_text(factor * number, expected.unit) for number in read]
    return _text(factor * read, expected.unit)


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


def _kept(phase: PhaseScene, document: Mapping[str, Any]) -> Iterator[str]:
    """What the scene says of a place, and what stands as it was."""
    main = phase.main
    interface = build.CATALOGUE[main.model].interface(main.terms)
    named = {build.scene_name(row) for row in build.settable(interface) if power(row.unit)}
    named |= {table.name for table in interface.tables}
    tables = {name: given_at(document, (name,) if name == SHARED else (CAPTURE, name)) or {} for name in OF_NATURE}
    kept = [f"{name}.{key}" for name, table in tables.items() for key in table if f"{name}.{key}" in named]
    if kept:
        yield f"- as they are there, since they are of a place: {', '.join(kept)}."


def _dropped(names: Iterable[str]) -> Iterator[str]:
    told = ", ".join(f"[{name}]" for name in names)
    if told:
        yield f"Left out, as it is not scaled: {told}."
