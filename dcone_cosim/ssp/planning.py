"""How a phase is run: its name, times and step, and what our own annotation or the command line says beside them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Literal, cast

from dcone_cosim.coupling.options import Coupling
from dcone_cosim.errors import InputError
from dcone_cosim.names import did_you_mean
from dcone_cosim.phases import kind_of, kinds
from dcone_cosim.scene.expected import Expected, Unexpected, example_of
from dcone_cosim.scene.mistakes import Override
from dcone_cosim.scene.toml_lines import given_at
from dcone_cosim.scenes.keys import COMPONENT_KEYS, COUPLING_KEYS, MOST_STEPS, isolation, phase_keys
from dcone_cosim.ssp.export import identifier
from dcone_cosim.ssp.markup import STRUCTURE
from dcone_cosim.ssp.matching import PackageComponent, owner_of
from dcone_cosim.ssp.package import Mistakes
from dcone_cosim.ssp.parsing import Document, decimal

RESERVED = (
    *kinds(),
    "nodes",
    "replay_nodes",
    "replay_threads",
    "tugs",
    "ledger",
    "summary",
    "provenance",
    "removal_without_recoil_tugs",
)
"""Names of files in a run folder that a system's own name must not take."""

SETTINGS = {"solver_tolerance": COMPONENT_KEYS["solver_tolerance"]}
"""What the command line may say of any phase, beside its times, what its kind has, and the values of its components."""
OF_COMPONENT = {key: COMPONENT_KEYS[key] for key in ("isolate", "timeout")}
"""What it may say of how a component is run, unless its FMU has a variable of that name."""


def name_and_main(content: Document, parts: Mapping[str, PackageComponent]) -> tuple[str, str]:
    """Name of the phase, and the component that it is about: the first when none meets a contract."""
    plan = content.ours.get("Plan", {})
    main = plan.get("main", "")
    if main in parts and plan.get("name") in kinds():
        return plan["name"], main
    for name, kind in kinds().items():
        for part, row in parts.items():
            if kind.recognised_by and all(name in row.variables for name in kind.recognised_by):
                return name, part
    name = identifier(content.name)
    return (f"{name}_system" if name in RESERVED else name), main if main in parts else next(iter(parts))


def settings_of(
    document: Mapping[str, Any], arguments: Sequence[Override], phase: str, parts: Mapping[str, PackageComponent]
) -> tuple[dict[str, float], dict[str, dict[str, float]], dict[str, dict[str, float | str]]]:
    """What `--set` says of the phase, of how its components are run, and the values it gives them, SI, and texts.

    document     values of `PHASE.macro_step`, `COMPONENT.isolate`, `COMPONENT.VARIABLE`
    arguments    where they are in it
    """
    of_phase = SETTINGS | {key: known for key, known in phase_keys(phase).items() if not known.size}
    told: dict[str, float] = {}
    run: dict[str, dict[str, float]] = {}
    values: dict[str, dict[str, float | str]] = {}
    for argument in arguments:
        given = given_at(document, argument.path)
        name = ".".join(map(str, argument.path))
        head, _, key = name.partition(".")
        try:
            if head == phase and key in of_phase:
                told[key] = cast(float, of_phase[key].read(given))
                continue
            owner, variable = owner_of(name, parts)
            if not owner:
                raise Unexpected(f"is not a variable of a component{did_you_mean(head, [phase, *parts])}")
            info = parts[owner].variables.get(variable)
            if info is None and variable in OF_COMPONENT:
                run.setdefault(owner, {})[variable] = cast(float, OF_COMPONENT[variable].read(given))
                continue
            if info is None or info.causality not in ("parameter", "input"):
                known = [n for n, v in parts[owner].variables.items() if v.causality in ("parameter", "input")]
                raise Unexpected(f"is not a parameter or an input of its FMU{did_you_mean(variable, known)}")
            example = example_of(info.start or 0.0, info.unit)
            expected = Expected(
                info.unit, info.kind, 0, (), example, info.minimum, info.maximum, relative=info.own.relative
            )
            values.setdefault(owner, {})[variable] = cast(float | str, expected.read(given))
        except Unexpected as error:
            link = " " if str(error).startswith(("is ", "must ")) else ": "
            raise InputError(f"--set {argument.argument}: {name}{link}{error}") from None
    for owner, options in run.items():
        if "timeout" in options and not isolation(options):
            raise InputError(f"--set {owner}.timeout: only calls to an isolated FMU have a limit; it is not isolated")
    return told, run, values


