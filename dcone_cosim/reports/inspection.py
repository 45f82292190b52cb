"""What a scene puts into its FMUs and what it leaves out, with sizes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING

from dcone_cosim import build
from dcone_cosim.component import Archive
from dcone_cosim.errors import FmuError
from dcone_cosim.master import cannot_begin
from dcone_cosim.progress import Progress
from dcone_cosim.scene import PhaseScene, Scene

if TYPE_CHECKING:
    from rich.console import Console


def show(scene: Scene, console: Console, progress: Progress) -> None:
    from rich.table import Table
    from rich.text import Text

    paths = build.ensure_fmus({phase.name: phase.main.terms for phase in scene.phases}, progress.say)
    for phase in scene.phases:
        title = Text(f"{scene.name}, {phase.name}: {phase.main.model}", style="table.title")
        table = Table(title=title, title_justify="left", box=None, pad_edge=False)
        for header in ("", "term", "what it adds"):
            table.add_column(header, overflow="fold")
        for row in _terms(phase):
            table.add_row(*(Text(cell) for cell in row))
        try:
            with Archive(paths[phase.name]) as archive:
                sizes = _sizes(phase, archive)
        except FmuError as error:
            raise cannot_begin(scene, phase.name, error) from None
        console.print(table)
        for label, text in sizes:
            console.print(f"  {label}: {text}", markup=False, highlight=False, soft_wrap=True)
        console.print()


def _terms(phase: PhaseScene) -> Iterator[tuple[str, str, str]]:
    """What is in the FMU and what is left out: where, the term, what it adds."""
    for group_name, group in build.MODELS[phase.name].groups.items():
        named = phase.main.terms.get(group_name)
        if named is not None:
            yield "in", f"{group_name}: {named}", group.terms[named].summary
        others = [term for term in group.terms if term != named]
        for term in others if group_name != "nodes" else ():
            yield "left out", f"{group_name}: {term}", group.terms[term].summary
        if group_name == "nodes" and named is None:
            yield "left out", "nodes", "position of every node"


STATE_HEAD = 96
"""What a serialised state begins with, before record and work memory (`saved` in fmu_src/packaging/fmi2.c) [bytes]."""


def _sizes(phase: PhaseScene, archive: Archive) -> list[tuple[str, str]]:
    counts = Counter(v.causality for v in archive.variables.values())
    interface = build.MODELS[phase.name].interface(phase.main.terms)
    hidden = sum(v.size for v in interface.variables if v.causality == "state")
    with archive.instantiate(phase.name) as component:
        component.set(phase.main.parameters)
        component.initialise(0.0)
        sizes = [n for n in ("net.nodes", "net.threads") if n in component.variables]
        found = {name.partition(".")[2]: int(v) for name, v in component.get(sizes).items()}
        size = component.state_size() if component.can_save else None
    rows = [(name, str(number)) for name, number in found.items()]
    if size is not None:
        slots = sum(v.size for v in interface.variables)
        work = (size - STATE_HEAD) // 8 - slots
        text = f"{hidden + work:,} numbers kept from step to step: {work:,} of work memory, {hidden} others"
        if "nodes" in found:
            text += f"; among them position and velocity of every node, {6 * found['nodes']:,}"
        rows.append(("states", text))
    rows.append(
        ("variables", f"{len(archive.variables):,}: " + ", ".join(f"{n:,} {c}s" for c, n in sorted(counts.items())))
    )
    if size is not None:
        rows.append(("one instance", f"{size:,} bytes, its variables and states"))
    rows.append(("FMU", f"{archive.path.stat().st_size:,} bytes"))
    return rows
