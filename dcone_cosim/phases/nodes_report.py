"""What a tow whose line is of lumped nodes found along it, and one on a table: their lines of the summary."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dcone_cosim.findings import Finding
from dcone_cosim.results import PhaseResult

TOLD = {"lumped.peak_tension", "lumped.peak_piece", "lumped.target_tension", "lumped.deflection", "lumped.heat"}


def of_table(phase: str, result: PhaseResult) -> Iterator[Finding]:
    """What the friction of a table has taken."""
    if "friction.loss" in result.recorder.names:
        lost = result.recorder.last()["friction.loss"]
        yield Finding(phase, "friction_loss", "energy that friction on the table has taken", lost, "J")


def of_nodes(phase: str, result: PhaseResult) -> Iterator[Finding]:
    """The largest tension along the line and the piece that had it, by the FMU's own watch; how far the line bowed, and
    what its dashpots took."""
    recorder = result.recorder
    if not set(recorder.names) >= TOLD:
        return
    peaks = recorder["lumped.peak_tension"]
    row = int(np.argmax(peaks))
    yield Finding(phase, "line_peak", "largest tension along the line", float(peaks[row]), "N")
    piece = int(recorder["lumped.peak_piece"][row])
    yield Finding(phase, "line_peak_piece", "in the piece, counted from the chaser", piece)
    at_target = float(np.max(recorder["lumped.target_tension"]))
    yield Finding(phase, "line_target_tension", "largest tension at the target (of rows)", at_target, "N")
    bowed = float(np.max(recorder["lumped.deflection"]))
    yield Finding(phase, "line_deflection", "farthest node from the straight line (of rows)", bowed, "m")
    last = recorder.last()
    if parted := int(last.get("lumped.parted_piece", 0)):
        yield Finding(phase, "line_parted", "parted in the piece, counted from the chaser", parted)
        lost = last["lumped.parted_energy"]
        yield Finding(phase, "line_parted_energy", "energy lost that this piece had stored", lost, "J")
    yield Finding(phase, "line_heat", "heat of the line's dashpots", last["lumped.heat"], "J")
