"""Pages of the other reports in Chromium: nothing runs out of a narrow screen, numbers stand on the right with their
units, and no table hides a column."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from dcone_cosim.reports import pages
from dcone_cosim.sizing import page as sizing
from dcone_cosim.sizing.result import Sizing
from dcone_cosim.sizing.section import ROW, Head, Section, text
from tests.report.browser import Browser, chromium

WIDE, NARROW = 1280, 390
LONG = "# " + "a comment that goes on, " * 8
SETTING = "--set 'removal.solver.tolerance_separation=1e-10 m' --set 'removal.solver.tolerance_stretch=1e-11 m'"
ABOUT = {"command": f"dcone anything {SETTING}", "packages": {"dcone-cosim": "0.0.0", "numpy": "0.0.0"}}
PICTURE = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGP4DwABAQEAG7buVgAAAABJRU5ErkJggg=="


def campaign() -> str:
    percentiles = [(f"{n}49.56", f"{n}36.03 to {n}36.41") for n in range(4)]
    row = {"name": "removal.line.diameter_required", "unit": "mm", "cases": "58 of 60", "mean": "0.0092695"}
    worth = {"number": 7, "why": "slipped off", "command": f"dcone campaign rerun runs/{'x' * 60} 7", "page": ""}
    return pages.render(
        "campaign.html",
        title="A campaign",
        said=["captured: 24 of 24 cases, probability 1 (0.862 to 1)"],
        pictures=[("Figures", PICTURE)],
        inputs=[("capture.target.start_rate[2]", ["0.75 deg/s", "15 deg/s", "29.25 deg/s"])],
        at=["2.5 %", "50 %", "97.5 %"],
        confidence="95 %",
        figures=[{**row, "spread": "0.00436", "percentiles": percentiles}],
        bounded=True,
        indices=[("removal.first_tug", 64, [("removal.thrust.level", "0.10 ± 0.02", "0.30 ± 0.04")])],
        surrogates=[("removal.first_tug", "Gaussian process", "24", "2.7 %")],
        worth=[worth],
        there=[],
        campaign=f"{LONG}\ntitle = 'x'",
        notes=[],
        about=ABOUT,
    )


def accuracy() -> str:
    point = {"label": "dop853 x 0.01", "worst": "< 7.3e-08 %", "errors": ["1.5e-12 %"] * 7, "cpu": "0.337 ms"}
    quantities = [
        ("", {"label": "peaks of the first 5 tugs", "meant": True, "relative_to": "its largest"}) for _ in range(7)
    ]
    phase = {
        "name": "removal",
        "sentences": [f"for 1 % use dop853: {SETTING}"],
        "picture": PICTURE,
        "quantities": quantities,
        "axes": [{"name": "scheme and step", "points": [{**point, "changes": SETTING, "best": False}]}],
    }
    return pages.render("accuracy.html", title="Accuracy", phases=[phase], notes=[], about=ABOUT)


def stability() -> str:
    row = {
        "extreme": "line's damping ratio 0",
        "text": "",
        "scheme": "dop853",
        "bad": False,
        "kind": "stable and accurate",
        "why": "",
        "asked": "snap",
        "criteria": "outputs that are not finite 0; tension below zero 0 %; stretch beyond peak tension 0 %; " * 3,
        "cpu": "0.00053 s",
        "changes": SETTING,
    }
    left = {**row, "kind": "left out", "why": "not in a quick look", "criteria": "", "cpu": "", "changes": ""}
    phase = {"name": "removal", "scene": "Table 2", "sentences": [], "picture": PICTURE, "rows": [row, left]}
    meanings = [("A", "stable and accurate")]
    return pages.render("stability.html", title="Stability", phases=[phase], meanings=meanings, notes=[], about=ABOUT)


def size(folder: Path) -> str:
    own = (text("what", "what"), Head("value", "value", ROW), text("unit", "unit"), text("how", "from"))
    asked = Section("asked", "What is sized", "The tow.", own, [("its E", 6e10, "Pa", "tether.youngs_modulus")])
    heads = (text("what", "value"), text("least", "least"), text("most", "largest"), Head("peak", "peak", "N"))
    rows = [
        ("thrust", "-0.009 N", "-0.011 N", 13.67),
        ("line diameter", "0.95 mm", "1.05 mm", 2.5),
        ("who leads", "chaser", "debris", 3.0),
    ]
    ranges = Section("ranges", "Ranges", "Ends.", heads, rows)
    sizing.write(Sizing("Sizing", ["peak tension 13.67 N"], [asked, ranges]), ABOUT, folder)
    return (folder / "report.html").read_text()


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    chromium()
    one = Browser(tmp_path_factory.mktemp("profile"), WIDE)
    try:
        yield one
    finally:
        one.close()


def opened(browser: Browser, page: Path, width: int) -> None:
    size: dict[str, Any] = {"height": 900, "deviceScaleFactor": 1, "mobile": False}
    browser.call("Emulation.setDeviceMetricsOverride", width=width, **size)
    browser.call("Page.navigate", url=page.absolute().as_uri())
    began = time.perf_counter()
    while browser.ask("document.readyState") != "complete":
        assert time.perf_counter() - began < 30.0, browser.said
        time.sleep(0.02)
    browser.ask("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    browser.ask("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


@pytest.mark.parametrize("which", ["campaign", "accuracy", "stability", "size"])
def test_a_report_fits_both_widths(which: str, browser: Browser, tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    makers = {"campaign": campaign, "accuracy": accuracy, "stability": stability}
    page.write_text(makers[which]() if which in makers else size(tmp_path))
    for width in (WIDE, NARROW):
        opened(browser, page, width)
        assert browser.ask("document.scrollingElement.scrollWidth") <= width, which
        hidden = (
            "[...document.querySelectorAll('.wide')].filter((one) => one.scrollWidth > one.clientWidth + 1"
            " && !one.classList.contains('slides')).length"
        )
        assert browser.ask(hidden) == 0
        numbers = (
            "[...document.querySelectorAll('table:not(.stacked) td:not(:first-child)')]"
            ".filter((one) => /^[<-]? ?[\\d.]+(e-?\\d+)?( \\S+)?$/.test(one.innerText.trim()))"
        )
        sides = browser.ask(f"{numbers}.map((one) => getComputedStyle(one).textAlign)")
        assert set(sides) == ({"right"} if sides else set())
        if width == WIDE:
            assert sides
            lines = f"{numbers}.map((one) => {{ const r = document.createRange(); r.selectNodeContents(one);"
            tops = browser.ask(f"{lines} return new Set([...r.getClientRects()].map((b) => b.top)).size; }})")
            assert set(tops) == {1}, "a number stays beside its unit"
    stacked = "[...document.querySelectorAll('.stacked td')]"
    assert browser.ask(f"{stacked}.filter((one) => one.scrollWidth > one.clientWidth + 1).length") == 0
    if which == "stability":
        blank = f"{stacked}.filter((one) => one.checkVisibility() && !one.textContent.trim()).length"
        assert browser.ask(blank) == 0, "what is not told has no line of a card"
        assert browser.ask("getComputedStyle(document.querySelector('.stacked td.long')).textAlign") == "left"
    if which == "size":
        assert browser.ask("document.querySelector('#asked ~ .wide td:nth-child(2)').innerText") == "60"
    assert browser.said == []
