"""What a scene may say of our models, and what they say of it before and after a run."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from fmu_src.catalogue import MODELS as CATALOGUE
from fmu_src.cautions import Caution, Seen
from fmu_src.extremes import Extreme
from fmu_src.implied import Implied
from fmu_src.interface import Group, Interface, Laid, Model, Undesigned, Value, Variable
from fmu_src.lines import Line
from fmu_src.net_capture import cautions as net_capture_cautions
from fmu_src.net_capture import lines as net_capture_lines
from fmu_src.net_capture import stress as net_capture_stress
from fmu_src.net_capture import trade as net_capture_trade
from fmu_src.net_capture.capacity import FAMILIES
from fmu_src.net_capture.interface import MODEL as NET_CAPTURE
from fmu_src.net_capture.stepping import MEASURE_INTERVAL
from fmu_src.tables import Table, from_files
from fmu_src.tethered_deorbit import cautions as tethered_deorbit_cautions
from fmu_src.tethered_deorbit import lines as tethered_deorbit_lines
from fmu_src.tethered_deorbit import optional_rows as tethered_deorbit_rows
from fmu_src.tethered_deorbit import stress as tethered_deorbit_stress
from fmu_src.tethered_deorbit import trade as tethered_deorbit_trade
from fmu_src.tethered_deorbit.interface import MODEL as TETHERED_DEORBIT
from fmu_src.trade import Rung

CAUTIONS = {NET_CAPTURE.name: net_capture_cautions, TETHERED_DEORBIT.name: tethered_deorbit_cautions}
"""What a model has to say of a run, by its name."""

LINES = {NET_CAPTURE.name: net_capture_lines.LINES, TETHERED_DEORBIT.name: tethered_deorbit_lines.LINES}
"""The lines of a model, by its name."""

TRADES = {NET_CAPTURE.name: net_capture_trade, TETHERED_DEORBIT.name: tethered_deorbit_trade}
"""How a model trades accuracy for time, by its name."""

STRESSES = {NET_CAPTURE.name: net_capture_stress, TETHERED_DEORBIT.name: tethered_deorbit_stress}
"""Ends of the range that belong to no part of a model, by its name."""

LOOKS_EVERY = MEASURE_INTERVAL
"""Time between two looks of a net at its mouth and its capture, whose instants are those of a look [s]."""

SETTABLE = ("parameter", "input")
"""Causality of what a scene may give a value: an input keeps it from the start."""


@dataclass(frozen=True)
class Refusal:
    """A value that cannot work although it is within its bounds: which, as given, and what would."""

    variable: str
    given: str
    expected: str


def settable(interface: Interface) -> Iterator[Variable]:
    """The rows a scene may set, those among them that only the scene knows."""
    yield from (v for v in interface.variables if v.causality in SETTABLE)
    yield from interface.asked


def scene_name(row: Variable) -> str:
    """Name of a row as a scene says it, table and key: `target.size`; without a table for a name of one part."""
    return f"{row.section}.{row.key}" if row.key else row.section


def term_rows(group: Group, term: str) -> tuple[Variable, ...]:
    """The rows a term brings; none for a name that is no term."""
    return (*group.terms[term].variables, *group.terms[term].asked) if term in group.terms else ()


def is_counted(group: Group) -> bool:
    """Whether its terms are numbers of outputs, of which it lists none."""
    return not any(term in group.terms for term in group.terms)


def all_rows(model: Model) -> Iterator[Variable]:
    """Every row the model can have: those that are always there, and those of every term."""
    yield from model.base
    for group in model.groups.values():
        for term in group.terms:
            yield from term_rows(group, term)


def all_tables(model: Model) -> Iterator[Table]:
    """Every table that a scene of the model can give."""
    for group in model.groups.values():
        for term in group.terms:
            if term in group.terms:
                part = group.terms[term]
                yield from (*part.sources, *(() if part.lay is not None else from_files(part.tables)))


def defaults(interface: Interface) -> dict[str, float]:
    """Start value of every parameter and input by FMI name, SI."""
    return {
        name: float(start)
        for v in interface.variables
        if v.causality in SETTABLE
        for name, start in zip(v.element_names(), v.starts(), strict=True)
    }


def asked_variables(name: str) -> dict[str, tuple[Variable, Value]]:
    """Row and start value of all that only scenes of the model of that name know, with whatever terms, by name."""
    groups = CATALOGUE[name].groups.values()
    rows = (v for group in groups for term in group.terms if term in group.terms for v in group.terms[term].asked)
    return {e: (v, s) for v in rows for e, s in zip(v.element_names(), v.starts(), strict=True)}


def asked_names(model: str, terms: Mapping[str, str]) -> set[str]:
    """Names of what only a scene knows of a model of ours with these terms: no FMU has them."""
    return {name for v in CATALOGUE[model].interface(terms).asked for name in v.element_names()}


def designed(
    model: str, values: Mapping[str, float], asked: Mapping[str, float], terms: Mapping[str, str]
) -> dict[str, float] | Refusal:
    """Parameters that follow from what a scene asks of a model of ours, SI by FMI name; or why none do.

    values        every parameter and input by FMI name, SI
    asked         every row that only the scene knows
    """
    found: dict[str, float] = {}
    groups = CATALOGUE[model].groups
    try:
        for group, name in terms.items():
            design = groups[group].terms[name].design
            if design is not None:
                found |= design(values, asked, terms)
    except Undesigned as error:
        return Refusal(error.name, error.given, error.expected)
    return found


def lays(model: str, terms: Mapping[str, str], sources: Mapping[str, Any]) -> bool:
    """Whether parts of a model of ours make tables: of these that a scene gives, or of its values alone."""
    groups = CATALOGUE[model].groups
    parts = [groups[group].terms[name] for group, name in terms.items()]
    return any(part.lay is not None and (sources or not part.sources) for part in parts)


def laid(model: str, values: Mapping[str, Any], sources: Mapping[str, Any], terms: Mapping[str, str]) -> Laid | Refusal:
    """Tables, and parameters that follow, that the parts of a model of ours make of what a scene gives them; or why
    they make none.

    values        every parameter and input by FMI name, SI, and every row that only the scene knows
    sources       numbers of the tables that the scene gives, by name
    """
    tables: dict[str, Any] = {}
    parameters: dict[str, float] = {}
    shown: dict[str, Any] = {}
    groups = CATALOGUE[model].groups
    try:
        for group, name in terms.items():
            lay = groups[group].terms[name].lay
            if lay is not None:
                made = lay(values, sources)
                tables |= made.tables
                parameters |= made.parameters
                shown |= made.shown
    except Undesigned as error:
        return Refusal(error.name, error.given, error.expected)
    return Laid(tables, parameters, shown)


def lines(model: str, terms: Mapping[str, str]) -> list[Line]:
    """The lines of a model with these terms; of an FMU from elsewhere, which names none, all that it may have."""
    return [line for line in LINES.get(model, ()) if not terms or not line.group or line.group in terms]


def known_variables(name: str) -> dict[str, tuple[Variable, Value]]:
    """Row and start value of every variable that the model of that name can have, with whatever terms, by FMI name."""
    model = CATALOGUE[name]
    rows = list(model.base)
    for name, group in model.groups.items():
        # a term for any number of one thing is a family of its own: one of them stands for all
        terms = [group.terms["1"]] if name in FAMILIES else group.terms.values()
        rows += [v for term in terms for v in term.variables]
    found: dict[str, tuple[Variable, Value]] = {}
    for v in rows:
        for element, start in zip(v.element_names(), v.starts(), strict=True):
            if v.at_interface:
                found.setdefault(element, (v, start))
    return found


def cannot_work(
    model: str, values: Mapping[str, float], duration: float, terms: Mapping[str, str], handed_over: bool
) -> list[Refusal]:
    """Why a phase with these values cannot work, by conditions known before any build; empty if nothing is known.

    values        every parameter of the phase by FMI name, SI
    duration      in which a shot has to arrive [s]
    handed_over   the phase begins with what the one before hands over
    """
    if model == NET_CAPTURE.name:
        from fmu_src.net_capture.interface import refusals

        return [Refusal(*row) for row in refusals(terms, values, duration)]
    if model == TETHERED_DEORBIT.name:
        from fmu_src.tethered_deorbit.refusals import refusals as of_tow

        return [Refusal(*row) for row in of_tow(terms, values, handed_over)]
    return []


def cautions(
    phase: str, model: str, values: Mapping[str, float], given: Collection[str], terms: Mapping[str, str]
) -> list[str]:
    """What a phase of ours means that its user may not expect, in plain sentences, as far as values alone tell it.

    model         of the phase, by name
    values        every parameter and input of the phase by FMI name, SI
    given         names of those that the scene gives
    """
    return _spoken(phase, CAUTIONS[model].before(values, given, terms)) if model in CAUTIONS else []


def cautions_after(
    phase: str, model: str, values: Mapping[str, float], given: Collection[str], terms: Mapping[str, str], seen: Seen
) -> list[str]:
    """What came out of a phase that its user may not expect; of an FMU from elsewhere as far as its names tell it.

    model         that the phase has, or whose place its FMU takes
    seen          gives the `Range` that an output had, None for one that is not there
    """
    return _spoken(phase, CAUTIONS[model].after(values, given, terms, seen)) if model in CAUTIONS else []


def implied(model: str, values: Mapping[str, float], terms: Mapping[str, str]) -> list[Implied]:
    """What the values of a model of ours come to, by the formulas that it computes with.

    values        every parameter and input by FMI name, SI
    """
    from fmu_src.net_capture import implied as of_net_capture
    from fmu_src.tethered_deorbit import implied as of_tethered_deorbit

    models = {NET_CAPTURE.name: of_net_capture, TETHERED_DEORBIT.name: of_tethered_deorbit}
    return list(models[model].rows(values, terms)) if model in models else []


def numerics(model: str) -> Sequence[str]:
    """Groups of a model of ours whose terms differ in how a thing is computed, not in what is computed."""
    return TRADES[model].NUMERICS if model in TRADES else ()


def beside(model: str) -> Sequence[str]:
    """Groups of that kind which are tried and told only where they are not the default."""
    return TRADES[model].BESIDE if model in TRADES else ()


def details(model: str) -> Sequence[str]:
    """Groups that are levels of detail: without one of their terms all is followed."""
    return TRADES[model].DETAILS if model in TRADES else ()


def rungs(model: str, values: Mapping[str, float], terms: Mapping[str, str]) -> list[Rung]:
    """Settings of the scheme that the terms name, coarse to fine; see `fmu_src.trade`."""
    return TRADES[model].rungs(values, terms) if model in TRADES else []


def by_tolerance(model: str) -> bool:
    """Whether the sizes of a model's settings are tolerances; else they are steps."""
    return TRADES[model].BY_TOLERANCE if model in TRADES else False


