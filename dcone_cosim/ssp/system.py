"""From a package to a scene: the FMUs looked at, connectors and values checked against them, everything SI.

The scene has one phase. It is a capture or a removal when our own annotation says so or its main component offers what
`contract` asks of one; any other system is a phase by its own name, stepped from its start to its stop.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, cast

from dcone_cosim.component import Archive
from dcone_cosim.contract import HAND_OVER, NEVER
from dcone_cosim.coupling import Connection, Coupling
from dcone_cosim.errors import FmuError, InputError
from dcone_cosim.handoff import CAPTURE_OUTPUTS, REMOVAL_SETS
from dcone_cosim.names import did_you_mean
from dcone_cosim.scene import PHASES, ComponentScene, PhaseScene, Scene
from dcone_cosim.ssp.export import identifier
from dcone_cosim.ssp.markup import KINDS, STRUCTURE
from dcone_cosim.ssp.package import Mistakes, Package, entry_of, parsed, unpacked_folder
from dcone_cosim.ssp.parsing import ComponentRow, ConnectionRow, Document, PortRow, document
from dcone_cosim.ssp.units import Unit, units_of
from dcone_cosim.ssp.values import Given, given_values

RESERVED = (*PHASES, "nodes", "tugs", "ledger", "summary", "provenance", "removal_without_recoil_tugs")
"""Names of files in a run folder that a system's own name must not take."""
MOST_STEPS = 5_000_000
"""Macro steps of a phase: each leaves a row, and a run keeps all rows in memory."""


@dataclass(frozen=True)
class Part:
    """A component beside its FMU: variables by name as fmpy reads them, and the units they are in."""

    row: ComponentRow
    fmu: Path
    variables: Mapping[str, Any]
    units: Mapping[str, Unit]
    experiment: Any

    def unit(self, name: str) -> Unit | None:
        """Unit of a variable, None when it has none or one without base units."""
        return self.units.get(self.variables[name].unit or "")

    def si(self, name: str, value: float) -> float:
        unit = self.unit(name)
        return unit.to_si(value) if unit is not None else value

    def defaults(self) -> dict[str, float]:
        """Start value of every numeric parameter, SI."""
        found = {}
        for row in self.variables.values():
            if row.causality == "parameter" and row.type in KINDS and row.start is not None:
                start = float(row.start in ("true", "1", True)) if row.type == "Boolean" else float(row.start)
                found[row.name] = self.si(row.name, start)
        return found


def load(path: Path) -> Scene:
    """The scene that a package holds, checked; an `InputError` lists every mistake found."""
    mistakes = Mistakes(str(path))
    with Package(path) as package:
        text = package.read(STRUCTURE)
        root = parsed(text, STRUCTURE, mistakes)
        content = document(root, STRUCTURE, mistakes) if root is not None else None
        mistakes.check()
        assert content is not None
        folder = unpacked_folder()
        parts = _parts(content, package, Path(folder.name), mistakes)
        mistakes.check()
        for part in parts.values():
            _check_ports(part, content.units, mistakes)
        rows = [*(b for part in parts.values() for b in part.row.bindings), *content.bindings]
        values = list(given_values(iter(rows), package, mistakes))
    parameters = _parameters(values, parts, mistakes)
    connections = _connections(content.connections, parts, mistakes)
    mistakes.check()
    phase = _phase(content, parts, parameters, connections, mistakes)
    mistakes.check()
    # the unpacked FMUs are there for as long as the phase is
    phase = replace(phase, options={**phase.options, "unpacked": folder})
    return Scene(path.stem, content.description, text.decode("utf-8", "replace"), (phase,), {}, str(path))


def _parts(content: Document, package: Package, folder: Path, mistakes: Mistakes) -> dict[str, Part]:
    parts = {}
    for number, row in enumerate(content.components):
        entry, reason = entry_of(row.source, package.names)
        if reason:
            mistakes.add(STRUCTURE, row.line, f"<ssd:Component> {row.name!r}: {reason}")
            continue
        fmu = package.unpack(entry, folder, f"{number}-{identifier(Path(entry).stem)}")
        try:
            with Archive(fmu) as archive:
                about = archive.description
                variables = {v.name: v for v in about.modelVariables}
                parts[row.name] = Part(row, fmu, variables, units_of(about), about.defaultExperiment)
        except FmuError as error:
            said = str(error).replace(str(fmu), entry)
            mistakes.add(STRUCTURE, row.line, f"<ssd:Component> {row.name!r}: {said}")
    return parts


