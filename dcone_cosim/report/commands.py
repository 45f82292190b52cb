"""`dcone report` and `dcone replay`: the page of a run, put in its folder or elsewhere."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from dcone_cosim import placed
from dcone_cosim.drafts import PROVENANCE, check_folder
from dcone_cosim.errors import InputError
from dcone_cosim.progress import Progress
from dcone_cosim.redrawing import list_files
from dcone_cosim.report.links import COMMANDS, REPLAY, REPORT, Linked
from dcone_cosim.report.page import of_folder
from dcone_cosim.run_folder import as_csv, histories_of
from dcone_cosim.scratch import Scratch

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "microsoft-edge")
"""Programs that print a page."""
PATIENCE = 120.0
"""How long a print may take [s]."""
LARGEST = 1_000_000
"""Values of a table that is written as CSV unasked: some 17 MB, a tenth of a second."""


def linked(sizing: Path | None, accuracy: Path | None, stability: Path | None) -> list[Linked]:
    """Reports that belong to a run, read from their folders; `InputError` where one is none."""
    named = zip(COMMANDS, (sizing, accuracy, stability), strict=True)
    return [Linked.read(kind, folder) for kind, folder in named if folder is not None]


def write_page(
    run: Path,
    out: Path | None,
    progress: Progress,
    also: Sequence[Linked] = (),
    whole: bool = True,
    pdf: bool = False,
    live: bool = False,
    up: str = "",
    csv: bool | None = None,
) -> list[Path]:
    """Write the page of the run of a folder, and print it if asked; where both are.

    out      the file; in the folder of the run if not given, and then a file of that run
    whole    all of it, otherwise the replay alone
    up       address of the index that the page is of
    csv      the histories as CSV beside it; None for those that are not large, where the page is in the run's folder
    live     with the model in it, whose library is built if it is not in the cache
    """
    name = REPORT if whole else REPLAY
    path = run / name if out is None else out / name if out.is_dir() else out
    if path.suffix != ".html":
        raise InputError(f"{path} is not a name for a page: expected one that ends in .html")
    browser = _browser() if pdf else ""
    with progress.working("writing"):
        progress.say("reading the run")
        check_folder(path.parent)
        path.parent.mkdir(parents=True, exist_ok=True)
        own = path.parent.samefile(run)
        sizes = histories_of(run) if whole else {}
        tables = [name for name, size in sizes.items() if (own and size <= LARGEST if csv is None else csv)]
        beside = {name: name in tables for name in sizes} if tables else {}
        text = of_folder(run, path, also, whole, progress if live else None, up, beside)
        with Scratch(path.parent) as draft:
            (draft / path.name).write_text(text, encoding="utf-8")
            files = [path.name]
            if pdf:
                progress.say("printing")
                files.append(_print(browser, draft / path.name).name)
            files += [as_csv(run, name, draft) for name in tables]
            if own:
                list_files(run, files, draft / PROVENANCE)
            return [placed.put(draft / one, path.parent / one) for one in files]


def _browser() -> str:
    found = next(filter(None, map(shutil.which, BROWSERS)), None)
    if found is None:
        raise InputError(f"--pdf: nothing here prints a page; expected one of {', '.join(BROWSERS)} on the path")
    return found


def _print(browser: str, page: Path) -> Path:
    """The page as a PDF beside it."""
    path = page.with_suffix(".pdf")
    command = [
        browser,
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        f"--user-data-dir={page.parent / 'browser'}",
        "--virtual-time-budget=10000",
        "--no-pdf-header-footer",
        f"--print-to-pdf={path}",
        page.absolute().as_uri(),
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
    if not path.is_file():
        raise InputError(f"--pdf: {browser} printed nothing: {done.stderr.strip()[-300:]}")
    return path
