"""Values of a reel, each within its bounds, with which it cannot work: told before any build or run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from fmu_src.tethered_deorbit.reel_rows import SCHEDULE_POINTS

Values = Mapping[str, float]


def of_reel(values: Values, terms: Mapping[str, str]) -> Iterator[tuple[str, str, str]]:
    """Variable, its value as a person reads it, and what would do.

    values        every parameter and input by FMI name, SI

    Checked  tests/cosim/test_reels.py
    """
    reel = terms["reel"]
    if reel in ("regulator", "libration") and terms.get("environment") == "none":
        yield "environment.field", "none", f"{reel} needs an orbit: it goes by the angle from the local vertical"
    if reel == "detumble" and terms.get("target") == "point":
        yield "target.body", "point", "a point has no spin to be taken out; expected rigid, box or cylinder"
    wrong = list(_lengths(values)) if "reel.length_most" in values else []
    yield from wrong
    if not wrong and "reel.schedule_time[1]" in values:
        yield from _schedule(values)


def _lengths(values: Values) -> Iterator[tuple[str, str, str]]:
    """A line that is wound out within the limits of its drum."""
    least, most = values.get("reel.length_least", 0.0), values["reel.length_most"]
    if least > most:
        yield "reel.length_least", f"{least:g} m", f"must be at most reel.length_most, {most:g} m"
        return
    start = values["tether.rest_length"]
    if not least <= start <= most:
        between = f"must lie between reel.length_least, {least:g} m, and reel.length_most, {most:g} m"
        if least == 0.0:
            between = f"must be at most reel.length_most, {most:g} m"
        yield "tether.rest_length", f"{start:g} m", between


def _schedule(values: Values) -> Iterator[tuple[str, str, str]]:
    """Times that increase, up to a last point that may be repeated, and lengths that the drum allows."""
    times = [values[f"reel.schedule_time[{k}]"] for k in range(1, SCHEDULE_POINTS + 1)]
    lengths = [values[f"reel.schedule_length[{k}]"] for k in range(1, SCHEDULE_POINTS + 1)]
    last = max((k for k in range(1, SCHEDULE_POINTS) if times[k] != times[k - 1]), default=0)
    for k in range(1, last + 1):
        if not times[k] > times[k - 1]:
            text = f"element {k + 1}, {times[k]:g} s, must be later than the one before it, {times[k - 1]:g} s"
            yield "reel.schedule_time", f"{times[k]:g} s", text
            return
    least, most = values["reel.length_least"], values["reel.length_most"]
    for k, length in enumerate(lengths[: last + 1]):
        if not least <= length <= most:
            text = f"element {k + 1} must lie between reel.length_least, {least:g} m, and reel.length_most, {most:g} m"
            yield "reel.schedule_length", f"{length:g} m", text
            return
