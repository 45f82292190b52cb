"""The page an FMU carries to explain itself: what it is, its equations, its variables, its faults and its messages."""

from __future__ import annotations

import hashlib
import html
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

from fmu_src.interface import INDEX, Interface, Variable
from fmu_src.packaging.dependence import inputs_of, names_by_slot
from fmu_src.packaging.description import LOG_CATEGORIES, as_typed, number, sentence

STYLE = """
body{font:16px/1.55 system-ui,sans-serif;max-width:64em;margin:2em auto;padding:0 1em;color:#1b2733;background:#fff}
h1,h2,h3{line-height:1.2}h2{margin-top:2.2em;border-bottom:1px solid #cfd8e0}
table{border-collapse:collapse;font-size:.92em;display:block;overflow-x:auto}
td,th{padding:.2em .7em;text-align:left;vertical-align:top;border-bottom:1px solid #e3e9ee}
th{position:sticky;top:0;background:#f3f6f8}
code{font-size:.95em;background:#f3f6f8;padding:0 .2em}pre{background:#f3f6f8;padding:.8em;overflow-x:auto}
pre code{padding:0}img{max-width:100%;border-radius:6px}
"""
SEVERITIES = {
    "error": "error: the instance is broken until it is reset or put back into a state",
    "discard": "discard: this step is refused, a shorter one may do",
    "end": "discard and terminated: the model came to its own end",
}
CAUSALITIES = {
    "parameter": "Parameters, fixed before the start",
    "input": "Inputs",
    "output": "Outputs",
}


def page(interface: Interface, folder: Path, scene: str = "") -> str:
    """HTML of the page.

    folder    holds the model's README, whose equations it shows
    scene     whose values the FMU starts with; "" for the model's own

    Checked  tests/packaging/test_page_and_picture.py
    """
    model = interface.model
    readme = folder / "README.md"
    text = _lower_headings(readme.read_text()) if readme.exists() else ""
    sections = [
        _terms(interface),
        _values(interface, scene),
        _tables(interface),
        text,
        _variables(interface),
        _faults(interface),
        _messages(),
    ]
    body = "".join(map(_rendered, filter(None, sections)))
    title = model.name.replace("_", " ").capitalize()
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}</title>'
        f"<style>{STYLE}</style></head><body>\n<h1>{html.escape(title)}</h1>\n"
        f'<p>{html.escape(model.summary)}</p>\n<p><img src="../model.png" alt="{html.escape(title)}"></p>\n'
        f"{body}</body></html>\n"
    )


@lru_cache(maxsize=64)
def _rendered(text: str) -> str:
    """Most of a page is that of the model, whatever the values: a process that writes many renders it once."""
    from markdown_it import MarkdownIt

    html: str = MarkdownIt("commonmark", {"html": False}).enable("table").render(text)
    return html


def _lower_headings(text: str) -> str:
    """The README with its headings one level lower, since the page has a title of its own."""
    fenced, lines = False, []
    for line in text.splitlines():
        fenced ^= line.startswith("```")
        lines.append("#" + line if line.startswith("#") and not fenced else line)
    return "\n".join(lines)


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(map(_cell, row)) + " |" for row in lines)


def _terms(interface: Interface) -> str:
    """Which terms of physics are in this FMU."""
    rows: list[tuple[str, ...]] = []
    for name, group in interface.model.groups.items():
        term = interface.terms.get(name)
        rows.append((name, f"`{term}`", group.terms[term].summary) if term else (name, "left out", ""))
    if not rows:
        return ""
    return "## What is in this FMU\n\n" + _table(("group", "term", "what it adds"), rows)


