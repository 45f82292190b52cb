"""What a scene puts into its FMUs and what it leaves out, with sizes."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from dcone_cosim import build
from dcone_cosim.component import Archive
from dcone_cosim.progress import Progress
from dcone_cosim.scene import PhaseScene, Scene

if TYPE_CHECKING:
    from rich.console import Console


def show(scene: Scene, console: Console, progress: Progress) -> None:
    from rich.table import Table

    paths = build.ensure_fmus({phase.name: phase.terms for phase in scene.phases}, progress.say)
    for phase in scene.phases:
        table = Table(
            title=f"{scene.name}, {phase.name}: {phase.model}", title_justify="left", box=None, pad_edge=False
        )
        for header in ("", "term", "what it adds"):
            table.add_column(header, overflow="fold")
        for group_name, group in build.MODELS[phase.name].groups.items():
            named = phase.terms.get(group_name)
            if named is not None:
                table.add_row("in", f"{group_name}: {named}", group.terms[named].summary)
            others = [term for term in group.terms if term != named]
            for term in others if group_name != "nodes" else ():
                table.add_row("left out", f"{group_name}: {term}", group.terms[term].summary)
            if group_name == "nodes" and named is None:
                table.add_row("left out", "nodes", "position of every node")
        with Archive(paths[phase.name]) as archive:
            sizes = _sizes(phase, archive)
        console.print(table)
        for label, text in sizes:
            console.print(f"  {label}: {text}", markup=False, highlight=False)
        console.print()


def _sizes(phase: PhaseScene, archive: Archive) -> list[tuple[str, str]]:
    counts = Counter(v.causality for v in archive.variables.values())
    interface = build.MODELS[phase.name].interface(phase.terms)
    hidden = sum(v.size for v in interface.variables if v.causality == "state")
    with archive.instantiate(phase.name) as component:
        component.set(phase.parameters)
        component.initialise(0.0)
        sizes = [n for n in ("net.nodes", "net.threads") if n in component.variables]
        rows = [(name.partition(".")[2], f"{int(v)}") for name, v in component.get(sizes).items()]
        if component.can_save:
            rows.append(("one instance", f"{component.state_size():,} bytes, its state and work memory"))
    rows.append(("kept by the kernels", f"{hidden} numbers besides the work memory"))
    rows.append(("variables", f"{len(archive.variables)}: " + ", ".join(f"{n} {c}" for c, n in sorted(counts.items()))))
    rows.append(("FMU", f"{archive.path.stat().st_size:,} bytes"))
    return rows
