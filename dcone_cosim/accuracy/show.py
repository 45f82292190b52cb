"""Errors against CPU time as tables on the terminal, in sentences, and as plain data for machines."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Literal

from dcone_cosim.accuracy.judge import SIGMAS, Axis, Judged, Report, better_peers, cheapest, front, own

if TYPE_CHECKING:
    from rich.console import Console

ASKED = (0.01, 0.001)
"""Accuracies that a sentence is written for [1]."""


ROUNDING = 1e-14
"""Relative size of what is told as rounding [1]."""


def percent(value: float) -> str:
    """A relative size as a person reads it: "0.12 %", "3e-07 %"."""
    if math.isnan(value):
        return ""
    if math.isinf(value):
        return "differs"
    if value < ROUNDING:
        return "rounding"
    return f"{100.0 * value:.2g} %"


def told(value: float, floor: float) -> str:
    """An error, or that it is below what can be told."""
    return f"< {percent(floor)}" if value < floor else percent(value)


def seconds(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.3g} s" if value >= 0.1 else f"{1e3 * value:.3g} ms"


def sentences(report: Report) -> Iterator[str]:
    """What to use for which accuracy, what the scene errs by as it is, and how far the reference can be trusted."""
    if report.failure:
        yield f"{report.plan.phase}: no setting came to an end: {report.failure}"
        return
    phase, axis = report.plan.phase, report.numerics
    for accuracy in ASKED:
        best = cheapest(own(axis.points), accuracy)
        if best is None:
            yield f"{phase}: {_beyond(axis, accuracy)}"
            continue
        how = " ".join(f"--set {change!r}" for change in best.setting.changes) or "the scene as it is"
        error = told(best.worst, best.floor)
        yield (
            f"{phase}: for {percent(accuracy)} use {best.setting.label}: {how}; {seconds(best.sample.cpu)} of CPU "
            f"time, error {error}"
        )
    yield from (f"{phase}: {line}" for line in _of_peers(axis))
    parts = ", ".join(f"{a.name} {told(a.here.worst, a.here.floor)}" for a in report.axes)
    cost = seconds(report.numerics.here.sample.cpu)
    yield f"{phase}: as it is the scene errs by {percent(report.here)} at most ({parts}) and takes {cost} of CPU time"
    for axis in report.axes:
        yield f"{phase}: {_reference(axis, report.plan.chaotic)}"


def _of_peers(axis: Axis) -> Iterator[str]:
    """How other programs stand, where some were tried."""
    if not any(point.setting.peer for point in axis.points):
        return
    better = better_peers(axis.points)
    if not better:
        yield "no other program that was tried is as exact at less CPU time"
    for point in better:
        yield (
            f"{point.setting.label} is more exact than any setting of ours as cheap: {percent(point.worst)} in "
            f"{seconds(point.sample.cpu)}"
        )


def _beyond(axis: Axis, accuracy: float) -> str:
    """Why nothing is as accurate as that, and what would be."""
    able = [p for p in own(axis.points) if math.isfinite(p.bound)]
    nearest = min(able, key=lambda p: p.bound, default=None)
    if nearest is None:
        return "nothing tried comes to what the reference comes to"
    text = f"nothing tried is known to be within {percent(accuracy)}; the nearest is within {percent(nearest.bound)}"
    scatter, label = axis.scatter
    if scatter > accuracy:
        runs = math.ceil((SIGMAS * scatter / accuracy) ** 2)
        text += (
            f". One run scatters by {percent(scatter)} ({label}): its mean is known to {percent(accuracy)} after about "
            f"{runs:,} runs"
        )
    return text


def _reference(axis: Axis, chaotic: bool) -> str:
    name = f"{axis.name}: errors are counted from {axis.reference.label}"
    if axis.second is None:
        return f"{name}; nothing judges it"
    text = f"{name}; {axis.second.label} agrees with it to {percent(axis.agreement)}"
    if chaotic:
        text += " (means over the runs, scatter included)"
    orders = ", ".join(f"{family} {order:.2f}" for family, order in axis.orders.items())
    return text + (f"; errors go with the power of the size: {orders}" if orders else "")


def _worst_of(report: Report, point: Judged) -> str:
    """The quantity that errs most among those that an accuracy means."""
    meant = {key: error for key, error in point.errors.items() if report.quantities[key]["meant"]}
    if not meant or point.worst < point.floor:
        return ""
    return str(report.quantities[max(meant, key=lambda key: meant[key])]["label"])


def show(report: Report, console: Console) -> None:
    """The table of one phase."""
    from rich.table import Table
    from rich.text import Text

    title = f"{report.plan.title}: {report.plan.phase}"
    table = Table(title=Text(title, style="table.title"), title_justify="left", box=None, pad_edge=False)
    heads: tuple[tuple[str, Literal["left", "right"]], ...] = (
        *(("setting", "left"), ("error", "right"), ("of", "left"), ("CPU time", "right"), ("", "left")),
    )
    for head, side in heads:
        table.add_column(head, justify=side, overflow="fold")
    for axis in report.axes:
        best = {id(p) for p in front(own(axis.points))} if axis is report.numerics else set()
        table.add_row(Text(axis.name, style="bold"))
        for point in axis.points:
            error = "failed" if point.sample.failed else told(point.worst, point.floor)
            row = (f"  {point.setting.label}", error, _worst_of(report, point), seconds(point.sample.cpu))
            mark = "peer" if point.setting.peer else "shape alone" if point.setting.partial else ""
            mark = "best" if id(point) in best else mark
            table.add_row(*map(Text, (*row, mark)))
    console.print(table)
    for sentence in sentences(report):
        console.print(Text(sentence), highlight=False, soft_wrap=True)
    console.print()


def as_dict(report: Report) -> dict[str, Any]:
    """For machines, errors as shares."""
    if report.failure:
        return {"failure": report.failure, "sentences": list(sentences(report)), "notes": report.plan.notes}
    return {
        "here": {"value": report.here, "unit": "1"},
        "quantities": {key: _quantity(about) for key, about in report.quantities.items()},
        "axes": {axis.name: _axis(axis) for axis in report.axes},
        "sentences": list(sentences(report)),
        "notes": report.plan.notes,
    }


def _quantity(about: Any) -> dict[str, Any]:
    return {key: about[key] for key in ("label", "unit", "relative_to", "meant")}


def _axis(axis: Axis) -> dict[str, Any]:
    return {
        "reference": axis.reference.label,
        "second": axis.second.label if axis.second else None,
        "agreement": axis.agreement,
        "orders": axis.orders,
        "front": [p.setting.label for p in front(own(axis.points))],
        "here": {"error": axis.here.worst, "floor": axis.here.floor},
    }
