"""What the campaigns that come with the program came to, as evidence and as the table of their page.

    python -m tests.campaign.evidence RUNS     take in the finished campaigns of a folder, then write the tables
    python -m tests.campaign.evidence          write the tables again from what is stored

Stored beside this file: NAME.json, with the stamp of what made it, and the picture of a map. The tables are that of
dcone_cosim/campaign/README.md and dcone_cosim/campaigns/answers.json, which the gallery shows.
"""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from dcone_cosim.cases.statistics import share

HERE = Path(__file__).parent
ROOT = HERE.parents[2]
PAGE = ROOT / "dcone_cosim" / "campaign" / "README.md"
ANSWERS = ROOT / "dcone_cosim" / "campaigns" / "answers.json"
BEGIN, END = "<!-- answers: python -m tests.campaign.evidence -->", "<!-- end of answers -->"
MAP = "map.png"
FIGURES = (
    *(".largest_tug_peak", ".first_tug_peak", "thread.tension_max", ".t_capture", "line.diameter_required"),
    *("pull_off.drawn_max", "mouth.area_at_touch", "net.volume_at_touch"),
)
"""Figures of which the table tells median and 95th percentile, by the ends of their names."""
OPEN = (("mouth.area_at_touch", "m²"), ("net.volume_at_touch", "m³"))
"""Figures of which a table by values tells the median."""
OWN = "thousand"
"""Evidence that is of no campaign."""
HOUR = 3600.0


def taken_in(folder: Path) -> dict[str, Any]:
    """The evidence of a finished campaign."""
    told = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    made = json.loads((folder / "provenance.json").read_text(encoding="utf-8"))
    study = json.loads((folder / "study.json").read_text(encoding="utf-8"))
    by = [
        {**row, "values": {k: v.strip('"') for k, v in row["values"].items()}, "figures": _kept(row["figures"])}
        for row in told.get("by", [])
    ]
    kept = ("campaign", "title", "scene", "sampler", "seed", "cases", "confidence", "success", "succeeded")
    return {
        **{name: told[name] for name in kept},
        **{
            name: told[name] for name in ("probability", "outcomes", "no_answer", "map", "rare", "said") if name in told
        },
        **({"by": by} if by else {}),
        **({"indices": told["indices"]} if told.get("indices") else {}),
        "figures": _kept(told["figures"]),
        "cost": told["cost"],
        "file": study["campaign"],
        "stamp": {name: made[name] for name in ("scene_sha256", "code", "started", "finished", "packages", "machine")},
        "fmus": study["fmus"],
    }


def _kept(figures: Mapping[str, Any]) -> dict[str, Any]:
    return {name: one for name, one in figures.items() if name.endswith(FIGURES)}


def stored() -> dict[str, dict[str, Any]]:
    """Evidence of every campaign, by its name."""
    files = sorted(path for path in HERE.glob("*.json") if path.stem != OWN)
    return {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in files}


def answer(one: Mapping[str, Any]) -> str:
    """What a campaign came to, in a line."""
    parts = [*_of_cases(one)]
    for name, figure in one["figures"].items():
        middle, high = (figure["percentiles"][percent]["value"] for percent in ("50", "95"))
        unit = "" if figure["unit"] == "1" else f" {figure['unit']}"
        parts.append(f"{name} {middle:.4g}{unit}, 95 % below {high:.4g}{unit}")
    return "; ".join(parts)


def _of_cases(one: Mapping[str, Any]) -> Iterator[str]:
    if "by" in one:
        yield "; ".join(
            f"{', '.join(row['values'].values())}: {row['succeeded']} of {row['cases']}" for row in one["by"]
        )
    elif one["probability"] is not None:
        share, (low, high) = one["probability"]["share"], one["probability"]["interval"]
        bounds = "" if low is None else f" ({low:.3f} to {high:.3f})"
        yield f"{one['success']} {share:.3f}{bounds}"
        yield from (f"{word} {of['count']}" for word, of in one["outcomes"].items() if word != one["success"])
    elif "rare" in one:
        yield rare(one["rare"])
    else:
        yield ", ".join(f"{word} {of['count']}" for word, of in one["outcomes"].items())
    for name, found in one.get("indices", {}).items():
        told = ", ".join(f"{key} {of['total']:.2f} ± {of['total_error']:.2f}" for key, of in found["inputs"].items())
        yield f"total indices of {name}: {told}"


