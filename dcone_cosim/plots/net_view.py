"""The capture in space: net, bullets, mouth cord and target at eight times."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from dcone_cosim.build import Drawing, Surface
from dcone_cosim.contract import bullets
from dcone_cosim.handoff import rotation_matrix
from dcone_cosim.plots import style
from dcone_cosim.plots.style import Array
from dcone_cosim.results import PhaseResult

PANELS = 8
LEAST_WIDTH = 9.0
"""Width that the legend needs [inch]."""
SHOWN = (1, 2, 0)
"""Axes of a panel: along-track to the right, cross-track into the page, radial up."""


def choose(times: list[float], asked: bool, located: float | None) -> list[int]:
    """Which snapshots to show: those asked for, or evenly spread ones with the instant of hand-over among them."""
    if len(times) <= PANELS:
        return list(range(len(times)))
    if asked:
        kept = [i for i, t in enumerate(times) if t != located]
        return kept[:PANELS]
    chosen = [int(np.argmin(np.abs(np.array(times) - t))) for t in np.linspace(times[0], times[-1], PANELS)]
    if located is not None and located in times:
        there = times.index(located)
        chosen[min(range(PANELS), key=lambda i: abs(times[chosen[i]] - located))] = there
    return sorted(set(chosen))


def grid(panels: int) -> tuple[int, int]:
    """Rows and columns that hold so many panels: one row of up to four, otherwise two."""
    rows = 1 if panels <= 4 else 2
    return rows, -(-panels // rows)


def draw(
    result: PhaseResult,
    drawing: Drawing | None,
    surface: Surface | None,
    asked: bool,
    title: str,
    path: Path,
    *,
    swing: Callable[[float], Array] | None = None,
) -> None:
    """PNG of the capture at up to eight times; net and target as far as their shapes are known.

    swing    corners of a target whose appendage swings, body axes, by the angle of its hinge
    """
    shots = result.snapshots
    chosen = choose(shots.times, asked, result.located)
    row_of = {i: int(np.argmin(np.abs(result.recorder["time"] - shots.times[i]))) for i in chosen}
    rows, columns = grid(len(chosen))
    wide, high = (3.5, 3.1) if len(chosen) > 2 else (4.5, 4.0)
    width, height = max(wide * columns, LEAST_WIDTH), high * rows + 0.6
    figure = style.new_figure(width, height)
    side = 0.5 * (1.0 - wide * columns / width)
    figure.subplots_adjust(
        left=side + 0.02, right=0.97 - side, bottom=0.45 / height, top=1.0 - 0.55 / height, wspace=0.06, hspace=0.1
    )
    bodies = {i: _corners(result, row_of[i], surface, swing) for i in chosen}
    least, most = _limits(result, row_of, bodies)
    for panel, i in enumerate(chosen):
        axes = figure.add_subplot(rows, columns, panel + 1, projection="3d", computed_zorder=False)
        _panel(axes, result, i, row_of[i], drawing, bodies[i], surface)
        _frame(axes, least, most)
        mark = "  (hand-over)" if result.located is not None and shots.times[i] == result.located else ""
        axes.set_title(f"t = {shots.times[i]:.2f} s{mark}", y=0.99)
    style.head(figure, title)
    _legend(figure, surface is not None)
    style.save(figure, path)


def _panel(
    axes: Any,
    result: PhaseResult,
    shot: int,
    row: int,
    drawing: Drawing | None,
    corners: Array | None,
    surface: Surface | None,
) -> None:
    from mpl_toolkits.mplot3d.art3d import Line3DCollection

    nodes = result.snapshots.nodes[shot][:, SHOWN]
    _target(axes, corners, surface)
    lines, rim = _thread_lines(nodes, drawing)
    if lines:
        axes.add_collection3d(Line3DCollection(lines, colors=style.NET, linewidths=0.35, alpha=0.75, zorder=3))
    else:
        axes.plot(*nodes.T, ".", color=style.NET, markersize=1, zorder=3)
    bullets = _bullets(result, row)[:, SHOWN]
    if len(bullets):
        ring = rim if rim is not None else np.vstack([bullets, bullets[:1]])
        axes.plot(*ring.T, color=style.BULLET, linewidth=0.9, alpha=0.8, zorder=4)
        axes.plot(*bullets.T, "o", color=style.BULLET, markersize=2.8, zorder=5)
    for artist in (*axes.lines, *axes.collections):
        artist.set_clip_on(False)  # a long box reaches beyond its panel


def _bullets(result: PhaseResult, row: int) -> Array:
    """Bullets in the order of the mouth, (n, 3) [m]."""
    recorder = result.recorder
    numbers = bullets(recorder.names)
    places = [[recorder[f"bullet[{b}].position[{i}]"][row] for i in (1, 2, 3)] for b in numbers]
    return np.array(places).reshape(len(numbers), 3)


def _thread_lines(nodes: Array, drawing: Drawing | None) -> tuple[list[Array], Array | None]:
    """The threads as lines of knots, (knots, 3) each, and the rim; nothing when the net's shape is not known."""
    if drawing is None:
        return [], None
    lines, rim = drawing
    if max(rim) >= len(nodes):
        return [], None
    return [nodes[line] for line in lines], nodes[rim]


