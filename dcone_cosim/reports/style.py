"""Colours and helpers shared by the figures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

CHASER = "#1f4e79"
TARGET = "#8a6d3b"
NET = "#4a6fa5"
BULLET = "#c0392b"
ACCENT = "#2e8b57"
MUTED = "#888888"
DPI = 130

SETTINGS: Any = {
    "font.size": 9,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 10,
    "legend.frameon": False,
    "figure.facecolor": "white",
}


def load() -> None:
    """Import what drawing needs, half a second; may run in a thread while an FMU computes."""
    import matplotlib.backends.backend_agg
    import matplotlib.figure  # noqa: F401
    import mpl_toolkits.mplot3d.art3d  # noqa: F401


def new_figure(width: float, height: float, layout: Any = "constrained") -> Any:
    """A figure on the Agg canvas [inch], without pyplot and its global state."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout=layout)
    FigureCanvasAgg(figure)
    return figure


def save(figure: Any, path: Path) -> None:
    figure.savefig(path, dpi=DPI, pil_kwargs={"compress_level": 3})


def time_axis(duration: float) -> tuple[float, str]:
    """Divisor and unit that suit a duration [s]: seconds, minutes, hours or days."""
    for limit, divisor, unit in ((300.0, 1.0, "s"), (7200.0, 60.0, "min"), (3.0 * 86400.0, 3600.0, "h")):
        if duration <= limit:
            return divisor, unit
    return 86400.0, "day"
