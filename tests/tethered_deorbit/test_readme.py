"""The page of the model lists the code's faults and variables. To write it anew, run this file with python."""

import math
import re
from pathlib import Path

import fmu_src.tethered_deorbit as package
from fmu_src.interface import Variable
from fmu_src.tethered_deorbit.interface import MODEL

PAGE = Path(package.__file__).with_name("README.md")


def bound(value: float) -> str:
    return f"{value:.6g}" if math.isfinite(value) else ""


def row(v: Variable, part: str) -> str:
    low = ("> " if v.open_minimum else "") + bound(v.minimum)
    start = "" if v.causality == "output" else f"{v.starts()[0]:.6g}"
    name = f"`{v.name}`" + (f" ({v.size})" if v.shape else "")
    cells = (name, v.unit, v.causality, part, start, low, bound(v.maximum), v.description)
    return "| " + " | ".join(cells) + " |"


def variables() -> str:
    lines = ["| name | unit | causality | with | start | least | most | meaning |", "| --- " * 8 + "|"]
    lacked = {
        row: f"{name} {', '.join(t for t, other in group.terms.items() if row not in other.lacks)}"
        for name, group in MODEL.groups.items()
        for term in group.terms.values()
        for row in term.lacks
    }
    parts = [(lacked.get(v.name, ""), v) for v in MODEL.base]
    for name, group in MODEL.groups.items():
        seen: dict[Variable, list[str]] = {}
        for term, content in group.terms.items():
            for v in content.variables:
                seen.setdefault(v, []).append(term)
        parts += [(name if len(t) == len(group.terms) else f"{name} {', '.join(t)}", v) for v, t in seen.items()]
    return "\n".join(lines + [row(v, part) for part, v in parts if v.at_interface]) + "\n"


def faults() -> str:
    return "".join(f"| {f.code} | {f.text} |\n" for f in MODEL.faults)


def page(text: str) -> str:
    text = re.sub(r"(\| code \| reason \|\n\| --- \| --- \|\n)(FAULTS\n|(?:\|.*\n)*)", lambda m: m[1] + faults(), text)
    return re.sub(r"(Start values of outputs are computed\.\n\n)(?s:.*)", lambda m: m[1] + variables(), text)


def test_page_is_up_to_date() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert page(text) == text
    wrong = text.replace("| 1 | the state", "| 99 | the state")
    assert wrong != text == page(wrong)


if __name__ == "__main__":
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
