"""Connections checked against the components they name, all mistakes told at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from dcone_cosim.coupling.options import Connection, Coupling
from dcone_cosim.errors import InputError
from dcone_cosim.fmu.steppable import Steppable, VariableInfo
from dcone_cosim.names import did_you_mean, nearest
from dcone_cosim.units import Unit, misfit

CARRIED = {
    ("Real", "Real"),
    ("Integer", "Integer"),
    ("Boolean", "Boolean"),
    ("Integer", "Real"),
    ("Boolean", "Integer"),
    ("Integer", "Boolean"),
}
"""Kinds of output and input between which a value can go."""


class End(Protocol):
    """What is asked of a variable at an end of a connection: its kind, and the unit its FMU counts it in."""

    @property
    def kind(self) -> str: ...
    @property
    def own(self) -> Unit: ...


@dataclass(frozen=True)
class Link:
    """A connection that has passed every check; `source` and `target` are places in the list of components.

    moves    the input can go on at a rate within a step
    """

    connection: Connection
    source: int
    target: int
    output: str
    input: str
    unit: str
    to_boolean: bool
    moves: bool

    def carried(self, value: float) -> float:
        """What the input gets when the output has this value."""
        if self.to_boolean:
            return float(value != 0.0)
        factor, offset = self.connection.factor, self.connection.offset
        return value if factor == 1.0 and offset == 0.0 else factor * value + offset


def wire(
    phase: str, instances: Sequence[str], components: Sequence[Steppable], connections: Sequence[Connection]
) -> list[Link]:
    """The links, in the order of the connections; an `InputError` tells everything that is wrong with them.

    phase        whose connections they are, for the message
    instances    names by which the connections know the components
    """
    place = {name: i for i, name in enumerate(instances)}
    mistakes, links = [], []
    taken: dict[tuple[str, str], Connection] = {}
    for connection in connections:
        found = [
            _end(connection.source, connection.output, "output", place, components),
            _end(connection.target, connection.input, "input", place, components),
        ]
        wrong = [text for _, text in found if text]
        output, into = (info for info, _ in found)
        if output is not None and into is not None and not wrong:
            wrong += filter(None, [mismatch(output.name, output, into.name, into)])
        before = taken.setdefault((connection.target, connection.input), connection)
        if before is not connection:
            wrong.append(f"{connection.target}.{connection.input} is set by {before.source}.{before.output} already")
        mistakes += [f"{connection}: {text}" for text in wrong]
        if output is None or into is None or wrong:
            continue
        source, target = place[connection.source], place[connection.target]
        real = output.kind == into.kind == "Real"
        links.append(
            Link(
                connection,
                source,
                target,
                output.name,
                into.name,
                output.unit,
                into.kind == "Boolean",
                real and components[target].can_interpolate,
            )
        )
    if mistakes:
        count = f"{len(mistakes)} mistake{'s' if len(mistakes) > 1 else ''}"
        raise InputError(f"connections of the {phase}: {count}\n  " + "\n  ".join(mistakes))
    return links


def order_of(phase: str, instances: Sequence[str], coupling: Coupling) -> list[int]:
    """Places of the components in the order in which Gauss-Seidel takes them."""
    if not coupling.order:
        return list(range(len(instances)))
    wrong = [f"there is no component {n!r}{did_you_mean(n, instances)}" for n in coupling.order if n not in instances]
    wrong += [f"{name} is missing" for name in instances if name not in coupling.order]
    wrong += [f"{n} stands there twice" for n in dict.fromkeys(coupling.order) if coupling.order.count(n) > 1]
    if wrong:
        raise InputError(f"coupling.order of the {phase} must name every component once: {'; '.join(wrong)}")
    return [instances.index(name) for name in coupling.order]


def _end(
    instance: str, name: str, causality: str, place: Mapping[str, int], components: Sequence[Steppable]
) -> tuple[VariableInfo | None, str]:
    """The variable at one end of a connection, or what is wrong with it."""
    if instance not in place:
        return None, f"there is no component {instance!r}{did_you_mean(instance, place)}"
    variables = components[place[instance]].variables
    fit = [v.name for v in variables.values() if v.causality == causality]
    info = variables.get(name)
    if info is None:
        close = nearest(name, fit)
        hint = f"; did you mean {close!r}?" if close else did_you_mean(name, variables)
        return None, f"{instance} has no variable {name!r}{hint}"
    if info.causality != causality:
        article = "an" if info.causality[0] in "aeiou" else "a"
        close = nearest(name, fit)
        hint = f"; the nearest {causality} is {close!r}" if close else ""
        return None, f"{instance}.{name} is {article} {info.causality}, not an {causality}{hint}"
    return info, ""


def mismatch(output_name: str, output: End, input_name: str, into: End) -> str:
    """Why a value cannot go from the one variable to the other, or ""; the one rule of scenes and runs."""
    if (output.kind, into.kind) not in CARRIED:
        kinds = f"{output_name} is {_kind(output)}, {input_name} is {_kind(into)}"
        return f"{kinds}: no value can go from the one to the other"
    why = misfit(output.own, into.own)
    return f"{output_name} is in {output.own.name}, {input_name} in {into.own.name}: {why}" if why else ""


def _kind(end: End) -> str:
    return f"an {end.kind}" if end.kind == "Integer" else f"a {end.kind}"
