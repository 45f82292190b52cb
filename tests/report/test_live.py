"""The models in a page: their numbers against the FMU's, what is moved against the run that the page tells of it."""

from __future__ import annotations

import json
import shlex
import time
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from dcone_cosim import build
from dcone_cosim.commands import run_and_write
from dcone_cosim.errors import FmuError
from dcone_cosim.findings import spoken
from dcone_cosim.loading import load
from dcone_cosim.phases.chaos import CAPTURE
from dcone_cosim.progress import Progress
from dcone_cosim.report import carried, live, packing
from dcone_cosim.report.page import of_folder
from dcone_cosim.run_reading import read_run
from tests.report.browser import Browser, chromium
from tests.report.conftest import Page
from tests.report.test_packing import decoded
from tests.runs import COARSE, put

TOW, SHOT = "window.dcone.live", "window.dcone.shot"
PATIENCE = 60.0
"""[s]"""


def tugs(run: Path) -> np.ndarray[Any, np.dtype[np.float64]]:
    rows: np.ndarray[Any, np.dtype[np.float64]] = pd.read_parquet(run / "tugs.parquet")[
        ["time", "peak", "speed"]
    ].to_numpy()
    return rows


class Asked:
    """A page with a tow in it: what it comes to as values are moved."""

    def __init__(self, browser: Browser) -> None:
        self.browser = browser

    def wait(self, condition: str) -> None:
        began = time.perf_counter()
        while not self.browser.ask(condition):
            assert time.perf_counter() - began < PATIENCE, (condition, self.browser.said)
            time.sleep(0.02)

    def open(self, page: Path) -> None:
        self.browser.open(page)
        self.settle()

    def settle(self) -> None:
        """Until the latest values are simulated, and the diameter for them is found."""
        self.wait(f"document.getElementById('live-tow').dataset.done === String({TOW}.number)")
        self.wait("!document.querySelector('#live-tow .figures').innerText.includes('…')")

    def move(self, **values: float) -> None:
        """Type values, by the last part of their keys."""
        for name, value in values.items():
            self.browser.ask(
                f"(() => {{ const k = {TOW}.knobs.find((one) => one.told.key.endsWith('.{name}'));"
                f" k.number.value = '{value}'; k.number.dispatchEvent(new Event('change')); }})()"
            )

    def result(self, which: str) -> dict[str, Any]:
        found: dict[str, Any] = self.browser.ask(
            f"(() => {{ const {{ tugs, largest, required }} = {TOW}.results.{which};"
            " return { tugs, largest, required }; })()"
        )
        return found

    def said(self, part: str, section: str = "live-tow") -> str:
        return str(self.browser.ask(f"document.querySelector('#{section} [data-part={part}]').textContent"))


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    chromium()
    return tmp_path_factory.mktemp("live")


@pytest.fixture(scope="module")
def asked(place: Path) -> Iterator[Asked]:
    browser = Browser(place / "profile")
    try:
        yield Asked(browser)
    finally:
        browser.close()


@cache
def page_of(run: Path) -> Path:
    """Written once, for all tests that look at it."""
    path = run.parent / f"{run.name}.html"
    path.write_text(of_folder(run, path, progress=Progress()))
    return path


@pytest.fixture(scope="module")
def table2(place: Path) -> Path:
    return put("table2-deorbit", place / "table2")


@pytest.fixture(scope="module")
def mission(place: Path) -> Path:
    """On coarse meshes: it is its tow that is looked at."""
    return put("mission", place / "mission", COARSE[:2])


