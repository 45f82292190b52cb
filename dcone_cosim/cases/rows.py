"""A row: what came of a case, as plain data. What it cost is apart, since that is never twice the same."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from types import MappingProxyType
from typing import Any

from dcone_cosim.errors import BAD_INPUT, FAILED_AFTER, OVERLOADED, SUCCESS

LOST = "lost"
"""Status of a case whose worker died: it says nothing of the case, which is run again when the work goes on."""
REFUSED = "refused"
"""Status of a case that could not begin: its values do not go together, or an FMU does not take them."""
FAULT = "fault"
"""Status of a case that ended in a fault of this program; it is run again too."""
NONE: Mapping[str, str] = MappingProxyType({})
CLOCK = ("wall",)
"""Figures of a summary that are times of this computer."""

Figure = float | int | str


@dataclass(frozen=True)
class Row:
    """What came of a case.

    key        hash of the case
    status     "completed", or how it ended; `message` says why
    exit_code  that `dcone run` would have had
    figures    of the summary, by phase and key: "removal.tension_mean"; a text where one is told instead of a number
    units      of the numbers among them
    shown_in   those in which a person reads them, where a figure has one of its own
    timings    CPU and wall time, of the case and of its phases [s]
    samples    by quantity what a case was run for beside that: numbers in lists
    """

    key: str
    status: str
    exit_code: int = SUCCESS
    message: str = ""
    figures: Mapping[str, Figure] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    timings: Mapping[str, float] = field(default_factory=dict)
    samples: Mapping[str, Any] = field(default_factory=dict)
    shown_in: Mapping[str, str] = field(default_factory=dict)

    @property
    def succeeded(self) -> bool:
        return self.exit_code == SUCCESS

    @property
    def complete(self) -> bool:
        """Whether it came to its end, so that its figures are those of all of it: also with an overloaded line."""
        return self.exit_code in (SUCCESS, OVERLOADED)

    @property
    def lasting(self) -> bool:
        """Whether the case would end so again."""
        return self.status not in (LOST, FAULT)

    def as_text(self) -> str:
        """One line of JSON: figures in their order, numbers with every bit, NaN and infinities as Python has them."""
        return json.dumps(asdict(self))

    @classmethod
    def from_text(cls, text: str) -> Row:
        """The row again; `ValueError` for any other text."""
        try:
            return cls(**json.loads(text))
        except (TypeError, RecursionError) as error:
            raise ValueError(f"not a row: {error}") from None


def lost(key: str, why: str) -> Row:
    """The row of a case whose worker died."""
    return Row(key, LOST, FAILED_AFTER, f"its worker {why}; the case is run again when the same command is given again")


def refused(key: str, why: str) -> Row:
    """The row of a case that cannot be."""
    return Row(key, REFUSED, BAD_INPUT, why)


def of_summary(
    key: str, summary: Mapping[str, Any], timings: Mapping[str, float], shown_in: Mapping[str, str] = NONE
) -> Row:
    """The row of a run, from its summary for machines."""
    figures: dict[str, Figure] = {}
    units: dict[str, str] = {}
    times = dict(timings)
    for phase, content in summary.items():
        if not isinstance(content, Mapping):
            continue
        for name, about in content.items():
            if name in CLOCK:
                times[f"{phase}.{name}"] = float(about["value"])
                continue
            figures[f"{phase}.{name}"] = about["value"]
            if "unit" in about:
                units[f"{phase}.{name}"] = about["unit"]
    status, code, message = summary["status"], summary["exit_code"], summary["message"]
    return Row(key, str(status), int(code), str(message), figures, units, times, shown_in=dict(shown_in))


def unit_of(rows: Iterable[Row], name: str) -> tuple[str, str]:
    """Unit of a figure that some rows have, and the one in which a person reads it, "" for none of its own."""
    rows = [row for row in rows if name in row.units]
    return (rows[0].units[name], rows[0].shown_in.get(name, "")) if rows else ("1", "")
