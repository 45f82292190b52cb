"""One table of variables per model, and everything that is derived from it.

A model's variables are declared once, as rows of `Variable`, grouped by the physics term that needs them. From the rows
follow the memory record the kernels work on, the FMI value references (a variable's slot in that record), the model
description, the keys a scene may say, and the table in the model's documentation. All values are SI.
"""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from fmu_src import tables
from fmu_src.extremes import Extreme
from fmu_src.tables import Table
from fmu_src.variables import INDEX as INDEX
from fmu_src.variables import Causality as Causality
from fmu_src.variables import Value as Value
from fmu_src.variables import Variable as Variable


@dataclass(frozen=True)
class Fault:
    """A reason for which a kernel may stop: its status code, FMI severity and text (what went wrong, what to try).

    severity        error; discard (a step may be tried again otherwise); end (the model's own end: nothing is wrong,
                    `fault_time` is when; where a part ends the run, the outputs are those of that instant)
    names_variable  `fault_index` is the value reference of the variable at fault; else it is zero or what the text says
    name            by which a part's kernels find the code that the model gave it
    blames          the variable it names, or its first component
    """

    code: int
    severity: Literal["discard", "error", "end"]
    text: str
    names_variable: bool = False
    name: str = ""
    blames: str = ""


def fault(name: str, blames: str, text: str) -> Fault:
    """An error of a part: the model that takes it in numbers it. `blames` is empty where no one value is at fault."""
    return Fault(0, "error", text, bool(blames), name, blames)


def numbered(faults: Iterable[Fault]) -> tuple[Fault, ...]:
    """Faults with codes from 1 on, in their order; each name once."""
    unlike = {f.name: f for f in faults}
    return tuple(replace(f, code=code) for code, f in enumerate(unlike.values(), 1))


class Laid(NamedTuple):
    """What a part makes of the tables that a scene gives it.

    tables       that its kernels read, by name
    parameters   that follow, SI by FMI name
    shown        numbers that pictures and reports are made of, and no kernel reads, by name
    """

    tables: Mapping[str, npt.NDArray[np.float64]]
    parameters: Mapping[str, float]
    shown: Mapping[str, npt.NDArray[np.float64]] = MappingProxyType({})


@dataclass(frozen=True)
class Term:
    """One physics term a scene may name: its variables, and a sentence on what it adds.

    variables   its rows; one of a name that the model has already takes that row's place
    needs    groups without a term of which it has nothing to act on
    excludes groups with any term of which it cannot go together;  because: why, and what to do, for a message
    carries  terms of other groups, by group, of which it goes with these alone
    lacks    variables that the model has otherwise, and that mean nothing with it
    states   outputs that are states with it: they begin with what their inputs say, and follow them over a step only
    faults   for which its kernels may stop
    tables   that its kernels read, each given when an FMU or an instance is made
    make     `make(composition)`: its kernels, as the model it is a part of asks for them
    checks   what the model asks of it before any build or run
    refuses  `refuses(scene)`: why it can not work with a scene's values, as the model it is a part of asks for it
    extremes cases at the ends of its range, on which schemes are tried
    asked    rows that a scene may say and no FMU has: from them `design` finds values of parameters
    design   `design(values, asked, terms)`: those values, SI by FMI name; `Undesigned` where there are none
    sources  tables that a scene gives and no FMU has: from them `lay` makes all of `tables`
    lay      `lay(values, sources)`: `Laid`; values with those of `asked` among them; `Undesigned` where it cannot
    follows  parameters that it finds: a scene does not say them
    """

    summary: str
    variables: tuple[Variable, ...] = ()
    needs: tuple[str, ...] = ()
    excludes: tuple[str, ...] = ()
    carries: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    lacks: tuple[str, ...] = ()
    states: tuple[str, ...] = ()
    faults: tuple[Fault, ...] = ()
    tables: tuple[Table, ...] = ()
    make: Callable[[Any], Any] | None = None
    checks: Any = None
    refuses: Callable[[Any], Iterable[Any]] | None = None
    extremes: tuple[Extreme, ...] = ()
    asked: tuple[Variable, ...] = ()
    design: Callable[[Mapping[str, float], Mapping[str, float], Mapping[str, str]], dict[str, float]] | None = None
    sources: tuple[Table, ...] = ()
    lay: Callable[[Mapping[str, float], Mapping[str, npt.NDArray[np.float64]]], Laid] | None = None
    follows: tuple[str, ...] = ()
    because: str = ""


