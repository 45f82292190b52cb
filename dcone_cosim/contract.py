"""What the master expects of the FMU of each phase, by variable name; anything that offers it can be swapped in."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Collection, Container, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import count, takewhile
from typing import TYPE_CHECKING, Literal, Protocol

from dcone_cosim.fmu.steppable import VariableInfo
from dcone_cosim.names import nearest
from dcone_cosim.units import PURE, Unit, by_name, misfit, spoken_dimension

if TYPE_CHECKING:
    from dcone_cosim.fmu.archive import Archive

OUTCOMES = ("flying", "captured", "settled", "missed", "slipped_off", "not_closed", "tether_taut")
"""Meaning of the capture's Integer output `outcome`."""

FAILED_OUTCOMES = frozenset({"missed", "slipped_off", "not_closed", "tether_taut"})
"""Outcomes after which the capture phase ends without a hand-off."""

HAND_OVER = ("captured", "settled", "tether_taut", "none")
"""When the capture hands over: at capture, once the net is settled, or captured and the tether paid out; never."""

NEVER = "none"
"""Choice of `HAND_OVER` for a capture phase that is flown to its end, whatever becomes of the net."""

FLOWN = "flown"
"""Outcome of such a phase when its FMU has none to tell."""

ENDED = "ended"
"""Outcome of a phase whose FMU came to an end of its own, by fmi2Discard and fmi2Terminated."""

HANDED_OVER = "handed_over"
"""Name of the choice of `start.condition` under which the removal takes the state it is given."""

NODE_PREFIX = "node["
THREAD_PREFIX = "thread["
TUG_PREFIX = "tug["
TUG_FIELDS = ("time", "peak", "speed")


@dataclass(frozen=True)
class Extreme:
    """An output that is the largest or least of something over the FMU's last step.

    choose    how those of several steps become that of all
    of        the output that tells it for the instant itself, "" for none; a row takes in the value at its end, which
              an input set there may have moved
    """

    choose: Callable[[float, float], float]
    of: str = ""


EXTREMES: Mapping[str, Extreme] = {
    "tether.tension_peak": Extreme(max, "tether.tension"),
    "tether.tension_least": Extreme(min, "tether.tension"),
    "thread.tension_peak": Extreme(max),
    "cord.tension_peak": Extreme(max),
}

Need = Literal["always", "hand-over", "take-over", "captured", "settled", "tether_taut", "slack", "spin", "optional"]
NEEDS: Mapping[str, str] = {
    "always": "always",
    "hand-over": "to hand over to the next phase",
    "take-over": "to take over from the phase before",
    "captured": "to hand over, unless hand_over says otherwise",
    "settled": 'for hand_over = "settled"',
    "tether_taut": 'for hand_over = "tether_taut"',
    "slack": "to be handed the line as it is; without it the line handed over is longer by as much",
    "spin": "to be handed the spin; without it the target is a point, and taken only where a bound allows",
    "optional": "reported if it is there",
}
"""What a variable is needed for."""
OPTIONAL = ("slack", "spin", "optional")
"""Needs without which an FMU can be swapped in all the same."""


@dataclass(frozen=True)
class Asked:
    """One variable that the master looks for in the FMU of a phase.

    unit      SI unit of its dimension; the FMU may count in any other of the same
    need      what it is needed for (see `NEEDS`)
    start     a sensible value of a parameter, SI
    """

    name: str
    kind: str
    unit: str
    causality: str
    meaning: str
    need: Need
    start: float

    def needed(self, takes_over: bool, hands_over: Collection[str], hand_over: str) -> bool:
        if self.need == "spin":
            return False
        if self.need == "always" or self.name in hands_over:
            return True
        if self.need == "take-over":
            return takes_over
        if self.need == "captured":
            return hand_over in ("captured", "tether_taut")
        return self.need == hand_over