def whole(model: str, terms: Mapping[str, str]) -> bool:
    """Whether everything that a model of ours shows with these terms is meant, energies too."""
    return TRADES[model].whole(terms) if model in TRADES else True


def instead(model: str, terms: Mapping[str, str]) -> Mapping[str, str]:
    """Criteria that mean nothing of a model of ours with these terms, each with the one that is asked in its place."""
    return TRADES[model].instead(terms) if model in TRADES else {}


def reference(model: str, terms: Mapping[str, str]) -> Mapping[str, str]:
    """Terms of a model of ours with which a reference is computed, by group, where they are others."""
    return TRADES[model].reference(terms) if model in TRADES else {}


def within(model: str, values: Mapping[str, float], terms: Mapping[str, str]) -> Mapping[str, tuple[float, float]]:
    """Criteria that hold less closely with these terms of a model of ours: what counts as accurate and as stable."""
    return TRADES[model].within(values, terms) if model in TRADES else {}


def refinements(model: str, values: Mapping[str, float], terms: Mapping[str, str]) -> dict[str, list[Rung]]:
    """Settings that refine a model of ours itself, by name."""
    return TRADES[model].refinements(values, terms) if model in TRADES else {}


def extremes(model: str, terms: Mapping[str, str]) -> list[Extreme]:
    """Cases at the ends of the range of a model of ours with these terms: of its parts, and those of no part."""
    if model not in STRESSES:
        return []
    groups = CATALOGUE[model].groups
    of_parts = [one for group, term in terms.items() for one in groups[group].terms[term].extremes]
    return [*of_parts, *STRESSES[model].EXTREMES]


LEAP_REVOLUTIONS = tethered_deorbit_rows.REVOLUTIONS
"""Fewest revolutions that a tow of ours takes at once, between two communication points."""


def air_of(
    values: Mapping[str, float], terms: Mapping[str, str]
) -> Callable[[npt.NDArray[np.float64]], npt.NDArray[np.float64]] | None:
    """Function of altitudes [m]: the density of the air that a tow of ours has, in the mean [kg/m^3]; None without."""
    from fmu_src.tethered_deorbit.environment.air import mean_density

    return mean_density(values, terms)


def _spoken(phase: str, found: Iterable[Caution]) -> list[str]:
    """Cautions as a scene would name what they are about; the orbit is that of all phases."""
    return [f"{c.about if c.about.startswith('orbit.') else f'{phase}.{c.about}'}: {c.sentence}" for c in found]