class Undesigned(Exception):
    """No value of a parameter does what is asked.

    name       of the row at fault
    given      its value, as a person reads it
    expected   what would do
    """

    def __init__(self, name: str, given: str, expected: str) -> None:
        super().__init__(f"{name} = {given}: {expected}")
        self.name, self.given, self.expected = name, given, expected


@dataclass(frozen=True)
class Group:
    """Terms of which a scene names at most one, by the key `selector` of its table.

    optional     the scene may leave the group out; then nothing of it is in the FMU
    default      the term that is taken where the scene names none; then the table may be left out
    table        of the scene that has the selector; empty: that of the group's own name
    follows      `follows(terms, values)`: the term that follows from the other terms and the values, SI by FMI name,
                 where the scene has the table and names none
    early        it follows from the terms of the groups before it alone, and is known before any value is read
    sure         `sure(terms, values)`: whether it does; not from files that make no sense
    """

    terms: Mapping[str, Term]
    selector: str = "law"
    optional: bool = False
    follows: Callable[[Mapping[str, str], Mapping[str, float]], str] | None = None
    default: str = ""
    table: str = ""
    early: bool = False
    sure: Callable[[Mapping[str, str], Mapping[str, float]], bool] = lambda terms, values: True


HEAD = (
    Variable("work_size", "1", "state", "doubles of work memory this instance needs", kind="Integer"),
    Variable("fault_code", "1", "state", "code of the fault that stopped the kernel, 0 for none", kind="Integer"),
    Variable("fault_index", "1", "state", "value reference of the variable at fault", kind="Integer"),
    Variable("fault_time", "s", "state", "when"),
    Variable("fault_value", "1", "state", "offending value, SI"),
    Variable("tables", "1", "state", "identity of the tables, 0 for none", kind="Integer"),
    Variable("tables_at", "1", "state", "where they lie while the entry runs, 0 at all other times", kind="Integer"),
    Variable("terms", "1", "state", "unused; its name in the record tells one choice of terms from another"),
)
"""Every record begins with these; the C shim knows them by their place."""

SIZE, INITIALISE, STEP, REFRESH, DIFFERENTIATE, GO_ON = range(6)
"""Commands of a model's entry `entry(command, record, work, time, step) -> status`.

SIZE           set `work_size` from the parameters
INITIALISE     fill state and outputs from parameters; `time` is the start time [s]
STEP           advance from `time` by `step` [s]. An input whose rate is not zero is value + rate (t - time) on the way;
               the value it has reached is left in its slot, so that nothing jumps when the importer sets nothing, and
               the caller clears the rate. A step without rates is the same to the last bit as if there were none. A
               long one may be left with UNDER_WAY, at the time in `fault_time`: then it is to be called again
GO_ON          go on with the step under way, with its `time` and `step`; the result has the bits of one never left
REFRESH        called when an output is read after an input was set: recompute the outputs that depend directly on
               inputs, at `time`, as the next step will begin with them; the state stays, and so do the outputs when
               the inputs are as the last step left them
DIFFERENTIATE  called when a derivative is asked for: fill the states that `rate` of outputs and `partials` name, at
               `time`, for the inputs of now. They move at their rates; an input that is as a step with a rate has left
               it counts as going on at that rate, so that the derivatives at the end of a step are those of its end
"""
UNDER_WAY = -2
"""What the entry answers when a step is not done yet: success is 0, and faults are positive."""


