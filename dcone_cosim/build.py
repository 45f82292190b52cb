"""The one door to our own models: what a scene may say of them, and their FMUs, built on demand and cached.

No other module of this package knows `fmu_src`: everything else works on an FMU's file and its model description.
"""

from __future__ import annotations

import os
import time as clock
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from dcone_cosim.cache import Times
from dcone_cosim.errors import FmuError, InputError
from dcone_cosim.names import did_you_mean
from dcone_cosim.scratch import Scratch, clear_left
from fmu_src.catalogue import MODELS as CATALOGUE
from fmu_src.cautions import Caution, Range, Seen
from fmu_src.extremes import Extreme
from fmu_src.implied import Implied
from fmu_src.interface import Group, Interface, Laid, Model, Term, Undesigned, Value, Variable
from fmu_src.lines import Line
from fmu_src.net_capture import cautions as net_capture_cautions
from fmu_src.net_capture import force_map
from fmu_src.net_capture import lines as net_capture_lines
from fmu_src.net_capture import stress as net_capture_stress
from fmu_src.net_capture import trade as net_capture_trade
from fmu_src.net_capture.capacity import FAMILIES
from fmu_src.net_capture.entered import over_time as energy_entered
from fmu_src.net_capture.interface import MODEL as NET_CAPTURE
from fmu_src.net_capture.interface import NETS, TARGETS, rigged_of
from fmu_src.packaging.c_header import STATE_HEAD
from fmu_src.packaging.description import Experiment
from fmu_src.packaging.sources import SHIM
from fmu_src.tables import Table, from_files
from fmu_src.tethered_deorbit import cautions as tethered_deorbit_cautions
from fmu_src.tethered_deorbit import lines as tethered_deorbit_lines
from fmu_src.tethered_deorbit import optional_rows as tethered_deorbit_rows
from fmu_src.tethered_deorbit import stress as tethered_deorbit_stress
from fmu_src.tethered_deorbit import trade as tethered_deorbit_trade
from fmu_src.tethered_deorbit.interface import MODEL as TETHERED_DEORBIT
from fmu_src.tethered_deorbit.surfaces import SURFACES
from fmu_src.tethered_deorbit.surfaces.hull import CORNERS
from fmu_src.trade import Rung
from orbital.corners import few_corners

__all__ = [
    "CATALOGUE",
    "FAMILIES",
    "STATE_HEAD",
    "Experiment",
    "Extreme",
    "Group",
    "Implied",
    "Interface",
    "Line",
    "Model",
    "Range",
    "Rung",
    "Table",
    "Variable",
    "energy_entered",
    "from_files",
]

CAUTIONS = {NET_CAPTURE.name: net_capture_cautions, TETHERED_DEORBIT.name: tethered_deorbit_cautions}
"""What a model has to say of a run, by its name."""

LINES = {NET_CAPTURE.name: net_capture_lines.LINES, TETHERED_DEORBIT.name: tethered_deorbit_lines.LINES}
"""The lines of a model, by its name."""

TRADES = {NET_CAPTURE.name: net_capture_trade, TETHERED_DEORBIT.name: tethered_deorbit_trade}
"""How a model trades accuracy for time, by its name."""

STRESSES = {NET_CAPTURE.name: net_capture_stress, TETHERED_DEORBIT.name: tethered_deorbit_stress}
"""Ends of the range that belong to no part of a model, by its name."""
PAGE = "wasm32"
"""The platform of FMUs that a page runs, for `write_fmus`."""
SETTABLE = ("parameter", "input")
"""Causality of what a scene may give a value: an input keeps it from the start."""


Drawing = tuple[list[list[int]], list[int]]
Surface = tuple[list[Sequence[float]], list[list[int]]]


