"""By what a tow is judged when it is computed in another way."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from dcone_cosim.quantities import BOUND, Quantity, at
from dcone_cosim.results import PhaseResult

NAMES = (
    "tug_times",
    "tug_peaks",
    "largest_tug",
    "largest_along",
    "mean_tension",
    "semi_major_axis",
    "radius",
    "separation",
    "paid_out",
    "friction_loss",
)
TUGS = 5
"""Tugs from the first on that are compared."""
LEAST = 1.0
"""Least change of the orbit that an error is relative to [m]: an orbit that stays has none."""


LEVEL = ("level.error", "level.average_error")
"""Outputs with the bound that a level of detail keeps [1]."""


def quantities(result: PhaseResult, instants: Sequence[float]) -> Iterator[Quantity]:
    """Times and peaks of the first tugs, the largest, mean tension, orbit and separation."""
    recorder = result.recorder
    if len(recorder) < 2:
        return
    begin = result.start
    if result.tugs is not None:
        rows = [result.tugs.rows[number] for number in sorted(result.tugs.rows)]
        first = [row for row in rows if row[0] > begin][:TUGS]
        if first:
            times = [t - begin for t, _, _ in first]
            # a line that begins all but taut tugs at once: its time says nothing of the others
            between = times[-1] / len(times)
            yield Quantity("tug_times", f"times of the first {TUGS} tugs", times, "s", between, "their mean interval")
            yield Quantity("tug_peaks", f"peaks of the first {TUGS} tugs", [peak for _, peak, _ in first], "N")
            largest = max(peak for _, peak, _ in rows)
            yield Quantity("largest_tug", "largest tug", [largest], "N", meant=False)
    bounds = [float(recorder.last()[name]) for name in LEVEL if name in recorder]
    if bounds:
        yield Quantity(BOUND, "what its level of detail may err by", [max(bounds)], "1", 1.0, "1", False)
    if "lumped.peak_tension" in recorder:
        along = float(np.max(recorder["lumped.peak_tension"]))
        yield Quantity("largest_along", "largest tension along the line", [along], "N", meant=False)
    if "tether.impulse" in recorder:
        impulse = recorder["tether.impulse"]
        mean = float((impulse[-1] - impulse[0]) / (recorder["time"][-1] - recorder["time"][0]))
        if mean > 0.0:
            yield Quantity("mean_tension", "mean tension", [mean], "N")
    if "center.semi_major_axis" in recorder:
        axis = recorder["center.semi_major_axis"]
        change = max(abs(float(axis[-1] - axis[0])), LEAST)
        told = at(recorder, "center.semi_major_axis", instants)
        yield Quantity("semi_major_axis", "semi-major axis over time", told.tolist(), "m", change, "its change")
    if "chaser.radius" in recorder:
        radius = recorder["chaser.radius"]
        told, swing = at(recorder, "chaser.radius", instants), max(float(np.ptp(radius)), LEAST)
        yield Quantity("radius", "the chaser's radius over time", told.tolist(), "m", swing, "its range", False)
    if "separation" in recorder:
        told, size = at(recorder, "separation", instants), float(np.max(recorder["separation"]))
        yield Quantity("separation", "separation over time", told.tolist(), "m", size, "its largest", False)
    if "reel.paid_out" in recorder:
        told, size = at(recorder, "reel.paid_out", instants), float(np.max(recorder["reel.paid_out"]))
        yield Quantity("paid_out", "line paid out over time", told.tolist(), "m", size, "its largest", False)
    if "friction.loss" in recorder and (lost := float(recorder["friction.loss"][-1])) > 0.0:
        told = at(recorder, "friction.loss", instants)
        yield Quantity(
            "friction_loss", "what friction has taken over time", told.tolist(), "J", lost, "all of it", False
        )