def _check_ports(part: Part, units: Mapping[str, Unit], mistakes: Mistakes) -> None:
    """Connectors that the FMU has not, or has otherwise."""
    for port in part.row.ports.values():
        what = f"connector {port.name!r} of {part.row.name!r}"
        variable = part.variables.get(port.name)
        if variable is None:
            mistakes.add(
                STRUCTURE, port.line, f"{what}: its FMU has no such variable{did_you_mean(port.name, part.variables)}"
            )
            continue
        if port.type and port.type != variable.type:
            mistakes.add(STRUCTURE, port.line, f"{what} is {port.type}; the FMU has it as {variable.type}")
        if port.kind != variable.causality:
            mistakes.add(
                STRUCTURE, port.line, f"{what} has kind = {port.kind!r}; in the FMU it is {variable.causality!r}"
            )
        _check_unit(port, part.unit(port.name), units, what, mistakes)


def _check_unit(port: PortRow, own: Unit | None, units: Mapping[str, Unit], what: str, mistakes: Mistakes) -> None:
    if not port.unit or own is None or port.unit == own.name:
        return
    told = units.get(port.unit)
    if told is None or (told.exponents, told.factor, told.offset) != (own.exponents, own.factor, own.offset):
        mistakes.add(STRUCTURE, port.line, f"{what} is in {port.unit!r}; the FMU has it in {own.name!r}")


def _parameters(values: list[Given], parts: Mapping[str, Part], mistakes: Mistakes) -> dict[str, dict[str, float]]:
    """Values by component and variable, SI."""
    found: dict[str, dict[str, float]] = {name: {} for name in parts}
    for given in values:
        owner, name = (given.owner, given.name) if given.owner else _owner(given.name, parts)
        if owner not in parts:
            hint = did_you_mean(given.name.partition(".")[0], parts)
            text = f"parameter {given.name!r} of the system: expected COMPONENT.NAME{hint}"
            mistakes.add(given.file, given.line, text)
            continue
        part = parts[owner]
        problem = _problem(given, name, part)
        if problem:
            mistakes.add(given.file, given.line, f"parameter {name!r} of {owner!r} {problem}")
        else:
            found[owner][name] = part.si(name, _in_own_unit(given, part.unit(name)))
    return found


def _owner(name: str, parts: Mapping[str, Part]) -> tuple[str, str]:
    """Component and variable of a name such as `reel.gain.proportional`; component names may have dots."""
    for part in sorted(parts, key=len, reverse=True):
        if name.startswith(f"{part}."):
            return part, name[len(part) + 1 :]
    return "", name


def _problem(given: Given, name: str, part: Part) -> str:
    """Why a value cannot be set, or ""."""
    row = part.variables.get(name)
    if row is None:
        return f"is no variable of its FMU{did_you_mean(name, part.variables)}"
    if row.type not in KINDS:
        return f"is of the type {row.type} in its FMU; expected {', '.join(KINDS)}"
    if row.type != given.type and (row.type, given.type) != ("Real", "Integer"):
        return f"is given as {given.type}; the FMU has it as {row.type}"
    if row.causality not in ("parameter", "input") and (row.start is None or row.variability == "constant"):
        return f"cannot be set: in the FMU it is {'a constant' if row.variability == 'constant' else row.causality}"
    own = part.unit(name)
    if given.unit is None or given.suppress or own is None or given.unit.name == own.name:
        return ""
    if given.unit.exponents == (99,) * 8:
        return f"is given in {given.unit.name!r}, which <ssv:Units> does not define"
    return "" if own.fits(given.unit) else f"is given in {given.unit.name!r}; the FMU has it in {own.name!r}"


def _in_own_unit(given: Given, own: Unit | None) -> float:
    """The value in the unit of its variable."""
    value = given.value
    if given.unit is not None and own is not None and not given.suppress and given.unit.name != own.name:
        value = own.from_si(given.unit.to_si(value))
    if (given.factor, given.offset) != (1.0, 0.0):
        value = given.factor * value + given.offset
    return value


