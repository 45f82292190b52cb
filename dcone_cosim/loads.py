"""What each line of a run bore: stress, strain, and the margin to its strength; and what that makes of the run.

    margin of safety = sigma / sigma_applied - 1        of the strength itself: no factor of safety is taken

A run one of whose lines bore more than it can has the status "overloaded": nothing broke in the model where in truth it
would have. One whose line broke in the model has "broken". Both are told before anything else.

Checked  tests/cosim/test_loads.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from dcone_cosim import build
from dcone_cosim.errors import OVERLOADED, SUCCESS
from dcone_cosim.findings import Finding
from dcone_cosim.phases import kind_of
from dcone_cosim.results import PhaseResult, RunResult
from dcone_cosim.scene.data import ComponentScene, LineScene
from orbital.materials import MATERIALS, Material, margin_of_safety, nearest_in_stiffness, stress

STATUS_OVERLOADED, STATUS_BROKEN = "overloaded", "broken"
SCATTERS_AS = {"line": "largest_tug_peak", "thread": "thread.tension_max", "cord": "cord.tension_max"}
"""Figure of the summary whose spread is that of a line's largest tension."""
LOCATED = 1e-6
"""Share of its strength to which the instant of a line's break is located: a margin below it is none."""
SIGMAS = 2.0
"""Standard deviations within which one sample of many is taken to stand for all."""


@dataclass(frozen=True)
class Load:
    """What a line bore.

    phase        in which
    line         which
    scene        what the scene says of it
    tension      largest                                                     [N]
    stress       over its section; None: nothing tells the section           [Pa]
    strain       of the model's line; None: nothing tells its stiffness      [1]
    strength     at which it breaks; None: not known                         [Pa]
    breaks_at    load at which it breaks; None: not known                    [N]
    broke        when it broke in the model; None: it did not                [s]
    broken       how many of its kind did                                    [1]
    may_break    whether it can break in the model
    spread       standard deviation over mean of the tension, 0 for no sample of many  [1]
    likely       fibre that it may be of, where none is named
    """

    phase: str
    line: build.Line
    scene: LineScene
    tension: float
    stress: float | None
    strain: float | None
    strength: float | None
    breaks_at: float | None
    broke: float | None
    broken: int
    may_break: bool
    spread: float
    likely: Material

    @property
    def overloaded(self) -> bool:
        """Whether it bore more than it can, and held."""
        return not self.may_break and self.breaks_at is not None and self.tension > self.breaks_at

    @property
    def margin(self) -> float | None:
        """Margin of safety; None where the strength is not known, or nothing was borne."""
        if self.breaks_at is None or not self.tension > 0.0:
            return None
        return margin_of_safety(self.breaks_at, self.tension)

    @property
    def margin_spread(self) -> float:
        """Standard deviation over mean of the margin, 0 for no sample of many [1]."""
        margin = self.margin
        return self.spread * (1.0 + margin) / abs(margin) if margin else self.spread

    @property
    def failed(self) -> bool:
        """Whether it broke, or would have in truth."""
        return self.overloaded or self.broke is not None

    @property
    def where(self) -> str:
        return f"[{self.phase}.{self.line.table}]"

    @property
    def lacks_section(self) -> str:
        """What to do where nothing tells its section."""
        wanted = "a material or a diameter" if self.line.stiffness else "a diameter"
        return f"section not known: name {wanted} in {self.where}"


def of_phase(run: RunResult, name: str) -> list[Load]:
    """What each line of a phase bore of which its FMU tells the tension."""
    phase = next(phase for phase in run.scene.phases if phase.name == name)
    result, main = run.phases[name], phase.main
    if not len(result.recorder):
        return []
    values = {**run.parameters.get(name, {}), **run.inputs.get(name, {}), **main.numbers}
    terms = main.terms if main.fmu is None else {}
    kind = kind_of(name)
    spreads = kind.spreads(run, result)
    found = []
    for line in build.lines(kind.model, terms):
        tension = _largest(result, line)
        if tension is not None:
            spread = spreads.get(SCATTERS_AS.get(line.name, ""), 0.0)
            found.append(_load(name, line, main, values, terms, tension, result, spread))
    return found