def rare(found: Mapping[str, Any]) -> str:
    """A rare failure in a line; never a probability without its coefficient of variation."""
    if found["failure"] is None:
        return "no probability: the walk came to a halt before failure"
    return f"failing {found['failure']:.2g}, coefficient of variation {found['coefficient_of_variation']:.2g}"


def rows() -> list[dict[str, str]]:
    return [
        {
            "name": name,
            "title": one["title"],
            "cases": f"{one['cases']}",
            "answer": answer(one),
            "cost": f"{one['cost']['value'] / HOUR:.2g} CPU-h",
        }
        for name, one in stored().items()
    ]


def by_values() -> Iterator[str]:
    """A table for all campaigns that tell their answers for the same values, one column each."""
    groups: dict[tuple[str, ...], dict[str, dict[tuple[str, ...], Any]]] = {}
    for name, one in stored().items():
        rows_of = {tuple(row["values"].values()): row for row in one.get("by", [])}
        if rows_of:
            groups.setdefault((*one["by"][0]["values"], *map(str, rows_of)), {})[name] = rows_of
    for campaigns in groups.values():
        first = next(iter(campaigns.values()))
        keys = list(next(iter(first.values()))["values"])
        yield "\n| " + " | ".join([*(f"`{key}`" for key in keys), *(f"`{name}`" for name in campaigns)]) + " |"
        yield "| " + " | ".join(["---"] * (len(keys) + len(campaigns))) + " |"
        for words in first:
            cells = [_cell(rows_of[words]) for rows_of in campaigns.values()]
            yield "| " + " | ".join([*words, *cells]) + " |"
        for place, word in dict.fromkeys((place, words[place]) for place in range(len(keys)) for words in first):
            cells = [_of_all([row for words, row in one.items() if words[place] == word]) for one in campaigns.values()]
            yield "| " + " | ".join([*(word if at == place else "all" for at in range(len(keys))), *cells]) + " |"


def _of_all(rows_of: Sequence[Mapping[str, Any]]) -> str:
    """The cases of several rows of a table taken together."""
    found = [row["probability"] for row in rows_of if row["probability"] is not None]
    one = share(sum(row["count"] for row in found), sum(row["of"] for row in found))
    return f"{one.count} of {one.of} ({one.interval[0]:.2f} to {one.interval[1]:.2f})"


def _cell(row: Mapping[str, Any]) -> str:
    """Successes with their interval, and how far the net was open as it met the debris."""
    if row["probability"] is None:
        return f"none of {row['cases']} answers" if row["cases"] else "no case"
    low, high = row["probability"]["interval"]
    parts = [f"{row['succeeded']} of {row['probability']['of']} ({low:.2f} to {high:.2f})"]
    for ending, unit in OPEN:
        found = next((one for name, one in row["figures"].items() if name.endswith(ending)), None)
        if found is not None:
            parts.append(f"{found['percentiles']['50']['value']:.3g} {unit}")
    return "; ".join(parts)


def table() -> str:
    """As the page has it."""
    lines = ["| campaign | cases | came to | cost |", "| --- | --- | --- | --- |"]
    lines += [
        f"| `{row['name']}`: {row['title']} | {row['cases']} | {row['answer']} | {row['cost']} |" for row in rows()
    ]
    pictures = [f"![{path.stem}](../../tests/campaign/evidence/{path.name})" for path in sorted(HERE.glob("*.png"))]
    return "\n".join([*lines, *by_values(), *([""] if pictures else []), *pictures])


def with_table(page: str) -> str:
    """The page with the table between its marks."""
    before, _, rest = page.partition(BEGIN)
    _, _, after = rest.partition(END)
    return f"{before}{BEGIN}\n{table()}\n{END}{after}"


def main() -> None:
    for folder in sorted(Path(sys.argv[1]).iterdir()) if len(sys.argv) > 1 else ():
        if (folder / "summary.json").is_file():
            text = json.dumps(taken_in(folder), indent=1)
            (HERE / f"{folder.name}.json").write_text(text + "\n", encoding="utf-8")
            if (folder / MAP).is_file():
                shutil.copyfile(folder / MAP, HERE / f"{folder.name}.png")
            print(f"{folder.name}: taken in")
    ANSWERS.write_text(json.dumps(rows(), indent=1) + "\n", encoding="utf-8")
    PAGE.write_text(with_table(PAGE.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