@dataclass(frozen=True)
class Furnished:
    """An FMU of ours to be written for others, with values of its own.

    name          of its file, without suffix
    values        that it starts with where they are not the model's, SI by FMI name of a parameter or input
    experiment    the run that it is for
    tables        numbers of each table of its parts, by name
    """

    name: str
    model: str
    terms: Mapping[str, str]
    values: Mapping[str, float]
    experiment: Experiment
    tables: Mapping[str, Any] = field(default_factory=dict, compare=False)


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


def target_distance(
    values: Mapping[str, float], terms: Mapping[str, str]
) -> Callable[[Mapping[str, float], Sequence[float]], float] | None:
    """Function of values and a point in body axes [m]: its distance from the target's surface, negative inside [m];
    None for a target that is none of ours."""
    part = _part(TARGETS, terms.get("target"), values)
    return None if part is None else part.checks.distance


def mouth_sides(values: Mapping[str, float], terms: Mapping[str, str]) -> list[float]:
    """Sides of the mouth as meant, each from a bullet to the next [m]; none for a net that is none of ours."""
    part = _net(values, terms)
    return [] if part is None else list(part.checks.sides(values))


def shot_frame(values: Mapping[str, float]) -> tuple[Any, Any]:
    """Muzzle [m] and axes as rows (two transverse, then the shot's own) of the frame that a shot is measured in."""
    from types import SimpleNamespace

    from fmu_src.implied import formula
    from fmu_src.net_capture.shot import aim

    given = {
        name.replace(".", "_"): np.array([values[f"{name}[{axis}]"] for axis in (1, 2, 3)])
        for name in ("chaser.start_position", "shot.axis")
    }
    record = SimpleNamespace(
        **given, shot_roll=values["shot.roll"], axes=np.zeros(9), muzzle=np.zeros(3), scratch=np.zeros(9)
    )
    formula(aim)(record)  # type: ignore[no-untyped-call]
    return record.muzzle, record.axes.reshape(3, 3)


def net_drawing(values: Mapping[str, float], terms: Mapping[str, str]) -> Drawing | None:
    """Lines of threads and leads, and the closed rim of the net with these values, as numbers of nodes; None for none
    of ours."""
    part = _net(values, terms)
    if part is None:
        return None
    lines, rim = part.checks.drawing(values)
    added = (line for rig in rigged_of(terms).values() for line in rig.checks.lines(values, part.checks))
    return [*lines, *added], rim


def target_surface(values: Mapping[str, float], terms: Mapping[str, str]) -> Surface | None:
    """Corners (n, 3) [m] and faces of the target with these values, body axes; None for none of ours."""
    part = _part(TARGETS, terms.get("target"), values)
    return None if part is None else part.checks.surface(values)


def towed_surface(term: str) -> str:
    """The surface that a target of ours with this shape has where it is towed: its own, or that of a hull."""
    return term if term not in TARGETS or term in SURFACES else "hull"


def hull_corners(values: Mapping[str, Any], terms: Mapping[str, str]) -> tuple[dict[str, float], float]:
    """Corners of the hull that a target of ours is towed as, by the removal's names, body axes [m], and how far the
    target reaches beyond that hull at most [m]; none for one that is towed with its own surface."""
    surface = target_surface(values, terms) if towed_surface(terms.get("target", "")) == "hull" else None
    if surface is None:
        return {}, 0.0
    corners, short = few_corners(np.array(surface[0], dtype=float), CORNERS)
    filled = np.vstack([corners, np.repeat(corners[-1:], CORNERS - len(corners), axis=0)])
    names = ((f"target.corner_{axis}[{k + 1}]", k, i) for i, axis in enumerate("xyz") for k in range(CORNERS))
    return {name: float(filled[k, i]) for name, k, i in names}, short


def force_cells(values: Mapping[str, float], terms: Mapping[str, str]) -> list[list[float]] | None:
    """Middles of the cells of a force map in body axes [m], in the order of its outputs; None for a target that is none
    of ours."""
    part = _part(TARGETS, terms.get("target"), values)
    if part is None:
        return None
    return [force_map.centre_of(number, part.checks.half(values)) for number in range(force_map.NUMBER)]


