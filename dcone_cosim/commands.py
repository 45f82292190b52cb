"""One command from beginning to end: scene, FMUs, run, results."""

from __future__ import annotations

import shutil
import threading
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from dcone_cosim import build
from dcone_cosim.component import Archive, Component
from dcone_cosim.errors import InputError
from dcone_cosim.master import RunResult, run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.reports import style, summary
from dcone_cosim.run import check_free, default_folder, write
from dcone_cosim.scene import Scene, load


class Archives:
    """The unpacked FMU of every phase of a scene; closing removes the temporary folders."""

    def __init__(self, scene: Scene, progress: Progress) -> None:
        paths = build.ensure_fmus({phase.name: phase.terms for phase in scene.phases}, progress.say)
        self._of: dict[str, Archive] = {}
        try:
            for phase, path in paths.items():
                self._of[phase] = Archive(path)
        except BaseException:
            self.close()
            raise

    def instantiate(self, phase: str, name: str) -> Component:
        return self._of[phase].instantiate(name)

    def facts(self) -> dict[str, dict[str, Any]]:
        """What identifies each FMU, for the provenance."""
        return {
            phase: {
                "file": archive.path.name,
                "sha256": archive.sha256,
                "guid": archive.guid,
                "model": archive.description.modelName,
                "generation_tool": archive.description.generationTool,
            }
            for phase, archive in self._of.items()
        }

    def __enter__(self) -> Archives:
        return self

    def close(self) -> None:
        for archive in self._of.values():
            archive.close()

    def __exit__(self, *_: object) -> None:
        self.close()


def run_and_write(
    name: str,
    out: Path | None,
    progress: Progress,
    with_csv: bool = False,
    with_figures: bool = True,
    force: bool = False,
) -> tuple[RunResult, Path]:
    """Run a scene and write its folder; returns the result and the folder. Bad input raises and leaves nothing."""
    started = datetime.now(UTC)
    scene = load(name)
    folder = out if out is not None else default_folder(scene.name)
    check_free(folder, force)
    if with_figures:
        threading.Thread(target=style.load, daemon=True).start()
    with Archives(scene, progress) as archives:
        result = run_scene(scene, archives.instantiate, progress)
        facts = archives.facts()

    def draw(draft: Path) -> None:
        from dcone_cosim.reports.figures import draw_all

        progress.say("drawing")
        draw_all(result, draft)

    write(result, folder, facts, summary.as_dict(result), started, with_csv, draw if with_figures else None)
    return result, folder


def write_fmus(name: str, out: Path, progress: Progress) -> list[Path]:
    """Copy the FMUs of a scene to a folder under readable names."""
    scene = load(name)
    if out.exists() and not out.is_dir():
        raise InputError(f"{out} is not a folder")
    terms = {phase.name: phase.terms for phase in scene.phases}
    built = build.ensure_fmus(terms, progress.say)
    out.mkdir(parents=True, exist_ok=True)
    return [Path(shutil.copyfile(fmu, out / build.readable_name(phase, terms[phase]))) for phase, fmu in built.items()]
