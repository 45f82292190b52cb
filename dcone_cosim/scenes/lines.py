"""What a scene says its lines are made of: a material by name, its form, a strength; and what follows from it.

    [removal.tether]
    material = "Kevlar 29"      of `orbital.materials`, or of the scene's own: [materials.mine]
    form = "braid"
    strength = "2 GPa"          in place of the material's

A material gives those parameters of the line that the scene does not say itself. Who says one otherwise is taken at
their word, and told.

Checked  tests/cosim/test_materials.py
"""

from __future__ import annotations

import math
from collections.abc import Container, Iterator, Mapping
from typing import Any

from dcone_cosim import build
from dcone_cosim.scene.data import LineScene
from dcone_cosim.scene.expected import TEXT, Expected, Unexpected
from dcone_cosim.scene.mistakes import Mistake, Places
from dcone_cosim.scene.toml_lines import Path, dotted
from dcone_cosim.scenes.keys import OWN_MATERIALS as OWN
from dcone_cosim.scenes.keys import read_table, read_value, table_in
from orbital.materials import ALSO, FORMS, MATERIALS, Material, UnknownMaterial, named


def _positive(unit: str, example: str, display: str = "") -> Expected:
    return Expected(unit, example=example, minimum=0.0, open_minimum=True, display_unit=display)


OWN_KEYS: Mapping[str, Expected] = {
    "youngs_modulus": _positive("Pa", "70 GPa", "GPa"),
    "density": _positive("kg/m3", "1440 kg/m3"),
    "strength": _positive("Pa", "2.9 GPa", "GPa"),
    "strain_at_break": Expected("1", example="3.6 %", minimum=0.0, open_minimum=True, share=True),
    "damping_ratio": Expected("1", example="0.05", minimum=0.0),
    "form": Expected("1", choices=FORMS),
    "source": Expected("1", TEXT, example="data sheet"),
}
AS_GOOD_AS_SAME = 0.01
"""Share by which a scene may differ from a material without a word: figures of sheets are rounded."""
NEEDED = ("youngs_modulus", "density")
OWN_MEANING: Mapping[str, str] = {
    "youngs_modulus": "axial, over the section of a solid round of the line's diameter",
    "density": "over that section",
    "strength": "tensile stress at which it breaks, over that section; not known if not given",
    "strain_at_break": "elongation at which it breaks",
    "damping_ratio": "of a pair of bodies on it",
    "form": "of which these figures are; yarn if not given",
    "source": "where its figures stand",
}

MATERIAL, FORM, STRENGTH, DIAMETER = "material", "form", "strength", "diameter"
LINE_KEYS: Mapping[str, Expected] = {
    MATERIAL: Expected("1", TEXT, example='"Kevlar 29"'),
    FORM: Expected("1", choices=FORMS),
    STRENGTH: _positive("Pa", "2.9 GPa", "GPa"),
    DIAMETER: _positive("m", "1 mm", "mm"),
}
LINE_MEANING: Mapping[str, str] = {
    MATERIAL: f"what it is made of: {', '.join(MATERIALS)}, {', '.join(ALSO)}, or one of [{OWN}]; it gives what is not "
    "said of stiffness, density and damping",
    FORM: "of the material; a braid is lighter, softer and weaker",
    STRENGTH: "tensile stress at which it breaks; that of the material if not given",
    DIAMETER: "of its section",
}


def keys_of(line: build.Line, offered: Container[str]) -> dict[str, Expected]:
    """What a scene may say of a line beside the parameters of its component, by key."""
    chosen = {key: expected for key, expected in LINE_KEYS.items() if key != DIAMETER or line.diameter}
    return {key: expected for key, expected in chosen.items() if f"{line.table}.{key}" not in offered}


def read_own(document: Mapping[str, Any], mistakes: list[Mistake]) -> dict[str, Material]:
    """The scene's own materials by name."""
    found = {}
    for name, table in table_in(document, (OWN,), mistakes).items():
        path: Path = (OWN, name)
        if not isinstance(table, dict):
            mistakes.append(Mistake(path, table, f"expected a table [{OWN}.{name}]"))
            continue
        told = read_table(table, OWN_KEYS, path, mistakes)
        lacking = [key for key in NEEDED if key not in table]
        mistakes += [Mistake((*path, key), None, f'expected, such as "{OWN_KEYS[key].example}"') for key in lacking]
        if all(key in told for key in NEEDED):
            source = str(told.pop("source", f"the scene, [{OWN}.{name}]"))
            form = FORMS[int(told.pop("form", 0))]
            found[name] = Material(name, form=form, sources=dict.fromkeys(told, source), **told)
    return found