@dataclass(frozen=True)
class Model:
    """What a model offers: its name, the variables it always has, its groups of terms, and its faults.

    stop_time, macro_step   a sensible experiment for tools that ask for one [s]
    differentiable          its outputs at the start change smoothly with every Real parameter: then derivatives of them
                            are offered, at the start by parameters and inputs, later by inputs
    """

    name: str
    summary: str
    base: tuple[Variable, ...]
    groups: Mapping[str, Group]
    faults: tuple[Fault, ...]
    module: str
    stop_time: float
    macro_step: float
    differentiable: bool = False

    def missing(self, terms: Mapping[str, str]) -> Iterator[tuple[str, str]]:
        """Each group whose term needs another group that is not there, and that group."""
        for group, term in terms.items():
            for needed in self.groups[group].terms[term].needs:
                if needed not in terms:
                    yield group, needed

    def clashing(self, terms: Mapping[str, str]) -> Iterator[tuple[str, str]]:
        """Each group whose term cannot go together with another group that is there, and that group."""
        for group, term in terms.items():
            for other in self.groups[group].terms[term].excludes:
                if other in terms:
                    yield group, other

    def unfit(self, terms: Mapping[str, str]) -> Iterator[tuple[str, str, tuple[str, ...]]]:
        """Each group whose term another group's does not carry, that group, and the terms that it does carry."""
        for group, term in terms.items():
            for other, carried in self.groups[group].terms[term].carries.items():
                if other in terms and terms[other] not in carried:
                    yield other, group, carried

    def interface(self, terms: Mapping[str, str]) -> Interface:
        """The interface of this model built with the given terms, `{group: term}`."""
        for group, term in terms.items():
            if group not in self.groups:
                raise ValueError(f"{self.name} has no group of terms {group!r}; it has {', '.join(self.groups)}")
            if term not in self.groups[group].terms:
                raise ValueError(f"{group} = {term!r}: expected one of {', '.join(self.groups[group].terms)}")
        terms = {name: group_.default for name, group_ in self.groups.items() if group_.default} | dict(terms)
        for name, group_ in self.groups.items():
            if not group_.optional and name not in terms:
                raise ValueError(f"{self.name} needs a choice of {name}: {', '.join(group_.terms)}")
        for group, needed in self.missing(terms):
            raise ValueError(f"{self.name}: {group} = {terms[group]!r} needs a choice of {needed}")
        for group, other in self.clashing(terms):
            raise ValueError(f"{self.name}: {group} = {terms[group]!r} cannot go together with {other}")
        ordered = {name: terms[name] for name in self.groups if name in terms}
        chosen = [self.groups[name].terms[term] for name, term in ordered.items()]
        lacking = {name for part in chosen for name in part.lacks}
        own = {v.name: v for part in chosen for v in part.variables if v.beside in {None, *ordered.items()}}
        rows = {v.name: v for v in HEAD + self.base if v.name not in lacking}
        variables = list((rows | own).values())
        inputs = {v.name for v in variables if v.causality == "input"}
        states = {output for name, term in ordered.items() for output in self.groups[name].terms[term].states}
        return Interface(self, ordered, tuple(_reduced(v, inputs, v.name in states) for v in variables))


def _reduced(v: Variable, inputs: Container[str], is_state: bool) -> Variable:
    """A row with the dependencies it has beside these inputs; those of a state hold at the start alone."""
    if not (v.partials or v.at_start):
        return v
    partials = tuple(p for p in v.partials if p[0] in inputs)
    at_start = tuple(name for name in v.at_start if name in inputs)
    if is_state:
        return replace(v, partials=(), at_start=tuple(name for name, _ in partials) + at_start)
    return replace(v, partials=partials, at_start=at_start)


def check_implemented(model: Model, implemented: Mapping[str, Container[str]], terms: Mapping[str, str]) -> None:
    """Refuse a term that is declared, but that the kernels do not know: they would take it for another, or for none.

    implemented   terms by group, as the kernels have them
    """
    for group, term in terms.items():
        if term not in implemented.get(group, ()):
            raise ValueError(f"{model.name}: no kernel implements {group} = {term!r}")