def of_run(run: RunResult) -> list[Load]:
    """Of all its phases."""
    return [load for name in run.phases for load in of_phase(run, name)]


def _largest(result: PhaseResult, line: build.Line) -> float | None:
    recorder = result.recorder
    output = next((name for name in line.tension if name in recorder), None)
    if output is None:
        return None
    peaks = [peak for _, peak, _ in result.tugs.rows.values()] if result.tugs is not None else []
    return max([float(np.max(recorder[output])), *peaks])


def _load(
    phase: str,
    line: build.Line,
    main: ComponentScene,
    values: Mapping[str, float],
    terms: Mapping[str, str],
    tension: float,
    result: PhaseResult,
    spread: float,
) -> Load:
    scene = main.lines.get(line.table, LineScene())
    area = line.section(values, terms, scene.material, scene.diameter)
    stiffness = line.axial_stiffness(values, area)
    may_break = line.breaks_at in values
    breaks_at = values[line.breaks_at] if may_break else _times(scene.strength, area)
    last = result.recorder.last()
    broken = int(last.get(line.broken[0], 0)) if line.broken is not None else 0
    broke = last[line.broken[1]] if line.broken is not None and broken else None
    return Load(
        phase,
        line,
        scene,
        tension,
        None if area is None else stress(tension, area),
        None if stiffness is None else tension / stiffness,
        breaks_at / area if breaks_at is not None and area is not None else scene.strength,
        breaks_at,
        broke,
        broken,
        may_break,
        spread,
        _likely(line, values, main),
    )


def _likely(line: build.Line, values: Mapping[str, float], main: ComponentScene) -> Material:
    """The fibre nearest in stiffness; of a line whose section is not known its usual one, or, if its stiffness is the
    scene's, the one that bears least strain."""
    if line.modulus in values:
        return nearest_in_stiffness(values[line.modulus])
    if line.usual_material and line.stiffness not in main.parameters:
        return MATERIALS[line.usual_material]
    return min(MATERIALS.values(), key=lambda fibre: fibre.strain_at_break or math.inf)


def _times(strength: float | None, area: float | None) -> float | None:
    return None if strength is None or area is None else strength * area


NAMED = {"youngs_modulus": "Young's modulus"}
"""What some keys are called in words."""


def made_of(scene: LineScene) -> str:
    """The material of a line in words, "" where none is named."""
    material = scene.material
    if material is None:
        return ""
    apart = [name.partition(".")[2] for name in scene.apart]
    words = ", ".join(NAMED.get(name, name.replace("_", " ")) for name in apart)
    own = f"; {words} as the scene has it" if apart else ""
    return f"{material.name}, {material.form}{own}"


def told_of(component: ComponentScene, where: str) -> list[tuple[str, str]]:
    """Of what the lines of a component are, where each figure stands, and what the scene says otherwise: label, text.

    where    its tables stand in the scene
    """
    found = []
    for table, scene in component.lines.items():
        material = scene.material
        if material is None:
            continue
        found.append((f"[{where}.{table}]", f"{material.name}, {material.form}"))
        for source in dict.fromkeys(material.sources.values()):
            of = ", ".join(figure.replace("_", " ") for figure, its in material.sources.items() if its == source)
            found.append((f"  {of}", source))
        for name, value in scene.apart.items():
            found.append((f"  {where}.{name}", f"as the scene says; the material has {value:.6g}, SI"))
        if material.damping_ratio is None:
            found.append(("  damping ratio", "of no source: as the scene says, or the model's default"))
    return found


def implied(component: ComponentScene, values: Mapping[str, float]) -> Iterator[build.Implied]:
    """What the materials of a component's lines come to.

    values    every parameter and input by FMI name, SI
    """
    for line in build.lines(component.model, component.terms):
        scene = component.lines.get(line.table)
        if scene is None:
            continue
        area = line.section(values, component.terms, scene.material, scene.diameter)
        breaks_at = values.get(line.breaks_at, _times(scene.strength, area))
        if breaks_at is not None:
            yield build.Implied(f"{line.name}.breaking_load", f"load at which {line.label} breaks", breaks_at, "N")
        if area is not None and scene.material is not None:
            per_metre = scene.material.density * area
            yield build.Implied(f"{line.name}.mass_per_metre", f"mass of {line.label}, per metre", per_metre, "kg/m")


