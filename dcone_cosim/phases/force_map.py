"""Where the net has pressed on the target: the cells of a force map, and their picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dcone_cosim import build
from dcone_cosim.plots import style
from dcone_cosim.results import RunResult

Array = npt.NDArray[np.float64]
FACES = ("+1", "-1", "+2", "-2", "+3", "-3")
"""Outward along which body axis."""
IMPULSE, PEAK = "force_map.impulse", "force_map.peak"


class Cells(NamedTuple):
    """What a run put on each cell of the target.

    face      1, -1, 2, -2, 3 or -3: outward along which body axis (n,)
    middle    in body axes [m] (n, 3)
    impulse   in all [N s] (n,)
    peak      largest force [N] (n,)
    """

    face: npt.NDArray[np.int64]
    middle: Array
    impulse: Array
    peak: Array


def of_run(run: RunResult, phase: str) -> Cells | None:
    """The cells at the end of a phase; None where it has no map, or a target that is none of ours."""
    recorder = run.phases[phase].recorder
    if not len(recorder) or f"{IMPULSE}[1]" not in recorder:
        return None
    main = next(one.main for one in run.scene.phases if one.name == phase)
    middles = build.force_cells({**run.parameters.get(phase, {}), **main.made}, main.terms)
    if middles is None:
        return None
    last, number = recorder.last(), len(middles)
    impulse, peak = (np.array([last[f"{name}[{i}]"] for i in range(1, number + 1)]) for name in (IMPULSE, PEAK))
    face = np.repeat([int(name) for name in FACES], number // len(FACES))
    return Cells(face, np.array(middles), impulse, peak)


def draw(cells: Cells, title: str, path: Path) -> None:
    """Both sizes on the six faces of the box round the target, a row each."""
    from matplotlib.colors import Normalize

    figure = style.new_figure(13.0, 6.0)
    axes: Any = figure.subplots(2, len(FACES), squeeze=False)
    figure.subplots_adjust(left=0.04, wspace=0.35, hspace=0.4, top=0.82)
    for row, (values, label) in enumerate(((cells.impulse, "impulse [N s]"), (cells.peak, "largest force [N]"))):
        scale = Normalize(0.0, max(float(values.max()), 1e-12))
        for column, name in enumerate(FACES):
            here, one = cells.face == int(name), axes[row, column]
            along, up = ((abs(int(name)) - 1 + i) % 3 for i in (1, 2))
            side = round(len(values[here]) ** 0.5)
            reach = [np.abs(cells.middle[here][:, axis]).max() * side / (side - 1) for axis in (along, up)]
            picture = one.imshow(
                values[here].reshape(side, side),
                origin="lower",
                extent=(-reach[0], reach[0], -reach[1], reach[1]),
                norm=scale,
                cmap="viridis",
            )
            one.grid(False)
            one.tick_params(labelsize=7)
            one.set_title(f"face {name}: axis {up + 1} [m]\nover axis {along + 1} [m]", fontsize=8)
        figure.colorbar(picture, ax=list(axes[row]), label=label)
    style.head(figure, title)
    style.save(figure, path)