def _connections(
    rows: tuple[ConnectionRow, ...], parts: Mapping[str, Part], mistakes: Mistakes
) -> tuple[Connection, ...]:
    made, taken = [], {}
    for row in rows:
        ports = []
        for element, connector in (row.start, row.end):
            problem = ""
            if element not in parts:
                problem = f"no component {element!r}{did_you_mean(element, parts)}"
            elif connector not in parts[element].row.ports:
                hint = did_you_mean(connector, parts[element].row.ports)
                problem = f"no connector {connector!r} of {element!r}{hint}"
            if problem:
                mistakes.add(STRUCTURE, row.line, f"connection: {problem}")
            else:
                ports.append((parts[element], parts[element].row.ports[connector]))
        if len(ports) < 2:
            continue
        # SSP has no direction in `start` and `end`: it follows from what the connectors are
        (source, out), (target, to) = ports if ports[0][1].kind == "output" else reversed(ports)
        what = f"connection {source.row.name}.{out.name} -> {target.row.name}.{to.name}"
        if (out.kind, to.kind) != ("output", "input"):
            mistakes.add(STRUCTURE, row.line, f"{what}: {out.kind} to {to.kind}; expected an output and an input")
        elif out.name not in source.variables or to.name not in target.variables:
            continue  # told with the connector
        elif (kinds := (source.variables[out.name].type, target.variables[to.name].type))[0] != kinds[1]:
            mistakes.add(STRUCTURE, row.line, f"{what}: {kinds[0]} to {kinds[1]}")
        elif (key := (target.row.name, to.name)) in taken:
            mistakes.add(STRUCTURE, row.line, f"{what}: the input is connected in line {taken[key]} already")
        else:
            taken[key] = row.line
            factor, offset = 1.0, 0.0
            if kinds[0] == "Real":
                units = source.unit(out.name), target.unit(to.name)
                if None not in units and not row.suppress and not units[0].fits(units[1]):  # type: ignore
                    names = f"{units[0].name!r} to {units[1].name!r}"  # type: ignore
                    mistakes.add(STRUCTURE, row.line, f"{what}: {names} cannot be converted")
                    continue
                factor, offset = _si_transformation(row, *units)
            elif (row.factor, row.offset) != (1.0, 0.0):
                mistakes.add(STRUCTURE, row.line, f"{what}: {kinds[0]}; a linear transformation is for Real")
                continue
            made.append(Connection(source.row.name, out.name, target.row.name, to.name, factor, offset))
    return tuple(made)


def _si_transformation(row: ConnectionRow, source: Unit | None, target: Unit | None) -> tuple[float, float]:
    """Factor and offset between the SI values of the ends of a connection.

    In the units of the ends t = factor s + offset, where s is in the target's unit already, or as it is when the
    conversion is suppressed.
    """
    to = target or Unit("1")
    of = (source or Unit("1")) if row.suppress else to
    factor = row.factor * to.factor / of.factor
    return factor, to.factor * row.offset + to.offset - factor * of.offset


def _phase(
    content: Document,
    parts: Mapping[str, Part],
    parameters: Mapping[str, Mapping[str, float]],
    connections: tuple[Connection, ...],
    mistakes: Mistakes,
) -> PhaseScene:
    plan = content.ours.get("Plan", {})
    name, main = _name_and_main(content, plan, parts)
    components = {
        part: ComponentScene(part, fmu=row.fmu, parameters=parameters[part], defaults=row.defaults())
        for part, row in parts.items()
    }
    start, duration = _times(content, plan, parts, mistakes)
    if name == PHASES[0] and start != 0.0:
        mistakes.add(STRUCTURE, None, f"startTime = {start!r}: a capture begins at 0")
    return PhaseScene(
        name,
        components[main],
        _macro_step(content, parts, duration, mistakes),
        duration,
        _options(name, plan, mistakes),
        tuple(row for part, row in components.items() if part != main),
        connections,
        _coupling(content.ours.get("Coupling", {}), mistakes),
        start=start,
    )


def _name_and_main(content: Document, plan: Mapping[str, str], parts: Mapping[str, Part]) -> tuple[str, str]:
    """Name of the phase, and the component that it is about: the first when none meets a contract."""
    main = plan.get("main", "")
    if main in parts and plan.get("name") in PHASES:
        return plan["name"], main
    for name, needs in ((PHASES[0], ("captured", *CAPTURE_OUTPUTS)), (PHASES[1], ("separation", *REMOVAL_SETS))):
        for part, row in parts.items():
            if all(need in row.variables for need in needs):
                return name, part
    name = identifier(content.name)
    return (f"{name}_system" if name in RESERVED else name), main if main in parts else next(iter(parts))


