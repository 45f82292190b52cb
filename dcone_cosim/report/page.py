"""The page of a run, or its replay alone: what the run folder holds, in one file."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

from dcone_cosim.findings import spoken
from dcone_cosim.phases import kind_of
from dcone_cosim.progress import Progress
from dcone_cosim.report import links, live, packing, scripts, tiles, told, turning
from dcone_cosim.report.forces import PICTURE, ForceMap
from dcone_cosim.report.links import Linked
from dcone_cosim.report.live import Live
from dcone_cosim.reports import pages
from dcone_cosim.reports.warnings import warnings
from dcone_cosim.results import RunResult
from dcone_cosim.run_reading import provenance_of, read_run

PICTURES = {"capture": "capture_in_space.png", "removal": "tether_tension.png", "second_tow": "second_tow_tension.png"}
"""What is shown of a phase where a clip cannot be: in print, and without WebGL."""
NOT_ASKED = "the models, since it was made with --no-live"
NOTHING = "models, since no phase of this run is by one of ours"
"""Why a page has none."""
LEAST_TONE = 0.36
"""Where on its scale the colour map begins: darker than that is not seen on the dark ground of a clip."""


def of_folder(
    folder: Path,
    place: Path,
    linked: Sequence[Linked] = (),
    whole: bool = True,
    progress: Progress | None = None,
    up: str = "",
    beside: Mapping[str, bool] = MappingProxyType({}),
) -> str:
    """The page of the run of a folder, to be put at `place`; `InputError` where it is no run.

    whole    all of it; otherwise the replay alone, with the tugs
    progress    is told of what is built; with none the model is not put into the page
    up    address of the index that the page is of, "" for none
    beside    by name of a table, whether it is beside the page as CSV; empty where none is
    """
    run, about = read_run(folder), provenance_of(folder)
    here = links.named(folder)
    clips, charts = [], []
    for name, result in run.phases.items():
        kind = kind_of(name)
        one = kind.clip(run, result)
        title = tiles.spoken_phase(name)
        clips += [] if one is None else [{**packing.clip(one), "key": name, "title": title.capitalize()}]
        alike = sum(kind_of(other).model == kind.model for other in run.phases) > 1
        for shown in kind.charts(run, result):
            named = {"title": f"{shown.title}, {title}"} if alike else {}
            charts.append((name, packing.chart(shown) | named))
    forces = ForceMap.read(folder)
    for packed_clip in clips:
        if forces is not None and "surface" in packed_clip and "net" in packed_clip:
            packed_clip["forces"] = forces.packed()
    if not whole:
        charts = [(name, chart) for name, chart in charts if chart["key"] == "tension"]
    for name, chart in charts:
        chart["key"] = f"{name}-{chart['key']}"
    data = {"clips": clips, "charts": [chart for _, chart in charts], "colours": colours()}
    pointed = turning.of_run(folder, run, progress) if whole else None
    models: dict[str, Live | str] = {}
    if whole and progress is not None:
        models = {"live": live.of_tow(folder, run, progress), "shot": live.of_shot(folder, run, progress)}
    data |= {name: {**model.told, "folder": here} for name, model in models.items() if isinstance(model, Live)}
    chief = [
        *tiles.chief(run, {} if pointed is None else pointed.share),
        *([governs] if (governs := links.tile(linked)) else []),
    ]
    values: dict[str, Any] = {
        "title": run.scene.title,
        "badges": tiles.badges(run),
        "said": tiles.said(run),
        "inputs": list(tiles.inputs(run)),
        "up": up,
        "good": run.exit_code == 0,
        "whole": whole,
        "chief": chief,
        "answer": _script(chief),
        "warnings": [one for one in warnings(run) if one not in tiles.said(run)],
        "clips": [{**_head(clip), "picture": picture_of(folder / PICTURES.get(clip["key"], ""))} for clip in clips],
        "charts": [(name, {"key": chart["key"], "title": chart["title"]}) for name, chart in charts],
        "about": told.provenance(about, run, here),
        "beside": beside,
        "page": "report" if whole else "replay",
        "library": scripts.origin() if clips else {},
        "scale": scale(),
        **packed(data),
    }
    if whole:
        values |= {
            "lines": told.lines(run),
            "diameters": told.diameters(run, here),
            "handovers": list(told.handovers(run)),
            "events": list(told.events(run)),
            "figures": list(told.figures(run)),
            "trust": [*told.trust(run), *([] if pointed is None else [pointed.said])],
            "linked": [links.shown(kind, linked, place, f"{here}/scene.toml") for kind in links.COMMANDS],
            "governs": links.governing(linked),
            "live": _shown(models, [_head(clip) for clip in clips]),
            "workers": [(one, live.worker(one)) for one in live.SCRIPTS],
            "scene": run.scene.text,
            "scene_file": base64.b64encode(run.scene.text.encode()).decode(),
            "scene_name": run.scene.name,
            "tugs": list(tables(run)),
            "forces": None if forces is None else forces.hardest(),
            "force_picture": picture_of(folder / PICTURE),
            "hinged": any("swing" in clip for clip in clips),
        }
    return pages.render("run.html", **values)


def tables(run: RunResult) -> Iterator[tuple[str, int, str]]:
    """Phase, number and table, as CSV in base64, of all tugs of each tow."""
    for name, result in run.phases.items():
        if result.tugs is not None and result.tugs.rows:
            lines = ["tug,time [s],peak [N],speed [m/s]"]
            lines += [f"{n},{t!r},{peak!r},{v!r}" for n, (t, peak, v) in sorted(result.tugs.rows.items())]
            yield name, len(result.tugs.rows), base64.b64encode("\n".join([*lines, ""]).encode()).decode()


def packed(data: Mapping[str, Any]) -> dict[str, str]:
    """What the template writes into script elements: the data, and the import map of what shows them."""
    more = ("replay", "shot") if data["clips"] else ()
    return {
        "data": _script(data),
        "import_map": scripts.import_map("page", more),
    }


def _script(data: Any) -> str:
    """Plain data as an element of a page has it."""
    return json.dumps(data, separators=(",", ":")).replace("</", "<\\/")


def answer_of(page: Path) -> list[tiles.Tile]:
    """What a page tells at its top, as it was written there; nothing of a page that is not a run's.

    Checked  tests/report/test_gallery.py
    """
    found = re.search(r'<script type="application/json" id="answer">(.*?)</script>', page.read_text(encoding="utf-8"))
    return json.loads(found[1]) if found else []


def _shown(models: Mapping[str, Live | str], heads: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """What the template says of the models in the page, and of those that are not."""
    tow, shot = (None if isinstance(one, str) else one for one in (models.get("live"), models.get("shot")))
    without = [one for one in models.values() if one and isinstance(one, str)] if models else [NOT_ASKED]
    if not (tow or shot or without):
        without = [NOTHING]
    clip = next((one for one in heads if shot is not None and one["key"] == shot.phase), None)
    head = (
        None if clip is None else {**clip, "key": "shot", "title": "Shot", "notes": (), "forces": False, "picture": ""}
    )
    return {"tow": tow, "shot": shot, "clip": head, "without": without}


def _head(clip: Mapping[str, Any]) -> dict[str, Any]:
    """What the template says of a clip."""
    of = clip.get("net", {}).get("tensions") or clip.get("tension")
    scaled = (
        None
        if of is None or not of["most"]
        else [(n, spoken(of["most"] * of["floor"] ** (1.0 - n), most=3)) for n in (0.0, 1 / 3, 2 / 3, 1.0)]
    )
    return {
        "key": clip["key"],
        "title": clip["title"],
        "notes": clip["notes"],
        "scale": scaled,
        "net": "net" in clip,
        "forces": "forces" in clip,
        "cord": bool(clip.get("net", {}).get("rim")),
    }


def picture_of(path: Path) -> str:
    """A picture in base64, "" where there is none."""
    return base64.b64encode(path.read_bytes()).decode() if path.is_file() else ""


def colours() -> list[int]:
    """256 colours for tensions, least to largest: red, green, blue, 0 to 255 each.

    The upper part of viridis, whose lightness grows evenly, so that it is told apart without colour as well.

    Source   matplotlib's colour map of that name
    Checked  tests/report/test_packing.py
    """
    import matplotlib as mpl

    table = mpl.colormaps["viridis"]
    rows = [table(LEAST_TONE + (1.0 - LEAST_TONE) * n / 255.0)[:3] for n in range(256)]
    return [round(255.0 * part) for row in rows for part in row]


def scale() -> str:
    """The same as a gradient of CSS, from the least to the largest."""
    rows = colours()
    stops = ["rgb({}, {}, {})".format(*rows[3 * n : 3 * n + 3]) for n in range(0, 256, 15)]
    return f"linear-gradient(to right, {', '.join(stops)})"