def _net(values: Mapping[str, float], terms: Mapping[str, str]) -> Term | None:
    """The net of a scene, or of an FMU in a file; None for one that is none of ours."""
    return _part(NETS, terms.get("net"), values) if "net" in terms or "net.mesh" in values else None


def _part(parts: Mapping[str, Term], term: str | None, values: Mapping[str, float]) -> Term | None:
    """The part that a scene names; of a capture FMU in a file, which names none, that with the most parameters of its
    own among those all of whose own it has. What a part's tables hold such a file does not tell."""
    if term is not None:
        return parts[term]
    names = {
        key: {n for v in part.variables if v.causality == "parameter" for n in v.element_names()}
        for key, part in parts.items()
        if not part.tables
    }
    shared = set.intersection(*names.values())
    known = [key for key, wanted in names.items() if wanted - shared <= values.keys() and parts[key].lay is None]
    return parts[max(known, key=lambda key: len(names[key]))] if known else None


def masses_after(capture: Mapping[str, float], terms: Mapping[str, str]) -> dict[str, float]:
    """Masses of the pair [kg] that a capture of ours with these values hands over, by the removal's names."""
    from fmu_src.net_capture.implied import catch_mass

    if "target.mass" not in capture:
        return {}
    return {"chaser.mass": capture["chaser.mass"], "target.mass": capture["target.mass"] + catch_mass(capture, terms)}


def line_mass(removal: Mapping[str, float], terms: Mapping[str, str]) -> float:
    """Mass of the nodes of a tow's line [kg]; 0 of a massless one."""
    from fmu_src.tethered_deorbit.nodes.cost import cost

    return cost({"reel.length_offset": 0.0, **removal}).mass if "lumped" in terms else 0.0


def shared_with_template() -> dict[str, str]:
    """The files of our own FMI interface that an FMU from the C template has as well, by name."""
    return {name: (SHIM / name).read_text(encoding="utf-8") for name in ("fmi2_log.h", "fmi2_absent.h")}


def _spoken(phase: str, found: Iterable[Caution]) -> list[str]:
    """Cautions as a scene would name what they are about; the orbit is that of all phases."""
    return [f"{c.about if c.about.startswith('orbit.') else f'{phase}.{c.about}'}: {c.sentence}" for c in found]


def cache_folder() -> Path:
    """Where built FMUs are kept: `DCONE_CACHE`, or the user's cache folder."""
    given = os.environ.get("DCONE_CACHE")
    if given:
        return Path(given)
    import platformdirs

    return Path(platformdirs.user_cache_dir("dcone"))


def fault(path: Path) -> str:
    """What is wrong with a file of the cache, in words that follow "is"; "" for nothing."""
    from fmu_src.packaging.kept import fault

    return fault(path)


def is_ours(library: Path) -> bool:
    """Whether the binary of an FMU's file was built by this program: it is alone in its folder, and the cache, where
    nobody else puts anything, has the same. What the file says of itself proves nothing: anybody can write that."""
    from fmu_src.packaging.kept import holds

    return list(library.parent.iterdir()) == [library] and holds(cache_folder(), library)


def _built(interfaces: Sequence[Interface], announce: Callable[[str], None], platforms: Sequence[Any] = ()) -> Any:
    """Paths of the FMUs of each interface, one per platform, this machine's alone if none is named.

    Before a build begins it is told how long it took before; how long it takes is kept.
    """
    from fmu_src.packaging.builds import build_all
    from fmu_src.packaging.platforms import host
    from fmu_src.packaging.tools import BuildError

    clear_left(cache_folder())  # nothing else looks there when all is built already
    announced: list[str] = []
    began, times = clock.perf_counter(), Times(cache_folder())

    def tell(text: str) -> None:
        if text.startswith("building") and not announced:
            announced.append(text)
            text = f"{text}; {times.spoken()}"
        announce(text)

    try:
        built = build_all(interfaces, cache_folder(), tell, list(platforms) or [host()], Scratch)
    except BuildError as error:
        raise FmuError(str(error)) from None
    if announced and not platforms:
        times.keep(clock.perf_counter() - began)
    return built