@dataclass(frozen=True)
class Interface:
    """The variables of one model with one choice of terms.

    given    numbers of its tables, of all or of none: what is built does not depend on them
    """

    model: Model
    terms: Mapping[str, str]
    variables: tuple[Variable, ...]
    given: Mapping[str, npt.NDArray[np.float64]] = field(default_factory=dict, compare=False)

    @cached_property
    def tables(self) -> tuple[Table, ...]:
        """Those of its terms, in order; ValueError if two of them share a name."""
        chosen = (self.model.groups[group].terms[term].tables for group, term in self.terms.items())
        every = dict.fromkeys(itertools.chain.from_iterable(chosen))
        found = tuple(t for t in every if t.beside is None or t.beside in self.terms.items())
        for name, count in Counter(table.name for table in found).items():
            if count > 1:
                raise ValueError(f"{self.model.name}: two parts bring a table {name}, and they differ")
        return found

    def with_tables(self, given: Mapping[str, npt.ArrayLike]) -> Interface:
        """The same variables with these tables; ValueError if one is missing, unknown, or can not be what it is for."""
        if not self.tables and not given:
            return self
        numbers = tables.numbers(self.tables, given, self.model.name)
        key = tables.identity(tables.block(self.tables, numbers))
        rows = tuple(replace(v, start=key) if v.name == "tables" else v for v in self.variables)
        return replace(self, variables=rows, given=numbers)

    @cached_property
    def asked(self) -> tuple[Variable, ...]:
        """Rows of its terms that a scene may say and no FMU has."""
        return tuple(v for group, term in self.terms.items() for v in self.model.groups[group].terms[term].asked)

    def demand_tables(self) -> None:
        """ValueError if it has tables, and was not given them."""
        tables.demand(self.tables, self.given, self.model.name)

    @cached_property
    def table_block(self) -> npt.NDArray[np.int64]:
        """Its tables as its kernels read them; ValueError if it has any, and was not given them."""
        self.demand_tables()
        return tables.block(self.tables, self.given)

    @cached_property
    def sources(self) -> tuple[Table, ...]:
        """Tables that a scene gives and its FMUs have not."""
        return tuple(t for group, term in self.terms.items() for t in self.model.groups[group].terms[term].sources)

    @cached_property
    def follows(self) -> frozenset[str]:
        """Parameters that parts find from those."""
        terms = (self.model.groups[group].terms[term] for group, term in self.terms.items())
        return frozenset(name for term in terms for name in term.follows)

    @cached_property
    def laid(self) -> frozenset[str]:
        """Names of its tables that a part makes of others."""
        parts = (self.model.groups[group].terms[term] for group, term in self.terms.items())
        return frozenset(table.name for part in parts if part.lay is not None for table in part.tables)

    @property
    def tables_identity(self) -> int:
        """0 where it has none, or was not given them."""
        return next(int(v.starts()[0]) for v in self.variables if v.name == "tables")

    @cached_property
    def dtype(self) -> np.dtype[np.void]:
        """Record of 8-byte slots: float64 for Real, int64 for Integer and Boolean.

        One field bears the terms' name: numba would otherwise take a longer record for a shorter one it begins with.
        """
        mark = "terms_" + "_".join(re.sub(r"\W", "", f"{group}_{term}") for group, term in self.terms.items())
        fields = [
            (mark if v.name == "terms" else v.field, "<f8" if v.kind == "Real" else "<i8", v.shape)
            for v in self.variables
        ]
        return np.dtype([(name, code, shape) if shape else (name, code) for name, code, shape in fields])

    @cached_property
    def references(self) -> dict[str, int]:
        """Value reference of every scalar at the interface: its slot in the record."""
        return {name: slot for name, slot, _, _ in self.scalars() if not name.startswith("@")}

    def scalars(self) -> Iterator[tuple[str, int, Variable, Value]]:
        """Name, slot, row and start value of every scalar; the name of a hidden one begins with @."""
        slot = 0
        for v in self.variables:
            for name, start in zip(v.element_names(), v.starts(), strict=True):
                yield (name if v.at_interface else "@" + name), slot, v, start
                slot += 1

    def starting(self, values: Mapping[str, Value]) -> Interface:
        """The same variables with other start values, SI by FMI name of a parameter or input.

        ValueError for a name that is none, or a value that its variable cannot have.
        """
        left, rows = dict(values), []
        for v in self.variables:
            starts = dict(zip(v.element_names(), v.starts(), strict=True))
            if v.causality in ("parameter", "input"):
                starts |= {name: v.typed(name, left.pop(name)) for name in starts if name in left}
            rows.append(replace(v, start=tuple(starts.values()) if v.shape else next(iter(starts.values()))))
        for name, value in left.items():
            raise ValueError(f"{name} = {value:g}: this {self.model.name} has no parameter or input of that name")
        return replace(self, variables=tuple(rows))

    def make_record(self) -> npt.NDArray[Any]:
        """A record with every start value, as an array of length 1."""
        record = np.zeros(1, self.dtype)
        for v in self.variables:
            if not v.at_interface:
                continue
            starts = v.starts()
            record[0][v.field] = np.reshape(starts, v.shape) if v.shape else starts[0]
        return record
