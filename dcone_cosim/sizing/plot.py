"""Pictures of a sizing."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from dcone_cosim.plots import style
from dcone_cosim.sizing import budget
from dcone_cosim.sizing.report import PICTURES
from dcone_cosim.sizing.spectrum import by_size
from dcone_cosim.sizing.study import Study
from orbital import netting

COLOURS = (style.CHASER, style.BULLET, "#222222")
"""Of Fig. 9's configurations, as in the paper: blue, red, black."""
MOST_BARS = 10


def draw(study: Study, folder: Path) -> None:
    """All pictures of a study."""
    from matplotlib import rc_context

    drawn: Mapping[str, Callable[[Study, Any], None]] = {
        "loads": _loads,
        "spectrum": _spectrum,
        "required": _required,
        "sensitivities": _slopes,
        "region": _region,
    }
    with rc_context(style.SETTINGS):
        for key, panel in drawn.items():
            if not _has(study, key):
                continue
            width, height = (9.0, 3.4) if key != "region" else (9.0, 3.8)
            figure = style.new_figure(width, height)
            panel(study, figure)
            style.save(figure, folder / PICTURES[key])


def _has(study: Study, key: str) -> bool:
    if key == "region":
        return study.region is not None and bool(study.region.points)
    return bool({"spectrum": study.nominal.tugs, "sensitivities": study.slopes}.get(key, True))


def _axes(figure: Any, left: float = 0.09, bottom: float = 0.16, top: float = 0.87) -> Any:
    axes = figure.subplots()
    figure.subplots_adjust(left=left, right=0.97, bottom=bottom, top=top)
    return axes


def _loads(study: Study, figure: Any) -> None:
    axes = _axes(figure)
    peaks = sorted(run.peak for _, run in study.all)
    share = np.arange(1, len(peaks) + 1) / len(peaks)
    axes.step(peaks, share, where="post", color=style.CHASER, label="runs of what is uncertain")
    axes.axvline(study.nominal.peak, color=style.ACCENT, label="the scene as it is")
    axes.axvline(study.bound.peak, color=style.MUTED, ls=":", label="as it is, without damping")
    allowed = study.breaking / study.options.factor_of_safety
    if allowed < 5.0 * max(peaks):
        axes.axvline(allowed, color=style.BULLET, ls="--", label="the scene's line allows")
    axes.set_xlabel("peak tension [N]")
    axes.set_ylabel("share of runs below")
    axes.set_xlim(left=0.0)
    style.legend(axes, 4)


def _spectrum(study: Study, figure: Any) -> None:
    axes = _axes(figure)
    rows = by_size([tug[1] for tug in study.nominal.tugs], study.nominal.peak)
    axes.bar(
        [a for a, *_ in rows], [n for *_, n, _ in rows], width=[b - a for a, b, *_ in rows], align="edge",
        color=style.NET, edgecolor="white", label="tugs",
    )  # fmt: skip
    edges, above = [*(a for a, *_ in rows), rows[-1][1]], [*(m for *_, m in rows), rows[-1][3]]
    axes.step(edges, above, where="post", color=style.BULLET, label="as hard or harder")
    axes.set_xlabel("peak tension [N]")
    axes.set_ylabel("tugs")
    style.legend(axes)


def _required(study: Study, figure: Any) -> None:
    axes = _axes(figure, left=0.2)
    shown = [one for one in study.needed if math.isfinite(one.diameter)][:16][::-1]
    names = [f"{one.material.name} {one.material.form}" for one in shown]
    axes.plot(
        [1e3 * one.diameter for one in shown], names, "s", color=style.NET, ms=6, label="simulated, at the fixed point"
    )
    axes.plot([1e3 * one.closed for one in shown], names, "o", color=style.ACCENT, ms=4, label="closed form")
    axes.plot(
        [1e3 * one.fixed for one in shown], names, "x", color=style.BULLET, ms=5, label="from the highest peak: wrong"
    )
    axes.axvline(1e3 * study.ground.values["tether.diameter"], color=style.MUTED, ls=":", label="the scene's line")
    axes.set_xlabel("diameter [mm]")
    axes.set_xscale("log")
    ticks = style.plain_ticks(*axes.get_xlim())
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.set_xticks([], minor=True)
    axes.tick_params(axis="y", labelsize=7)
    style.legend(axes, 4)