def known_by_name(document: Mapping[str, Any], own: Mapping[str, Material], mistake: Mistake) -> bool:
    """Whether a mistake is that a line names a material of the scene that has mistakes itself, which are told."""
    tables = document.get(OWN)
    names = tables.keys() - own.keys() if isinstance(tables, dict) else ()
    return mistake.path[-1] == MATERIAL and isinstance(mistake.given, str) and mistake.given in names


def read_line(
    line: build.Line,
    keys: Mapping[str, Expected],
    table: Mapping[str, Any],
    path: Path,
    known: Mapping[str, float],
    given: Mapping[str, float],
    terms: Mapping[str, str],
    own: Mapping[str, Material],
    mistakes: list[Mistake],
) -> tuple[LineScene, dict[str, float]] | None:
    """What a scene says of a line, and the parameters that follow; None where it says nothing.

    keys     with which it may
    table    of the scene that has them, at `path`
    known    parameters that the component has, with their start values
    given    those that the scene says
    terms    of the component
    own      its own materials
    """
    told = {
        key: read_value(table[key], expected.read, (*path, key), mistakes)
        for key, expected in keys.items()
        if key in table
    }
    if not told or None in told.values():
        return None
    material = None
    if MATERIAL in told:
        material = read_value(table[MATERIAL], lambda given: _named(given, told, own), (*path, MATERIAL), mistakes)
        if material is None:
            return None
    elif FORM in told:
        mistakes.append(Mistake((*path, FORM), table[FORM], f"needs a {MATERIAL} beside it, of which it is the form"))
    strength = told.get(STRENGTH, None if material is None else material.strength)
    diameter = given.get(line.diameter, known.get(line.diameter, told.get(DIAMETER)))
    if DIAMETER in told and material is None and line.stiffness and line.stiffness not in given:
        key = line.stiffness.partition(".")[2]
        text = f"says nothing of its stiffness without a {MATERIAL} or {key} beside it"
        mistakes.append(Mistake((*path, DIAMETER), table[DIAMETER], text))
    usual = diameter if diameter is not None else line.usual
    follows = {} if material is None else line.follow(material, usual, known)
    if line.breaks_at in known and strength is not None:
        area = line.section({**known, **follows, **given}, terms, material, told.get(DIAMETER))
        follows |= {} if area is None else {line.breaks_at: strength * area}
    apart = {name: value for name, value in follows.items() if _differs(given.get(name, value), value)}
    taken = {name: value for name, value in follows.items() if name not in given}
    return LineScene(material, strength, told.get(DIAMETER), tuple(taken), apart), taken


def _named(name: str, told: Mapping[str, Any], own: Mapping[str, Material]) -> Material:
    """The material of a name in the form that is told, or `Unexpected`."""
    form = FORMS[int(told.get(FORM, 0))]
    try:
        found = named(name, form, own)
    except UnknownMaterial as error:
        near = f"; did you mean {error.nearest!r}?" if error.nearest else ""
        raise Unexpected(
            f"no material of that name{near} known: {', '.join(error.known)}; your own goes into [{OWN}.NAME]"
        ) from None
    if FORM in told and found.form != form:
        raise Unexpected(f"is a {found.form}, and the {form} it is made of is not known; leave {FORM} out")
    return found


def set_apart(path: Path, lines: Mapping[str, LineScene], places: Places) -> Iterator[str]:
    """What does not follow from a material that the command line sets, since the scene says it itself.

    path    of the component whose lines these are, by table
    """
    for table, line in lines.items():
        by_command = any(places.override((*path, table, key)) for key in (MATERIAL, FORM))
        if line.material is not None and by_command:
            for name, value in line.apart.items():
                key, of = dotted((*path, *name.split("."))), f"{line.material.name}, {line.material.form}"
                yield f"{key} is as the scene says; {of}, has {value:.4g}, SI"


def _differs(given: float, of_material: float) -> bool:
    return not math.isclose(given, of_material, rel_tol=AS_GOOD_AS_SAME)