def findings(run: RunResult, name: str) -> Iterator[Finding]:
    """Stress, strain and margin of each line of a phase."""
    for load in of_phase(run, name):
        line = load.line
        key, what = line.name, line.label
        if load.scene.material is not None:
            yield Finding(name, f"{key}.material", f"{what} is of", made_of(load.scene))
        if load.stress is None:
            yield Finding(name, f"{key}.stress", f"largest stress of {what}", load.lacks_section)
        else:
            yield Finding(
                name, f"{key}.stress", f"largest stress of {what}", load.stress, "Pa", load.spread, shown_in="MPa"
            )
        if load.strain is not None:
            yield Finding(name, f"{key}.strain", f"strain of {what}", load.strain, "", load.spread, shown_in="%")
        if load.strength is not None:
            yield Finding(name, f"{key}.strength", f"strength of {what}", load.strength, "Pa", shown_in="MPa")
        yield _of_margin(name, key, load)


def _of_margin(name: str, key: str, load: Load) -> Finding:
    label, margin = f"margin of safety of {load.line.label} (factor 1)", load.margin
    if margin is not None:
        if abs(margin) < LOCATED:
            return Finding(name, f"{key}.margin_of_safety", label, 0.0)
        return Finding(name, f"{key}.margin_of_safety", label, margin, "", load.margin_spread)
    if load.breaks_at is None:
        unknown = f"strength not known: name a material in {load.where}"
        text = unknown if load.strength is None else load.lacks_section
        return Finding(name, f"{key}.margin_of_safety", label, text)
    return Finding(name, f"{key}.margin_of_safety", label, "it bore nothing")


def headlines(run: RunResult) -> list[str]:
    """What is told before anything else: lines that bore more than they can, and lines that broke."""
    found = []
    for load in of_run(run):
        what = f"{load.phase}: {load.line.label}"
        of = made_of(load.scene)
        of = f" ({of})" if of else ""
        if load.overloaded:
            assert load.breaks_at is not None
            sample = ", one sample of many" if load.spread else ""
            found.append(
                f"OVERLOADED: {what}{of} bore {load.tension:.4g} N{sample}, and breaks at {load.breaks_at:.4g} N: "
                "in truth it would have broken, and what follows is not to be trusted"
            )
        elif load.broke is not None:
            more = f"; {load.broken} of them in all" if load.broken > 1 else ""
            found.append(f"BROKEN: {what}{of} broke at {load.broke:.6g} s, at {load.breaks_at:.4g} N{more}")
    return found


def judge(run: RunResult) -> None:
    """Give the run the status that its loads make, unless it failed otherwise."""
    if run.exit_code != SUCCESS:
        return
    loads, told = of_run(run), "\n".join(headlines(run))
    if any(load.overloaded for load in loads):
        run.fail(STATUS_OVERLOADED, told, OVERLOADED)
    elif any(load.broke is not None for load in loads):
        run.fail(STATUS_BROKEN, told, SUCCESS)


def warnings(run: RunResult, name: str) -> Iterator[str]:
    """Lines that another sample may overload, and lines of which no strength is known that any fibre would not bear."""
    for load in of_phase(run, name):
        what = f"{load.phase}: {load.line.label}"
        if load.breaks_at is not None and not load.overloaded and not load.may_break:
            if load.tension * (1.0 + SIGMAS * load.spread) > load.breaks_at:
                yield (
                    f"{what} bore {load.tension:.3g} N of the {load.breaks_at:.3g} N at which it breaks, and that is "
                    f"one sample of many: they scatter by {100.0 * load.spread:.2g} %, and others may break it"
                )
        elif load.breaks_at is None and load.strain is not None:
            limit = load.likely.strain_at_break
            if limit is not None and load.strain > limit:
                yield (
                    f"{what} bore {load.tension:.3g} N, which is {100.0 * load.strain:.3g} % of its E A; "
                    f"{load.likely.name}, of which it may be, breaks at {100.0 * limit:.3g} %, but nothing breaks in "
                    f"this model: name a material in {load.where}, and it is judged by that strength"
                )