def _target(axes: Any, corners: Array | None, surface: Surface | None) -> None:
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    if corners is None or surface is None:
        return
    polygons = [corners[face][:, SHOWN] for face in surface[1]]
    axes.add_collection3d(
        Poly3DCollection(polygons, facecolors=style.TARGET, edgecolors="#4d3b1c", linewidths=0.5, alpha=0.45, zorder=2)
    )


def _corners(
    result: PhaseResult, row: int, surface: Surface | None, swing: Callable[[float], Array] | None
) -> Array | None:
    """Corners of the target turned by its attitude and its hinge, (n, 3) [m]; None where they are not known."""
    recorder = result.recorder
    if "target.attitude[1]" not in recorder or surface is None:
        return None
    turn = rotation_matrix(recorder.vector("target.attitude", 4)[row])
    own = np.array(surface[0]) if swing is None else swing(float(recorder["hinge.angle"][row]))
    corners: Array = recorder.vector("target.position")[row] + own @ turn.T
    return corners


def _limits(result: PhaseResult, rows: dict[int, int], bodies: dict[int, Array | None]) -> tuple[Array, Array]:
    """Bounds of everything shown, one for all panels so that they compare."""
    clouds = [result.snapshots.nodes[i] for i in bodies] + [_bullets(result, rows[i]) for i in bodies]
    clouds += [corners for corners in bodies.values() if corners is not None]
    points = np.concatenate(clouds)[:, SHOWN]
    return points.min(axis=0), points.max(axis=0)


def _frame(axes: Any, low: Array, high: Array) -> None:
    from matplotlib.ticker import MaxNLocator

    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_zlim(low[2], high[2])
    size = high - low
    # a box that is not longer than high needs more of the panel's height
    axes.set_box_aspect(size, zoom=1.3 if size[0] >= size[2] else 1.0)
    axes.view_init(elev=18, azim=-62)
    axes.tick_params(labelsize=7, pad=-3)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
        axis.pane.set_alpha(0.15)


def _legend(figure: Any, has_target: bool) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    figure.legend(
        handles=[
            Line2D([], [], color=style.NET, label="threads"),
            Line2D([], [], color=style.BULLET, marker="o", markersize=4, label="bullets and mouth"),
            *([Patch(facecolor=style.TARGET, alpha=0.45, label="target")] if has_target else []),
            Line2D(
                [], [], linestyle="", label="axes [m]: along-track to the right, cross-track to the back, radial up"
            ),
        ],
        loc="lower center",
        ncols=4,
    )