def _values(interface: Interface, scene: str) -> str:
    """What this FMU starts with, each value to the last bit, and where the model alone would start with another."""
    own = {
        name: number(as_typed(v, start)) for name, _, v, start in interface.model.interface(interface.terms).scalars()
    }
    rows = []
    for name, _, v, start in interface.scalars():
        if v.causality in ("parameter", "input"):
            value = number(as_typed(v, start))
            other = own[name] if own[name] != value else ""
            rows.append(
                (f"`{name}`", f"**{value}**" if other else value, v.unit if v.kind == "Real" else v.kind, other)
            )
    whose = f"those of the scene `{scene}`" if scene else "the model's own"
    text = (
        f"They are {whose}, and travel in `resources/start-values.bin`: the library takes them from there when it is "
        "instantiated, and after a reset. Where they differ from the model's own, those are told beside them."
    )
    return f"## Values this FMU starts with\n\n{text}\n\n" + _table(("name", "value", "unit", "model's own"), rows)


def _tables(interface: Interface) -> str:
    """The tables that its parts read, how large those are that it was given, and a digest of their numbers."""
    rows = []
    for table in interface.tables:
        numbers = interface.given.get(table.name)
        extents, digest = "not given", ""
        if numbers is not None:
            extents = " x ".join(map(str, numbers.shape))
            digest = f"`{hashlib.sha256(numbers.tobytes()).hexdigest()[:16]}`"
        rows.append((f"`{table.name}`", extents, table.unit, digest, table.description))
    if not rows:
        return ""
    text = (
        "They travel in `resources/tables.bin`, little-endian doubles, and all instances of one unpacked FMU read the "
        "same copy. A saved state does not hold them, and goes with these tables alone. The digest is the beginning of "
        "the SHA-256 of a table's numbers."
    )
    return f"## Tables of this FMU\n\n{text}\n\n" + _table(("name", "extents", "unit", "digest", "meaning"), rows)


def _variables(interface: Interface) -> str:
    names = list(names_by_slot(interface))
    inputs = inputs_of(interface)
    parts = ["## Variables of this FMU"]
    for causality, title in CAUSALITIES.items():
        rows, slot = [], 0
        for v in interface.variables:
            if v.causality == causality:
                on = ", ".join(f"`{names[s]}`" for s in inputs.get(slot, ()))
                rows.append(_variable(v, on))
            slot += v.size
        if rows:
            last = {"output": ("rate", "depends directly on")}.get(causality, ("start", "bounds"))
            parts += [f"### {title}", _table(("name", "unit", *last, "meaning"), rows)]
    return "\n\n".join(parts)


def _variable(v: Variable, on: str) -> tuple[str, ...]:
    name = v.name
    for n in v.shape:
        name = name.replace(INDEX, f"[1..{n}]", 1)
    unit = v.unit if v.kind == "Real" else v.kind
    if v.display_unit:
        unit += f" (shown in {v.display_unit})"
    if v.causality == "output":
        return f"`{name}`", unit, f"`{v.rate}`" if v.rate else "", on, sentence(v)
    starts = list(dict.fromkeys(number(as_typed(v, start)) for start in v.starts()))
    return f"`{name}`", unit, ", ".join(starts), _bounds(v), sentence(v)


def _bounds(v: Variable) -> str:
    """The interval a value must lie in, as it is written."""
    low, high = v.minimum, v.maximum
    if v.kind == "Boolean" or (low == -float("inf") and high == float("inf")):
        return ""
    if high == float("inf"):
        return f"{'>' if v.open_minimum else '≥'} {low:g}"
    return f"{'(' if v.open_minimum else '['}{low:g}, {high:g}]"


def _faults(interface: Interface) -> str:
    rows = [(str(f.code), SEVERITIES[f.severity], f.text) for f in interface.model.faults]
    if not rows:
        return ""
    return "## Faults\n\n" + _table(("code", "what FMI sees", "what went wrong, what to try"), rows)


def _messages() -> str:
    rows = [(f"`{name}`", meaning) for name, meaning in LOG_CATEGORIES]
    text = "Errors and discards are told unless `fmi2SetDebugLogging` turns them off; the rest when logging is on."
    return f"## Log categories\n\n{text}\n\n" + _table(("category", "what it tells"), rows)