def ensure(wanted: Sequence[tuple[str, Mapping[str, str]]], announce: Callable[[str], None]) -> list[Path]:
    """Path of the FMU of each model with its terms; those that the cache has not are built side by side, each once."""
    keys = [(model, tuple(terms.items())) for model, terms in wanted]
    unlike = list(dict.fromkeys(keys))
    built = _built([CATALOGUE[model].interface(dict(terms)) for model, terms in unlike], announce)
    paths = {key: path for key, (path,) in zip(unlike, built, strict=True)}
    return [paths[key] for key in keys]


def platform_names(text: str) -> tuple[str, ...]:
    """Platforms by the names the command line gives, `all` or a list with commas; InputError if one is unknown."""
    from fmu_src.packaging.platforms import PLATFORMS

    if text == "all":
        return tuple(PLATFORMS)
    names = dict.fromkeys(name.strip() for name in text.split(","))
    for name in names:
        if name not in PLATFORMS:
            expected = f"expected all, or some of {', '.join(PLATFORMS)}"
            raise InputError(
                f"--platforms {text}: {name!r} is not a platform; {expected}{did_you_mean(name, PLATFORMS)}"
            )
    return tuple(names)


def write_fmus(
    wanted: Sequence[Furnished], platforms: Sequence[str], folder: Path, announce: Callable[[str], None]
) -> list[Path]:
    """Write FMUs to a folder, each with its values and for all platforms named; InputError for values it cannot have.

    With no platforms named they are for this machine. Linux on arm64 has archives of its own too. Values cost no build:
    the libraries are those of the cache.
    """
    from fmu_src.packaging.builds import furnish
    from fmu_src.packaging.platforms import KNOWN, archives, host

    chosen = [KNOWN[name] for name in platforms] or [host()]
    interfaces = [_furnished(fmu) for fmu in wanted]
    keys = [(fmu.model, tuple(fmu.terms.items())) for fmu in wanted]
    unlike = list(dict.fromkeys(keys))
    built = _built([CATALOGUE[model].interface(dict(terms)) for model, terms in unlike], announce, platforms and chosen)
    libraries = dict(zip(unlike, built, strict=True))
    written = []
    for fmu, key, interface in zip(wanted, keys, interfaces, strict=True):
        of = dict(zip(chosen, libraries[key], strict=True))
        for ending, together in archives(chosen):
            written.append(folder / f"{fmu.name}{ending}.fmu")
            taken = {of[platform]: folders for platform, folders in together.items()}
            furnish(taken, interface, fmu.experiment, written[-1])
    return written


def with_tables(fmu: Path, model: str, terms: Mapping[str, str], tables: Mapping[str, Any], folder: Path) -> Path:
    """An FMU of the cache written once more to a folder, with the tables of its parts."""
    from fmu_src.packaging.builds import furnish
    from fmu_src.packaging.platforms import host

    interface = CATALOGUE[model].interface(terms).with_tables(tables)
    places = [place.folder for place in host().places]
    furnish({fmu: places}, interface, Experiment.of(interface.model), folder / fmu.name)
    return folder / fmu.name


def _furnished(fmu: Furnished) -> Interface:
    try:
        return CATALOGUE[fmu.model].interface(fmu.terms).with_tables(fmu.tables).starting(fmu.values)
    except ValueError as error:
        raise InputError(f"{fmu.name}.fmu cannot start with the values it is to have: {error}") from None


def printable(text: str) -> str:
    """A text as XML and a page can hold it, whatever the name of a file may be."""
    return "".join(c if c.isprintable() else "?" for c in text)
