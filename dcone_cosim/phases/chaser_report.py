"""What the chaser's thruster and wheels have done in a tow: their lines of the summary."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from dcone_cosim.findings import Finding
from dcone_cosim.results import PhaseResult
from orbital.constants import STANDARD_GRAVITY


def of_chaser(phase: str, result: PhaseResult, values: Mapping[str, float]) -> Iterator[Finding]:
    """Of a thruster with an engine, burns or a plume, and of attitude control.

    values    parameters of the tow, SI

    Impulses and energy go by the propellant, so that a pulse between two rows counts as well. How much of the beam
    meets the target is known in rows; between two it is taken to be their mean.

    Checked  tests/cosim/test_chaser_report.py
    """
    columns = result.recorder
    last = columns.last()
    if "engine.propellant_left" in last:
        yield Finding(phase, "propellant_left", "propellant left in the tank", last["engine.propellant_left"], "kg")
    exhaust = values.get("thrust.specific_impulse", 0.0) * STANDARD_GRAVITY
    if exhaust > 0.0 and "chaser.propellant" in columns and {"thrust.force", "plume.share"} & set(columns.names):
        impulse = exhaust * np.diff(columns["chaser.propellant"], prepend=0.0)
        yield Finding(phase, "thrust_impulse", "impulse of the thruster", float(impulse.sum()), "N s")
        if "engine.efficiency" in values:
            drawn = 0.5 * exhaust * float(impulse.sum()) / values["engine.efficiency"]
            yield Finding(phase, "engine_energy", "electric energy that it drew", drawn, "J")
        if "plume.share" in columns:
            share = columns["plume.share"]
            met = float(impulse @ (0.5 * (share + np.append(share[:1], share[:-1]))))
            pushes = "" if values.get("plume.pushes", 1.0) else ", told and not felt"
            yield Finding(phase, "plume_impulse", f"of it, plume on the target (of rows{pushes})", met, "N s")
        if "plume.on_line" in columns and impulse.sum() > 0.0:
            on_line = np.asarray(columns["plume.on_line"], dtype=float)
            label = "share of it with the tether in the beam (of rows)"
            yield Finding(phase, "plume_on_line", label, float(impulse @ on_line / impulse.sum()))
    if "engine.limited" in columns:
        limited = float(np.mean(columns["engine.limited"]))
        yield Finding(phase, "engine_limited", "share of the rows in which the power limits the thrust", limited)
    if {"aocs.deviation", "aocs.limited"} <= set(columns.names):
        for name, unit in (("torque", "N m"), ("momentum", "N m s")):
            axes = [columns[f"aocs.{name}[{axis}]"] for axis in (1, 2, 3) if f"aocs.{name}[{axis}]" in columns]
            if axes:
                largest = float(np.max(np.linalg.norm(axes, axis=0)))
                yield Finding(phase, f"aocs_{name}", f"largest {name} of the wheels (of rows)", largest, unit)
        deviation = float(np.max(columns["aocs.deviation"]))
        label = "largest deviation of the chaser's attitude (of rows)"
        yield Finding(phase, "aocs_deviation", label, deviation, "rad", shown_in="deg")
        limited = float(np.mean(columns["aocs.limited"]))
        yield Finding(phase, "aocs_limited", "share of the rows with the wheels at a limit", limited)