@pytest.mark.parametrize("name", ["table2", "mission"])
def test_the_tugs_in_the_page_are_those_of_the_fmu(name: str, asked: Asked, request: pytest.FixtureRequest) -> None:
    """Same bits; another diameter gives other ones, so that the run's own tugs are not merely shown."""
    run: Path = request.getfixturevalue(name)
    asked.open(page_of(run))
    wanted = tugs(run)
    np.testing.assert_array_equal(asked.result("run")["tugs"], wanted)
    assert f"gives the run's {len(wanted)} tugs again, bit for bit" in asked.said("status")
    asked.move(diameter=1.01)
    asked.settle()
    moved = np.array(asked.result("moved")["tugs"])
    assert moved[0, 1] == pytest.approx(1.01 * wanted[0, 1], rel=1e-3)
    assert moved[0, 1] != wanted[0, 1]
    assert asked.browser.said == []


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("table2", {"diameter": 2, "youngs_modulus": 45.3, "damping_ratio": 0.1, "rest_length": 15, "level": -0.02}),
        ("mission", {"diameter": 0.73, "level": -0.0123}),
    ],
)
def test_the_line_in_the_page_makes_the_same_run(
    name: str,
    values: dict[str, float],
    asked: Asked,
    place: Path,
    request: pytest.FixtureRequest,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    run: Path = request.getfixturevalue(name)
    asked.open(page_of(run))
    asked.move(**values)
    asked.settle()
    words = shlex.split(asked.said("command"))
    assert words[:3] == ["dcone", "run", f"./{name}"]
    assert words[-2:] == ["-o", "moved"]
    settings = [words[i + 1] for i, word in enumerate(words) if word == "--set"]
    assert len(settings) == len(values)
    monkeypatch.chdir(place)
    go_on = words[words.index("--from") + 1] if "--from" in words else ""
    assert go_on == ("removal" if name == "mission" else "")
    done = run_and_write(
        words[2], place / f"moved-{name}", Progress(), with_figures=False, settings=settings, go_on=go_on
    )
    np.testing.assert_array_equal(asked.result("moved")["tugs"], tugs(done.folder))


def test_the_diameter_it_asks_for_is_just_thick_enough(asked: Asked, table2: Path, place: Path) -> None:
    """By runs of the FMU: at that diameter the factor of safety is held, a hundredth below it is not."""
    asked.open(page_of(table2))
    needed = asked.result("run")["required"] * 1e-3
    strength, factor = 2.92e9, 2.0
    for share, holds in ((1.0, True), (0.99, False)):
        diameter = share * needed
        run = put("table2-deorbit", place / f"needed-{share}", [f"removal.tether.diameter={diameter!r} m"])
        bears = strength * np.pi / 4.0 * diameter**2
        assert (factor * tugs(run)[:, 1].max() <= bears * (1.0 + 1e-9)) == holds


def test_a_search_that_other_values_broke_off_goes_on(asked: Asked, table2: Path) -> None:
    """The least diameter of the run, as its reader is faster than the search; it took no answer ever after."""
    asked.open(page_of(table2))
    wanted = asked.result("run")["required"]
    asked.browser.ask(f"Object.assign({TOW}.results.run, {{ sought: true, required: NaN }}); {TOW}.tell()")
    cell = "document.querySelector('#live-tow [data-figure=required] [data-of=run]').textContent"
    assert asked.browser.ask(cell) == "…"
    asked.move(diameter=2)
    asked.settle()
    assert asked.result("run")["required"] == wanted
    assert asked.result("moved")["required"] != wanted
    assert asked.browser.ask(cell) == spoken(wanted)


def test_tugs_that_are_not_the_same_bits_are_told_with_the_reason(asked: Asked, table2: Path) -> None:
    asked.open(page_of(table2))
    told = asked.browser.ask(
        f"(() => {{ {TOW}.recorded[1] *= 1 + 2e-12; {TOW}.hold({TOW}.results.run); return {TOW}.same; }})()"
    )
    assert "tugs again, within 2e-12 of each figure: sine, exponential and their like" in told
    told = asked.browser.ask(
        f"(() => {{ {TOW}.recorded = {TOW}.recorded.slice(3); {TOW}.hold({TOW}.results.run); return {TOW}.same; }})()"
    )
    own = len(tugs(table2))
    assert told == f"Unmoved it gives {own} tugs, where the run has {own - 1}."


def test_the_load_that_governs_follows(asked: Asked, table2: Path) -> None:
    """A snap, and from a damping ratio of one half on the dashpot."""
    asked.open(page_of(table2))
    cell = "document.querySelector('#live-tow [data-figure=governing] [data-of={}]').textContent"
    own = tugs(table2)
    hardest = int(own[:, 1].argmax())
    assert asked.browser.ask(cell.format("run")).startswith(f"snap: tug {hardest + 1} of {len(own)}, at ")
    asked.move(damping_ratio=0.6)
    asked.settle()
    assert asked.browser.ask(cell.format("moved")).startswith("dashpot: tug ")


def test_a_length_of_two_phases_is_told_of_both(asked: Asked, mission: Path) -> None:
    """The net has to be shot anew for it, so that nothing is gone on from, and the page says so."""
    asked.open(page_of(mission))
    asked.move(rest_length=15)
    asked.settle()
    words = shlex.split(asked.said("command"))
    assert words[3:-2] == ["--set", "removal.tether.rest_length=15 m", "--set", "capture.tether.length=15 m"]
    assert "shoots the net anew" in asked.said("note")
    asked.move(speed=3.3)
    asked.settle()
    assert "capture.bullets.speed=3.3 m/s" in shlex.split(asked.said("command"))
    assert "the net is not shot again" in asked.said("note")


def test_what_the_model_refuses_is_told_and_undone(asked: Asked, table2: Path) -> None:
    asked.open(page_of(table2))
    asked.move(damping_ratio=-1)
    asked.wait(f"{TOW}.failed")
    assert "tether.damping_ratio = -1" in asked.said("status")
    assert "out of its bounds" in asked.said("status")
    shown = "[...document.querySelectorAll('#live-tow [data-of=moved]')].map((one) => one.textContent).join('')"
    assert asked.browser.ask(shown) == ""
    assert asked.said("command") == ""
    assert asked.browser.ask("getComputedStyle(document.querySelector('#live-tow .command')).visibility") == "hidden"
    error = asked.browser.ask("getComputedStyle(document.querySelector('#live-tow [data-part=status]')).color")
    assert error != asked.browser.ask("getComputedStyle(document.querySelector('#live-tow [data-part=note]')).color")
    assert asked.browser.ask(f"{TOW}.chart.series.length") == 1
    asked.browser.ask("document.querySelector('#live-tow [data-part=reset]').click()")
    asked.settle()
    assert "bit for bit" in asked.said("status")
    assert asked.said("command") == "dcone run ./table2"


def test_a_tether_that_is_too_short_breaks_and_the_page_says_why(asked: Asked, mission: Path) -> None:
    """It is stretched from the start, which is no tug; while it is computed nothing of the values before is shown."""
    asked.open(page_of(mission))
    reach = pd.read_parquet(mission / "removal.parquet")["tether.length"][0]
    asked.move(diameter=1.5)
    asked.settle()
    asked.browser.ask(f"{TOW}.busy = true")  # the worker stays silent
    asked.move(rest_length=0.6 * reach)
    shown = "[...document.querySelectorAll('#live-tow [data-of=moved]')].map((one) => one.textContent)"
    assert set(asked.browser.ask(shown)) == {"…"}
    assert asked.said("command") == ""
    asked.browser.ask(f"{TOW}.busy = false; {TOW}.change()")
    asked.settle()
    assert asked.said("command").endswith("-o moved")
    cell = "document.querySelector('#live-tow [data-figure={}] [data-of=moved]').textContent"
    assert asked.browser.ask(cell.format("margin")).endswith(": breaks")
    assert "taut from the start" in asked.browser.ask(cell.format("governing"))
    assert "is shorter than the" in asked.said("note")


def test_the_net_in_the_page_is_that_of_the_fmu(asked: Asked, kept: Path) -> None:
    """Every knot of every frame to the bit of a single, every tension to the code that a page has of it."""
    asked.browser.open(page_of(kept))
    asked.browser.ask("document.getElementById('live-shot').scrollIntoView()")
    asked.wait(f"{SHOT}?.state === 'ready'")
    assert asked.browser.ask(f"{SHOT}.replay.playing") is False
    asked.browser.ask("document.querySelector('#live-shot [data-part=button]').click()")
    asked.wait("document.getElementById('live-shot').dataset.done")
    assert "Unmoved it is the run again, bit for bit" in asked.said("status", "live-shot")
    asked.browser.ask(f"{SHOT}.replay.parts.speed.value = '30'")
    asked.wait(f"!{SHOT}.replay.playing && {SHOT}.replay.frame === {SHOT}.held - 1")
    nodes = pd.read_parquet(kept / "replay_nodes.parquet")
    frames = nodes["time"].nunique()
    wanted = nodes[[f"position[{i}]" for i in (1, 2, 3)]].to_numpy(np.float32).ravel()
    assert asked.browser.ask(f"{SHOT}.held") == frames
    clip = f"{SHOT}.replay.clip.net"
    shown = asked.browser.ask(f"Array.from({clip}.nodes.values.subarray(0, {len(wanted)}))")
    np.testing.assert_array_equal(np.array(shown, dtype=np.float32), wanted)
    tension = pd.read_parquet(kept / "replay_threads.parquet")["tension"].to_numpy(float)
    codes = np.array(asked.browser.ask(f"Array.from({clip}.tensions.codes.subarray(0, {len(tension)}))"))
    told = decoded(packing.tensions(tension, float(tension.max()))).ravel().astype(int)
    assert (codes == told).mean() > 0.999  # one code off where a tension lies between two
    assert np.abs(codes - told)[(codes > 0) & (told > 0)].max() <= 1
    assert asked.browser.said == []


def test_another_shot_is_that_of_the_run_with_its_values(asked: Asked, kept: Path, tmp_path: Path) -> None:
    """In the page that the test before has left."""
    asked.browser.ask(
        f"(() => {{ const k = {SHOT}.knobs[0]; k.number.value = 3.3; k.number.dispatchEvent(new Event('change')); }})()"
    )
    cells = "[...document.querySelectorAll('#live-shot [data-of=moved]')].map((one) => one.textContent).join('')"
    assert asked.browser.ask(cells) == "", "they would be those of the shot before"
    assert "shoot again" in asked.said("status", "live-shot")
    words = shlex.split(asked.said("command", "live-shot"))
    assert words[-4:] == ["--set", "capture.bullets.speed=3.3 m/s", "-o", "moved"]
    asked.browser.ask("document.querySelector('#live-shot [data-part=button]').click()")
    asked.wait("document.getElementById('live-shot').dataset.done")
    assert "bit for bit" not in asked.said("status", "live-shot")
    figures = asked.browser.ask(f"{SHOT}.over.figures")
    moved = put(kept, tmp_path / "moved", words[-3:-2])
    last = pd.read_parquet(moved / "capture.parquet").iloc[-1]
    own = pd.read_parquet(kept / "capture.parquet").iloc[-1]
    for name in ("t_capture", "thread.tension_max", "cord.tension_max", "mouth.area"):
        assert figures[name] == last[name]
    summaries = [json.loads((folder / "summary.json").read_text())["capture"] for folder in (kept, moved)]
    for line in ("thread", "cord"):
        cells = f"""[...document.querySelectorAll('[data-figure="margin of {line}.tension_max"] [data-of]')]"""
        own_spread = CAPTURE[f"{line}.tension_max"]
        margins = [one[f"{line}.margin_of_safety"]["value"] for one in summaries]
        wanted = [spoken(margin, own_spread * (1.0 + margin) / margin) for margin in margins]
        assert asked.browser.ask(f"{cells}.map((one) => one.textContent)") == wanted
        assert margins[0] != margins[1]
    assert figures["thread.tension_max"] != own["thread.tension_max"]


def test_a_page_says_why_it_has_no_model(bare: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: Any, **__: Any) -> None:
        raise FmuError("no linker")

    monkeypatch.setattr(build, "write_fmus", fails)
    page = Page(of_folder(bare, tmp_path / "page.html", progress=Progress()))
    assert page.text.count("its library for a page could not be built: no linker") == 2
    assert not {"live", "shot"} & page.data.keys()
    assert "--no-live" in Page(of_folder(bare, tmp_path / "page.html")).text


def test_coupled_fmus_and_fmus_from_elsewhere_have_no_page(bare: Path) -> None:
    run = read_run(bare)
    coupled = load("reel-control").phases[0]
    assert coupled.others
    run.scene = run.scene.with_phase(coupled)
    assert "several FMUs that are coupled" in str(carried.carry(bare, run, coupled.name, Progress()))
    assert "no places of its nodes" in str(live.of_shot(bare, _without_nodes(bare), Progress()))


def _without_nodes(folder: Path) -> Any:
    run = read_run(folder)
    phase = run.scene.phases[0]
    terms = {name: term for name, term in phase.main.terms.items() if name not in ("nodes", "threads")}
    run.scene = run.scene.with_phase(replace(phase, main=replace(phase.main, terms=terms)))
    return run


def test_a_page_is_no_machine_of_the_command_line() -> None:
    assert build.PAGE not in build.platform_names("all")
