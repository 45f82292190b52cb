"""What a scene puts into its FMUs, what it leaves out and what it implies; and what is known of FMUs from elsewhere."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from dcone_cosim import build, loads
from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import Component
from dcone_cosim.master import cannot_begin
from dcone_cosim.phases import kind_of
from dcone_cosim.progress import Progress
from dcone_cosim.scene.data import ComponentScene, PhaseScene, Scene
from dcone_cosim.scene_fmus import isolated, opened
from dcone_cosim.units import spoken

if TYPE_CHECKING:
    from rich.console import Console


@dataclass
class About:
    """What is known of a component.

    terms      what is in the FMU and what is left out: "in" or "left out", the term, what it adds
    facts      label and text
    implied    what the scene's values come to
    isolated   whether it is run in a process of its own
    """

    title: str
    phase: str
    component: str
    model: str
    terms: list[tuple[str, str, str]] = field(default_factory=list)
    facts: list[tuple[str, str]] = field(default_factory=list)
    implied: list[build.Implied] = field(default_factory=list)
    isolated: bool = False


def show(scene: Scene, console: Console, progress: Progress) -> None:
    for phase in scene.phases:
        for component in phase.components:
            _show(_about(scene, phase, component, progress), console)
        _show_coupling(phase, console)


def as_dict(scene: Scene, progress: Progress) -> dict[str, Any]:
    """For machines: every component with its terms, and `implied: {key: {label, value, unit}}`, SI."""
    components = []
    for phase in scene.phases:
        for component in phase.components:
            about = _about(scene, phase, component, progress)
            components.append(
                {
                    "phase": about.phase,
                    "component": about.component,
                    "model": about.model,
                    "terms": {
                        where: [term for place, term, _ in about.terms if place == where]
                        for where in ("in", "left out")
                    },
                    "facts": dict(about.facts),
                    "implied": {
                        row.key: {"label": row.label, "value": row.value, "unit": row.unit} for row in about.implied
                    },
                }
            )
    return {"scene": scene.name, "title": scene.title, "warnings": list(scene.cautions), "components": components}


def _about(scene: Scene, phase: PhaseScene, component: ComponentScene, progress: Progress) -> About:
    of = _ours(scene, phase, component, progress) if component.fmu is None else _other(phase, component)
    which = "" if component is phase.main else f", {component.name}"
    of.title = f"{scene.name}, {phase.name}{which}: {of.model}{', isolated' if of.isolated else ''}"
    return of


def _ours(scene: Scene, phase: PhaseScene, component: ComponentScene, progress: Progress) -> About:
    with progress.working("building"):
        (path,) = build.ensure([(component.model, component.terms)], progress.say)
    about = About("", phase.name, component.name, component.model, list(_terms(component)))
    about.isolated = bool(component.isolate)
    values = {**component.defaults, **component.parameters}
    if component is phase.main:
        place = scene.phases.index(phase)
        values |= kind_of(phase.name).values_taken(scene.phases[place - 1]) if place else {}
        about.implied += build.implied(component.model, {**values, **component.asked}, component.terms)
        about.implied += loads.implied(component, values)
    try:
        with opened(path, component) as archive:
            about.facts, more = _sizes(phase, component, archive)
    except FmuError as error:
        raise cannot_begin(scene, phase.name, error) from None
    about.facts += loads.told_of(component, phase.name)
    about.implied += more
    return about


def _other(phase: PhaseScene, component: ComponentScene) -> About:
    assert component.fmu is not None
    with Archive(component.fmu) as archive:
        about = archive.description
        platforms = sorted({p.parent.name for p in (archive.folder or component.fmu).glob("binaries/*/*")})
        rows = [
            ("file", str(component.fmu)),
            ("says of itself", about.description or "nothing"),
            ("made by", about.generationTool or "not stated"),
            ("binaries", ", ".join(platforms)),
            ("its state can be saved", "yes" if archive.can_save else "no"),
            ("variables", _counted(archive)),
            ("FMU", f"{component.fmu.stat().st_size:,} bytes"),
        ]
        name, apart = about.modelName, isolated(component, archive)
    given = [f"{name} = {value:g}" for name, value in component.parameters.items()]
    if given:
        rows.insert(4, ("set by the scene, SI", ", ".join(given)))
    return About("", phase.name, component.name, name, [], rows, isolated=apart)


def _show(about: About, console: Console) -> None:
    from rich.table import Table
    from rich.text import Text

    title = Text(about.title, style="table.title")
    if about.terms:
        table = Table(title=title, title_justify="left", box=None, pad_edge=False)
        for header in ("", "term", "what it adds"):
            table.add_column(header, overflow="fold")
        for row in about.terms:
            table.add_row(*(Text(cell) for cell in row))
        console.print(table)
    else:
        console.print(title)
    _rows(about.facts, console)
    if about.implied:
        console.print("  what that comes to:", highlight=False)
        table = Table(show_header=False, box=None, pad_edge=False, padding=(0, 2, 0, 0))
        table.add_column(no_wrap=True)
        table.add_column(no_wrap=True, justify="right")
        table.add_column(no_wrap=True)
        for implied in about.implied:
            table.add_row(Text(f"    {implied.label}"), *map(Text, _number(implied.value, implied.unit)))
        console.print(table)
        console.print()


SMALL = {
    "m": ("mm", 1e3, 0.1),
    "m2": ("mm2", 1e6, 1e-2),
    "kg": ("g", 1e3, 0.1),
    "s": ("ms", 1e3, 0.1),
    "m/s": ("mm/s", 1e3, 0.1),
    "N": ("mN", 1e3, 0.1),
    "kg/m": ("g/m", 1e3, 0.1),
}
"""In which unit a small value is shown, how many of it make the SI unit, and below which SI value."""


def _number(value: float, unit: str) -> tuple[str, str]:
    """A value and its unit as a person reads them."""
    shown, factor, below = SMALL.get(unit, (unit, 1.0, 0.0))
    if unit == "1":
        return f"{value:,.0f}", ""
    return (f"{factor * value:.6g}", spoken(shown)) if abs(value) < below else (f"{value:.6g}", spoken(unit))


def _show_coupling(phase: PhaseScene, console: Console) -> None:
    if not phase.connections:
        return
    coupling = phase.coupling
    step = f"{coupling.step or phase.macro_step:g} {spoken('s')}"
    console.print(f"  {phase.name}, coupled: {coupling.method}, {coupling.control} steps of {step}", highlight=False)
    for c in phase.connections:
        line = f"    {c.source}.{c.output} -> {c.target}.{c.input}"
        console.print(line, markup=False, highlight=False, soft_wrap=True)
    console.print()


def _rows(rows: list[tuple[str, str]], console: Console) -> None:
    for label, text in rows:
        console.print(f"  {label}: {text}", markup=False, highlight=False, soft_wrap=True)
    console.print()


def _terms(component: ComponentScene) -> Iterator[tuple[str, str, str]]:
    """What is in the FMU and what is left out: where, the term, what it adds."""
    for group_name, group in build.CATALOGUE[component.model].groups.items():
        named = component.terms.get(group_name)
        if named is not None:
            yield "in", f"{group_name}: {named}", group.terms[named].summary
        others = [term for term in group.terms if term != named]
        for term in others if group_name not in build.FAMILIES else ():
            yield "left out", f"{group_name}: {term}", group.terms[term].summary
        if group_name in build.FAMILIES and named is None:
            yield "left out", group_name, build.FAMILIES[group_name].summary


STEPS = ("solver.stability_bound", "solver.substep")
"""Outputs of a model that tell how it will step."""


def _counted(archive: Archive) -> str:
    counts = Counter(v.causality for v in archive.variables.values())
    return f"{len(archive.variables):,}: " + ", ".join(f"{n:,} {c}s" for c, n in sorted(counts.items()))


def _sizes(
    phase: PhaseScene, component: ComponentScene, archive: Archive
) -> tuple[list[tuple[str, str]], list[build.Implied]]:
    """What an instance says of itself: sizes, and how it will step."""
    interface = build.CATALOGUE[component.model].interface(component.terms)
    hidden = sum(v.size for v in interface.variables if v.causality == "state")
    with Component(archive, component.name) as instance:
        instance.set(component.parameters)
        instance.initialise(0.0)
        sizes = [n for n in ("net.nodes", "net.threads") if n in instance.variables]
        found = {name.partition(".")[2]: int(v) for name, v in instance.get(sizes).items()}
        told = instance.get([name for name in STEPS if name in instance.variables])
        size = instance.state_size() if instance.can_save else None
    rows = [(name, str(number)) for name, number in found.items()]
    if size is not None:
        slots = sum(v.size for v in interface.variables)
        work = (size - build.STATE_HEAD) // 8 - slots
        text = f"{hidden + work:,} numbers kept from step to step: {work:,} of work memory, {hidden} others"
        if "nodes" in found:
            text += f"; among them position and velocity of every node, {6 * found['nodes']:,}"
        rows.append(("states", text))
    rows.append(("variables", _counted(archive)))
    if size is not None:
        rows.append(("one instance", f"{size:,} bytes, its variables and states"))
    rows.append(("FMU", f"{archive.path.stat().st_size:,} bytes"))
    labels = {v.name: v.description for v in interface.variables}
    return rows, list(_steps(told, labels, phase.duration))


def _steps(told: Mapping[str, float], labels: Mapping[str, str], duration: float) -> Iterator[build.Implied]:
    for name in told:
        yield build.Implied(name, labels[name], told[name], "s")
    if "solver.substep" in told and "solver.substep_mean" not in labels:  # else it changes on the way
        count = duration / told["solver.substep"]
        yield build.Implied("solver.substeps", "substeps of the whole phase, at most", count, "1")
