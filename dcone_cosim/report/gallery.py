"""`dcone gallery`: scenes run one after the other, a page of each, and an index of them.

    index.html     one card a scene: picture, title, answer
    NAME.html      its page          runs/NAME/    its run

What is there already stays: the same command goes on with what is missing. A phase longer than a day is cut to it, and
the page says so, as it says all that was changed.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dcone_cosim import campaigns, placed
from dcone_cosim.commands import run_and_write
from dcone_cosim.drafts import check_folder
from dcone_cosim.errors import DconeError
from dcone_cosim.loading import load, named, shipped
from dcone_cosim.progress import Progress
from dcone_cosim.report import tiles
from dcone_cosim.report.commands import write_page
from dcone_cosim.report.live import NET
from dcone_cosim.report.page import answer_of
from dcone_cosim.reports import pages
from dcone_cosim.results import RunResult
from dcone_cosim.run_reading import read_run
from dcone_cosim.scratch import Scratch

INDEX = "index.html"
ANSWERS = Path(campaigns.__file__).with_name("answers.json")
"""What the campaigns that come with the program came to, from their stored evidence."""
DAY = 86400.0
GROUPS = ("Shot, capture and tow", "Shot and capture", "Tows", "Runs that fail, or whose lines do not bear it")
"""Headings of the index, in order."""
COMPLETED = "completed"
CARD = (
    "capture_in_space.png",
    "tether_tension.png",
    "second_tow_tension.png",
    "orbital_radius.png",
    "mouth_and_energies.png",
)
"""Pictures of a run of which a card has the first that there is."""


def make(scenes: Sequence[str], out: Path, progress: Progress, full: bool = False) -> tuple[Path, Mapping[str, str]]:
    """Run the scenes that have no page yet, write their pages and the index; where that is, and which failed, and why.

    scenes    by name or path; all that are shipped if there are none
    full      run long phases to their end
    """
    names = list(scenes) or list(shipped())
    known = {named(name).name: name for name in names}
    check_folder(out)
    out.mkdir(parents=True, exist_ok=True)
    failed = {}
    for number, (name, scene) in enumerate(known.items(), start=1):
        folder, page = out / "runs" / name, out / f"{name}.html"
        progress.say(f"{number} of {len(known)}: {name}")
        try:
            if not folder.is_dir():
                run_and_write(scene, folder, progress, settings=[] if full else cuts(scene), replay=True)
            if not page.is_file():
                write_page(folder, page, progress, live=True, up=INDEX)
        except DconeError as error:
            failed[name] = str(error)
    return _index(out, [name for name in known if name not in failed]), failed


def cuts(scene: str) -> list[str]:
    """Settings that cut every phase of a scene that is longer than a day.

    Checked  tests/report/test_gallery.py
    """
    return [f"{phase.name}.duration=1 day" for phase in load(scene).phases if phase.duration > DAY]


def _index(out: Path, names: Sequence[str]) -> Path:
    """The index of all that has a page."""
    cards = [_card(out, name) for name in names]
    with Scratch(out) as draft:
        groups = [(name, [card for card in cards if card["group"] == name]) for name in GROUPS]
        groups = [(name, found) for name, found in groups if found]
        answers = json.loads(ANSWERS.read_text(encoding="utf-8"))
        text = pages.render("gallery.html", title="Scenes of D-CoNe co-simulation", groups=groups, answers=answers)
        (draft / INDEX).write_text(text, encoding="utf-8")
        return placed.put(draft / INDEX, out / INDEX)


def group_of(run: RunResult) -> str:
    """One of `GROUPS`: by whether it came to its end and its lines bore it, and by the phases that it has."""
    if run.status != COMPLETED:
        return GROUPS[-1]
    nets = [phase.main.model == NET for phase in run.scene.phases]
    return GROUPS[0] if any(nets) and not all(nets) else GROUPS[1] if all(nets) else GROUPS[2]


def _card(out: Path, name: str) -> dict[str, Any]:
    folder = out / "runs" / name
    run = read_run(folder)
    picture = next((folder / one for one in CARD if (folder / one).is_file()), None)
    return {
        "name": name,
        "title": run.scene.title,
        "badges": tiles.badges(run),
        "good": run.status == COMPLETED,
        "group": group_of(run),
        "chief": answer_of(out / f"{name}.html") or tiles.chief(run),
        "picture": "" if picture is None else base64.b64encode(picture.read_bytes()).decode(),
    }