def times(
    content: Document, parts: Mapping[str, PackageComponent], told: Mapping[str, float], mistakes: Mistakes
) -> tuple[float, float]:
    """Start and duration [s]: of the system, or of the experiments that its FMUs have by default, from the first start
    to the last stop."""
    start, stop = content.start, content.stop
    if start is None:
        starts = [_of_experiment(part.experiment, "startTime") for part in parts.values()]
        start = min((s for s in starts if s is not None), default=0.0)
    if "duration" in told:
        return start, told["duration"]
    if stop is None:
        stops = [_of_experiment(part.experiment, "stopTime") for part in parts.values()]
        stop = max((s for s in stops if s is not None), default=None)
    if stop is None:
        mistakes.add(STRUCTURE, None, "nothing tells when to stop; expected <ssd:DefaultExperiment stopTime=...>")
        return start, math.inf
    ours = decimal(content.ours.get("Plan", {}).get("duration"))
    # the difference of two times has lost its last bits
    duration = ours if ours is not None and start + ours == stop else stop - start
    if not (math.isfinite(duration) and duration > 0.0):
        mistakes.add(STRUCTURE, None, f"startTime = {start!r}, stopTime = {stop!r}: the stop must come after the start")
        return start, math.inf
    return start, duration


def macro_step(
    content: Document,
    parts: Mapping[str, PackageComponent],
    duration: float,
    told: Mapping[str, float],
    mistakes: Mistakes,
) -> float:
    """Communication step [s]: of an annotation, else the least that a component or its FMU asks for."""
    asked = [told.get("macro_step", _own_macro_step(content))]
    if asked == [None]:
        asked = [part.step for part in parts.values()]
    if asked == [None] * len(asked):
        asked = [_of_experiment(part.experiment, "stepSize") for part in parts.values()]
    step = min((s for s in asked if s is not None), default=None)
    if step is None:
        text = "nothing tells the step size; expected <osp:FixedStepAlgorithm baseStepSize=...> in an annotation of "
        mistakes.add(STRUCTURE, None, f"{text}<ssd:DefaultExperiment>, or --set PHASE.macro_step=...")
        return 1.0
    if not (math.isfinite(step) and step > 0.0):
        mistakes.add(STRUCTURE, None, f"the step size {step!r} must be positive")
    elif step > duration:
        mistakes.add(STRUCTURE, None, f"the step size {step:g} s is more than the {duration:g} s from start to stop")
    elif math.isfinite(duration) and duration / step > MOST_STEPS:
        text = f"{duration:g} s in steps of {step:g} s makes {duration / step:.4g} steps; at most {MOST_STEPS:,}"
        mistakes.add(STRUCTURE, None, text)
    return step


def _own_macro_step(content: Document) -> float | None:
    """The step of the annotations; where that is still our coupling step, the macro step it divides."""
    coupled = decimal(content.ours.get("Coupling", {}).get("step"))
    if content.step is None or content.step != coupled:
        return content.step
    own = decimal(content.ours.get("Plan", {}).get("macro_step"))
    return content.step if own is None else own


def _of_experiment(experiment: Any, name: str) -> float | None:
    return decimal(getattr(experiment, name, None)) if experiment is not None else None


def options(name: str, plan: Mapping[str, str], told: Mapping[str, float], mistakes: Mistakes) -> Any:
    """What concerns the master of a phase: as the command line tells, otherwise as our own annotation does."""
    kind, found = kind_of(name), dict[str, Any](told)
    for key, known in kind.keys.items():
        text = plan.get(key)
        if key in found or text is None:
            continue
        numbers = [decimal(part) for part in text.split()]
        if known.choices:
            if text not in known.choices:
                mistakes.add(STRUCTURE, None, f"<dcone:Plan> {key} = {text!r}{did_you_mean(text, known.choices)}")
                continue
            found[key] = known.choices.index(text)
        elif None in numbers or not (known.size or len(numbers) == 1):
            mistakes.add(STRUCTURE, None, f"<dcone:Plan> {key} = {text!r}: expected {known.unit} as a number")
        else:
            found[key] = numbers if known.size else numbers[0]
    return kind.options({key: value for key, value in found.items() if key in kind.keys}, None)


def coupling(told: Mapping[str, str], parts: Mapping[str, PackageComponent], mistakes: Mistakes) -> Coupling:
    """Coupling that our own annotation tells, otherwise the one there is by default."""
    plain = Coupling()
    numbers = {}
    for key in ("step", "tolerance", "smallest_step"):
        number = decimal(told.get(key))
        if key in told and (number is None or not math.isfinite(number) or number < 0.0):
            mistakes.add(STRUCTURE, None, f"<dcone:Coupling> {key} = {told[key]!r}: expected a number, not negative")
        numbers[key] = getattr(plain, key) if number is None else number
    words = {}
    for key in ("method", "control", "extrapolation"):
        known = COUPLING_KEYS[key].choices
        words[key] = told.get(key, known[0])
        if words[key] not in known:
            mistakes.add(STRUCTURE, None, f"<dcone:Coupling> {key} = {words[key]!r}{did_you_mean(words[key], known)}")
    order = tuple(told.get("order", "").split())
    if order and sorted(order) != sorted(parts):
        mistakes.add(STRUCTURE, None, f"<dcone:Coupling> order = {' '.join(order)!r}: expected every component once")
    return Coupling(
        cast(Literal["jacobi", "gauss_seidel"], words["method"]),
        numbers["step"],
        cast(Literal["fixed", "error"], words["control"]),
        numbers["tolerance"],
        numbers["smallest_step"],
        cast(Literal["constant", "linear"], words["extrapolation"]),
        order,
    )