class Wanting(Protocol):
    """A kind of phase, as far as it wants variables of its FMU, by what they are needed for."""

    @property
    def model(self) -> str: ...
    @property
    def wanted(self) -> Sequence[tuple[Need, Sequence[str]]]: ...
    def __hash__(self) -> int: ...


@cache
def asked(kind: Wanting) -> tuple[Asked, ...]:
    """The interface of the FMU of a kind of phase; unit and meaning are those of our own model of it."""
    from dcone_cosim.build import known_variables

    known = known_variables(kind.model)
    rows = []
    for need, names in kind.wanted:
        for name in names:
            v, start = known[name]
            meaning = v.description
            if v.choices:
                meaning += ": " + ", ".join(f"{i} {choice}" for i, choice in enumerate(v.choices))
            rows.append(Asked(name, v.kind, v.unit, v.causality, meaning, need, float(start)))
    return tuple(rows)


def check_contract(
    archive: Archive,
    kind: Wanting,
    takes_over: bool = False,
    hands_over: Collection[str] = (),
    hand_over: str = NEVER,
) -> list[str]:
    """Every way in which an FMU does not offer what a phase asks of it; empty when it can be swapped in.

    takes_over     from a phase before it
    hands_over     names of what the phase after it takes over
    hand_over      what ends the phase, one of `HAND_OVER`
    """
    found = []
    missing = []
    for row in asked(kind):
        info = archive.variables.get(row.name)
        needed = row.needed(takes_over, hands_over, hand_over)
        if info is not None and (needed or row.need in OPTIONAL):
            found += [f"{row.name}: {fault}" for fault in _faults(row, info)]
        elif info is None and needed:
            missing.append(row)
    names = [row.name for row in asked(kind)]
    spare = [name for name in archive.variables if name not in names]
    for row in missing:
        like = nearest(row.name, spare)
        hint = f"; did you mean its {like!r}?" if like is not None else ""
        found.append(f"{row.name}: missing; expected {_words(row)}, {NEEDS[row.need]}{hint}")
    return found


ALIKE = 0.9
"""Likeness of two names, as difflib measures it, from which on one is taken for a slip in the other."""


def near_misses(archive: Archive, kind: Wanting) -> list[str]:
    """Variables that nobody looks for, whose names are nearly those of something the phase would report."""
    rows = asked(kind)
    names = {row.name for row in rows}
    spare = [name for name in archive.variables if name not in names]
    found = []
    for row in rows:
        if row.name not in archive.variables and row.need in OPTIONAL:
            for name in difflib.get_close_matches(row.name, spare, n=1, cutoff=ALIKE):
                if archive.variables[name].causality == row.causality:
                    found.append(f"{archive.path.name}: its {name!r} is not used; did you mean {row.name!r}?")
    return found


def _faults(row: Asked, info: VariableInfo) -> list[str]:
    faults = []
    if info.kind != row.kind:
        faults.append(f"its type is {info.kind}; expected {row.kind}")
    if info.causality != row.causality:
        faults.append(f"its causality is {info.causality}; expected {row.causality}")
    wanted = by_name(row.unit)
    dimension = PURE if wanted.dimension is None else wanted.dimension
    if info.kind == row.kind == "Real" and misfit(info.own, Unit(row.unit, dimension)):
        theirs = spoken_dimension(info.own.dimension)
        counted = f" ({theirs})" if theirs != info.own.name else ""
        faults.append(f"its unit is {info.own.name}{counted}; expected {spoken_dimension(dimension)}")
    return faults


def _words(row: Asked) -> str:
    unit = f" in {row.unit}" if row.unit != "1" else ""
    article = "an" if row.causality[0] in "aeiou" else "a"
    return f"{article} {row.causality}, {row.kind}{unit}"


def bullets(names: Container[str]) -> list[int]:
    """Numbers of the bullets whose positions are all among these names, from 1 on."""
    of_each = (all(f"bullet[{bullet}].position[{i}]" in names for i in (1, 2, 3)) for bullet in count(1))
    return [bullet for bullet, there in zip(count(1), takewhile(bool, of_each), strict=False) if there]
