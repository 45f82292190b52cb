"""The folder of a report: its table, what it says for machines, and all else that is put there at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

from dcone_cosim.cases.case import code
from dcone_cosim.cases.commands import publish
from dcone_cosim.cases.table import Column, as_arrow
from dcone_cosim.drafts import PROVENANCE
from dcone_cosim.results import RunResult
from dcone_cosim.run_folder import as_json, csv_head, provenance
from dcone_cosim.scene.data import Scene
from dcone_cosim.scenes.kept import keep
from dcone_cosim.scratch import Scratch


def write_report(
    folder: Path,
    scenes: Sequence[Scene],
    columns: Iterable[Column],
    content: Mapping[str, Any],
    draw: Callable[[Path, Mapping[str, Any]], None],
    started: datetime,
    exit_code: int,
    command: str,
) -> None:
    """Every file under another name first; the provenance, which says that all is there, last.

    scenes     that it is of; one is kept so that it can be run again, of several their texts
    content    of `summary.json`
    draw       puts pictures and the page into a folder, with what the provenance says
    command    that makes the report again
    """
    import pyarrow.csv
    import pyarrow.parquet

    with Scratch(folder) as draft:
        table = as_arrow(list(columns))
        pyarrow.parquet.write_table(table, draft / "table.parquet")
        pyarrow.csv.write_csv(table.rename_columns([csv_head(f) for f in table.schema]), draft / "table.csv")
        (draft / "summary.json").write_text(as_json(content) + "\n", encoding="utf-8")
        if len(scenes) == 1:
            keep(scenes[0], draft)
        else:
            for scene in scenes:
                (draft / f"{scene.name}.toml").write_text(scene.text, encoding="utf-8")
        about = {
            **provenance(RunResult(scenes[0]), {}, started),
            "exit_code": exit_code,
            "code": code(),
            "command": command,
        }
        draw(draft, about)
        files = sorted(path.relative_to(draft) for path in draft.rglob("*") if path.is_file())
        about["files"] = [str(path) for path in files]
        (draft / PROVENANCE).write_text(as_json(about) + "\n", encoding="utf-8")
        publish(draft, [*files, Path(PROVENANCE)], folder)
