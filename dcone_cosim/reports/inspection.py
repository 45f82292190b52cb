"""What a scene puts into its FMUs and what it leaves out, with sizes; and what is known of FMUs from elsewhere."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING

from dcone_cosim import build
from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.master import cannot_begin
from dcone_cosim.progress import Progress
from dcone_cosim.scenes.scene import ComponentScene, PhaseScene, Scene
from dcone_cosim.scenes.units import spoken

if TYPE_CHECKING:
    from rich.console import Console


def show(scene: Scene, console: Console, progress: Progress) -> None:
    for phase in scene.phases:
        for component in phase.components:
            if component.fmu is None:
                _show_ours(scene, phase, component, console, progress)
            else:
                _show_other(scene, phase, component, console)
        _show_coupling(phase, console)


def _title(scene: Scene, phase: PhaseScene, component: ComponentScene, model: str) -> str:
    which = "" if component is phase.main else f", {component.name}"
    return f"{scene.name}, {phase.name}{which}: {model}{', isolated' if component.isolate else ''}"


def _show_ours(
    scene: Scene, phase: PhaseScene, component: ComponentScene, console: Console, progress: Progress
) -> None:
    from rich.table import Table
    from rich.text import Text

    with progress.working("building"):
        (path,) = build.ensure([(component.model, component.terms)], progress.say)
    title = Text(_title(scene, phase, component, component.model), style="table.title")
    table = Table(title=title, title_justify="left", box=None, pad_edge=False)
    for header in ("", "term", "what it adds"):
        table.add_column(header, overflow="fold")
    for row in _terms(component):
        table.add_row(*(Text(cell) for cell in row))
    try:
        with Archive(path) as archive:
            sizes = _sizes(component, archive)
    except FmuError as error:
        raise cannot_begin(scene, phase.name, error) from None
    console.print(table)
    _rows(sizes, console)


def _show_other(scene: Scene, phase: PhaseScene, component: ComponentScene, console: Console) -> None:
    from rich.text import Text

    assert component.fmu is not None
    with Archive(component.fmu) as archive:
        about = archive.description
        console.print(Text(_title(scene, phase, component, about.modelName), style="table.title"))
        platforms = sorted({p.parent.name for p in (archive.folder or component.fmu).glob("binaries/*/*")})
        rows = [
            ("file", str(component.fmu)),
            ("says of itself", about.description or "nothing"),
            ("made by", about.generationTool or "not told"),
            ("binaries", ", ".join(platforms)),
            ("its state can be saved", "yes" if archive.can_save else "no"),
            ("variables", _counted(archive)),
            ("FMU", f"{component.fmu.stat().st_size:,} bytes"),
        ]
    given = [f"{name} = {value:g}" for name, value in component.parameters.items()]
    if given:
        rows.insert(4, ("set by the scene, SI", ", ".join(given)))
    _rows(rows, console)


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
        for term in others if group_name != "nodes" else ():
            yield "left out", f"{group_name}: {term}", group.terms[term].summary
        if group_name == "nodes" and named is None:
            yield "left out", "nodes", "position of every node"


STATE_HEAD = 96
"""What a serialised state begins with, before record and work memory (`saved` in fmu_src/packaging/fmi2.c) [bytes]."""


def _counted(archive: Archive) -> str:
    counts = Counter(v.causality for v in archive.variables.values())
    return f"{len(archive.variables):,}: " + ", ".join(f"{n:,} {c}s" for c, n in sorted(counts.items()))


def _sizes(component: ComponentScene, archive: Archive) -> list[tuple[str, str]]:
    interface = build.CATALOGUE[component.model].interface(component.terms)
    hidden = sum(v.size for v in interface.variables if v.causality == "state")
    with archive.instantiate(component.name) as instance:
        instance.set(component.parameters)
        instance.initialise(0.0)
        sizes = [n for n in ("net.nodes", "net.threads") if n in instance.variables]
        found = {name.partition(".")[2]: int(v) for name, v in instance.get(sizes).items()}
        size = instance.state_size() if instance.can_save else None
    rows = [(name, str(number)) for name, number in found.items()]
    if size is not None:
        slots = sum(v.size for v in interface.variables)
        work = (size - STATE_HEAD) // 8 - slots
        text = f"{hidden + work:,} numbers kept from step to step: {work:,} of work memory, {hidden} others"
        if "nodes" in found:
            text += f"; among them position and velocity of every node, {6 * found['nodes']:,}"
        rows.append(("states", text))
    rows.append(("variables", _counted(archive)))
    if size is not None:
        rows.append(("one instance", f"{size:,} bytes, its variables and states"))
    rows.append(("FMU", f"{archive.path.stat().st_size:,} bytes"))
    return rows