def _times(
    content: Document, plan: Mapping[str, str], parts: Mapping[str, Part], mistakes: Mistakes
) -> tuple[float, float]:
    """Start and duration [s]: of the system, or the longest experiment that an FMU of it has by default."""
    start = content.start or 0.0
    stop = content.stop
    if stop is None:
        stops = [_told(part.experiment, "stopTime") for part in parts.values()]
        stop = max((s for s in stops if s is not None), default=None)
    if stop is None:
        mistakes.add(STRUCTURE, None, "nothing tells when to stop; expected <ssd:DefaultExperiment stopTime=...>")
        return start, 1.0
    duration = stop - start
    told = _decimal(plan.get("duration"))
    if told is not None and start + told == stop:
        duration = told  # the difference of two times has lost its last bits
    if not (math.isfinite(duration) and math.isfinite(start) and duration > 0.0):
        mistakes.add(STRUCTURE, None, f"startTime = {start!r}, stopTime = {stop!r}: the stop must come after the start")
        return start, 1.0
    return start, duration


def _macro_step(content: Document, parts: Mapping[str, Part], duration: float, mistakes: Mistakes) -> float:
    """Communication step [s]: an annotation's, else the least that a component or its FMU asks for."""
    step = content.step
    if step is None:
        step = min((p.row.step for p in parts.values() if p.row.step is not None), default=None)
    if step is None:
        asked = [_told(part.experiment, "stepSize") for part in parts.values()]
        step = min((s for s in asked if s is not None), default=None)
    if step is None:
        text = "nothing tells the step size; expected <osp:FixedStepAlgorithm baseStepSize=...> in an annotation of "
        mistakes.add(STRUCTURE, None, f"{text}<ssd:DefaultExperiment>")
        return duration
    if not (math.isfinite(step) and step > 0.0):
        mistakes.add(STRUCTURE, None, f"the step size {step!r} must be positive")
    elif step > duration:
        mistakes.add(STRUCTURE, None, f"the step size {step:g} s is more than the {duration:g} s from start to stop")
    elif duration / step > MOST_STEPS:
        text = f"{duration:g} s in steps of {step:g} s makes {duration / step:.4g} steps; at most {MOST_STEPS:,}"
        mistakes.add(STRUCTURE, None, text)
    return step


def _told(experiment: Any, name: str) -> float | None:
    return _decimal(getattr(experiment, name, None)) if experiment is not None else None


def _decimal(text: object) -> float | None:
    try:
        return float(str(text)) if text is not None else None
    except ValueError:
        return None


def _options(name: str, plan: Mapping[str, str], mistakes: Mistakes) -> dict[str, Any]:
    if name != PHASES[0]:
        return {}
    hand_over = plan.get("hand_over", HAND_OVER[0])
    if hand_over not in HAND_OVER:
        expected = did_you_mean(hand_over, HAND_OVER)
        mistakes.add(STRUCTURE, None, f"<dcone:Plan> hand_over = {hand_over!r}{expected}")
    after = _decimal(plan.get("after_capture"))
    snapshots = [_decimal(text) for text in plan.get("snapshots", "").split()]
    return {
        "hand_over": hand_over if hand_over in HAND_OVER else NEVER,
        "after_capture": math.inf if after is None else after,
        "snapshots": [time for time in snapshots if time is not None],
    }


def _coupling(told: Mapping[str, str], mistakes: Mistakes) -> Coupling:
    """Coupling that our own annotation tells, otherwise the one there is by default."""
    plain = Coupling()
    numbers = {}
    for key in ("step", "tolerance", "smallest_step"):
        number = _decimal(told.get(key))
        if key in told and (number is None or not math.isfinite(number) or number < 0.0):
            mistakes.add(STRUCTURE, None, f"<dcone:Coupling> {key} = {told[key]!r}: expected a number")
        numbers[key] = getattr(plain, key) if number is None else number
    words = {}
    choices = {
        "method": ("gauss_seidel", "jacobi"),
        "control": ("fixed", "error"),
        "extrapolation": ("constant", "linear"),
    }
    for key, known in choices.items():
        words[key] = told.get(key, known[0])
        if words[key] not in known:
            mistakes.add(STRUCTURE, None, f"<dcone:Coupling> {key} = {words[key]!r}{did_you_mean(words[key], known)}")
    return Coupling(
        cast(Literal["jacobi", "gauss_seidel"], words["method"]),
        numbers["step"],
        cast(Literal["fixed", "error"], words["control"]),
        numbers["tolerance"],
        numbers["smallest_step"],
        cast(Literal["constant", "linear"], words["extrapolation"]),
    )


__all__ = ["InputError", "load"]
