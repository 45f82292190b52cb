"""The answer of a sizing in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator

from dcone_cosim.sizing.governs import CUT
from dcone_cosim.sizing.study import Study
from orbital.materials import margin_of_safety
from orbital.tethers import DASHPOT_GOVERNS


def headline(study: Study) -> list[str]:
    """The answer in sentences."""
    sample, worst = study.worst
    own = study.needed[0]
    factor = study.options.factor_of_safety
    whose = "given" if "factor_of_safety" in study.options.told else "by default"
    line = 1e3 * study.ground.values["tether.diameter"]
    bears = study.bears(sample)
    margin = margin_of_safety(bears, worst.peak, factor)
    thicker = "" if bears == study.breaking else f", in a run whose own line breaks at {bears:.4g} N"
    said = [
        f"peak tension {study.nominal.peak:.4g} N in the scene as it is; the highest of {len(study.all)} runs of what "
        f"is uncertain has {worst.peak:.4g} N ({sample.label})",
        f"sustained tension {study.steady:.4g} N, without tugs: the largest of the scene's last orbit, or what thrust "
        "and tide keep in the line",
        f"the scene's line, {line:.4g} mm of {called(study.chief)}, breaks at {study.breaking:.4g} N: margin of safety "
        f"{margin:+.3g} with a factor of safety of {factor:g} ({whose}) on the highest tension{thicker}"
        + (": TOO WEAK" if margin < 0.0 else ""),
    ]
    governing = study.demands[0]
    if math.isfinite(own.diameter):
        said.append(
            f"the hardest tugs ask for {1e3 * own.diameter:.3g} mm of {called(own.material)} ({1e3 * own.mass:.3g} g), "
            f"at the fixed point, by simulation; {1e3 * own.closed:.3g} mm in closed form"
        )
    said.append(
        f"{governing.load} governs: required is {1e3 * governing.diameter:.3g} mm ({governing.how})"
        if math.isfinite(governing.diameter)
        else "no load governs"
    )
    said += [*_about_flux(study), *_about_tumbling(study), *_about_damping(study)]
    return said


def _about_flux(study: Study) -> Iterator[str]:
    """How far a cut by debris is to be trusted, where it governs."""
    flux, governing = study.options.flux, study.demands[0]
    if governing.load == CUT and flux.off > 1.0 and math.isfinite(governing.diameter):
        off = flux.off ** (1.0 / (flux.exponent - 1.0))
        yield (
            f"the default flux may be off by a factor of {flux.off:g} either way, and that diameter by one of "
            f"{off:.2g}: give the flux of ORDEM or MASTER for the orbit in [sizing]"
        )


def _about_tumbling(study: Study) -> Iterator[str]:
    """What a debris that tumbles does, which the runs of what is uncertain leave out where the scene's does not."""
    points = [] if study.region is None else [p for p in study.region.points if math.isfinite(p.peak)]
    if points:
        worst = max(points, key=lambda point: point.peak)
        bad = sum(point.verdict != "admissible" for point in points)
        told = f"{bad} of {len(points)} points tried {'is' if bad == 1 else 'are'} not admissible"
        yield (
            f"a debris that tumbles: up to {worst.peak:.4g} N, at {math.degrees(worst.rate):g} deg/s with the line "
            f"{worst.offset:g} m off the middle of its face; {told if bad else 'all points tried are admissible'}"
        )


def _about_damping(study: Study) -> Iterator[str]:
    zeta = study.ground.values["tether.damping_ratio"]
    if zeta == 0.0:
        yield "the scene has no damping: its tugs never die out, and its peaks are bounds, not predictions"
    else:
        yield (
            f"without damping, all else as it is, the peak would be {study.bound.peak:.4g} N, for tugs then never die "
            "out: a bound, not a prediction, and none for the other runs"
        )
    if zeta >= DASHPOT_GOVERNS:
        yield (
            f"with a damping ratio of {zeta:g}, above {DASHPOT_GOVERNS:g}, the largest tension is the dashpot's jump "
            "as the line goes taut: that is the model's, which damps by the rate of stretch, and no line's"
        )


def called(material: object) -> str:
    """Of a material with its form."""
    name, form = getattr(material, "name", ""), getattr(material, "form", "")
    return f"{name} {form}".strip()