def _slopes(study: Study, figure: Any) -> None:
    axes = _axes(figure, left=0.2)
    shown = [one for one in study.slopes if math.isfinite(one.largest)][:MOST_BARS][::-1]
    places = np.arange(len(shown))
    for shift, colour, label, pairs in (
        (0.2, style.CHASER, "largest tug", [(one.largest, one.largest_error) for one in shown]),
        (-0.2, style.MUTED, "first tug", [(one.first, one.first_error) for one in shown]),
    ):
        axes.barh(
            places + shift, [value for value, _ in pairs], 0.38, xerr=[error for _, error in pairs], color=colour,
            label=label, error_kw={"lw": 0.8},
        )  # fmt: skip
    axes.set_yticks(places, [one.name for one in shown])
    axes.set_xlabel("d ln peak / d ln value")
    axes.axvline(0.0, color="black", lw=0.6)
    style.legend(axes)


def _region(study: Study, figure: Any) -> None:
    found = study.region
    assert found is not None
    thrusts = list(dict.fromkeys(point.thrust for point in found.points))
    panels = figure.subplots(1, len(thrusts), squeeze=False, sharey=True)[0]
    figure.subplots_adjust(left=0.08, right=0.97, bottom=0.14, top=0.8, wspace=0.08)
    for axes, thrust in zip(panels, thrusts, strict=True):
        of = [point for point in found.points if point.thrust == thrust]
        rates, offsets = list(dict.fromkeys(p.rate for p in of)), list(dict.fromkeys(p.offset for p in of))
        for point in of:
            good = point.verdict == "admissible"
            colour = "#cfe8d8" if good else "#f3c6c0"
            x, y = rates.index(point.rate), offsets.index(point.offset)
            axes.add_patch(_box(x, y, colour))
            told = f"{point.peak:.3g} N" if math.isfinite(point.peak) else "no result"
            wraps = f"\n{point.wrapped:.2g} m lie on it" if point.wrapped > 0.0 else ""
            axes.text(x, y, told + wraps, ha="center", va="center", fontsize=7.5)
        axes.set_xlim(-0.5, len(rates) - 0.5)
        axes.set_ylim(-0.5, len(offsets) - 0.5)
        axes.set_xticks(range(len(rates)), [f"{math.degrees(rate):g}" for rate in rates])
        axes.set_yticks(range(len(offsets)), [f"{offset:.3g}" for offset in offsets])
        axes.set_xlabel("tumble rate [deg/s]")
        axes.set_title(f"thrust {thrust:g} N", loc="left", fontsize=9)
        axes.grid(False)
    panels[0].set_ylabel("offset of the line [m]")
    told = "Peak tension, and line that comes to lie on the debris; admissible (green): "
    style.head(figure, f"{told}within strength over factor of safety, and with the line less than half round it")


def _box(x: float, y: float, colour: str) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle((x - 0.5, y - 0.5), 1.0, 1.0, facecolor=colour, edgecolor="white")


def net_masses(path: Path) -> None:
    """Fig. 9 of the paper: net mass over mesh of its large configurations, and the mesh that Table 4's net allows."""
    from matplotlib import rc_context

    meshes = np.linspace(0.05, 1.0, 96)
    with rc_context(style.SETTINGS):
        figure = style.new_figure(7.2, 4.0)
        axes = _axes(figure, left=0.11, bottom=0.14)
        for (name, along, across), colour in zip(budget.LARGE, COLOURS, strict=True):
            masses = [netting.net_mass(along, across, mesh, budget.ARAMID.density, budget.THREAD) for mesh in meshes]
            axes.plot(meshes, masses, color=colour, label=name)
        mass = budget.PAPER[2].net
        axes.axhline(mass, color=style.MUTED, lw=0.8, ls="--", label=f"Table 4's net, {mass:g} kg")
        for allowed, colour in zip(budget.allowed(), COLOURS, strict=True):
            axes.plot([allowed.bare], [mass], "o", color=colour, ms=5)
            axes.annotate(f"{allowed.bare:.3g} m", (allowed.bare, mass), (4, 4), textcoords="offset points", fontsize=8)
        axes.set_ylim(0.0, 30.0)
        axes.set_xlim(0.0, 1.0)
        axes.set_xlabel("mesh [m]")
        axes.set_ylabel("mass of the net, 1 mm aramid [kg]")
        style.legend(axes, 4)
        style.save(figure, path)


def openings(points: Any, path: Path) -> None:
    """Largest mouth and time above 80 % over the bullets' mass, by simulation."""
    from matplotlib import rc_context

    with rc_context(style.SETTINGS):
        figure = style.new_figure(7.2, 3.4)
        axes = _axes(figure, left=0.1)
        axes.plot(
            [p.ratio for p in points], [p.opening for p in points], "o-", color=style.CHASER, label="largest mouth"
        )
        axes.axvline(budget.BULLETS_OVER_NET, color=style.BULLET, ls="--", label="the paper's rule, 6:1")
        axes.set_xlabel("mass of four bullets over that of the net")
        axes.set_ylabel("mouth over the net's area")
        axes.set_ylim(0.0, 1.05)
        style.legend(axes)
        style.save(figure, path)
