"""The line of a tow, as an entry of the table of lines."""

from __future__ import annotations

from fmu_src.lines import Line

LINES = (
    Line(
        "line",
        "the tether",
        "tether",
        ("lumped.peak_tension", "tether.tension_peak", "tether.tension"),
        follows={
            "tether.youngs_modulus": "youngs_modulus",
            "tether.damping_ratio": "damping_ratio",
            "lumped.density": "density",
        },
        modulus="tether.youngs_modulus",
        diameter="tether.diameter",
        breaks_at="break.strength",
        broken=("break.broken", "break.time"),
    ),
)
