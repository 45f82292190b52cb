"""The page in Chromium: it loads without an error, is drawn, heeds keys, fits both widths and both themes."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation

from dcone_cosim import build
from dcone_cosim.findings import spoken
from dcone_cosim.loading import load
from dcone_cosim.report import packing
from dcone_cosim.report.page import colours, of_folder
from dcone_cosim.scenery import Clip, Swing
from tests.report.browser import Browser, chromium

WIDE, NARROW = 1280, 390


@pytest.fixture(scope="module")
def place(kept: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    chromium()
    path = tmp_path_factory.mktemp("page") / "report.html"
    path.write_text(of_folder(kept, path))
    return path


@pytest.fixture(scope="module")
def browser(place: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    one = Browser(tmp_path_factory.mktemp("profile"), WIDE)
    try:
        one.open(place)
        yield one
    finally:
        one.close()


def test_nothing_goes_wrong_and_nothing_moves_by_itself(browser: Browser) -> None:
    assert browser.said == []
    assert browser.ask("window.dcone.faults.length") == 0
    frame = browser.ask("window.dcone.replays.capture.frame")
    browser.ask("new Promise((done) => setTimeout(done, 300))")
    assert browser.ask("window.dcone.replays.capture.frame") == frame
    assert browser.ask("window.dcone.replays.capture.playing") is False


def test_a_part_that_swings_is_where_its_hinge_puts_it(browser: Browser) -> None:
    """Corners of body and wing as the page's own objects have them at an angle, and at another one, against the
    formula's; `rest` and `part` are drawn apart."""
    main = load("hinged-panel").phases[0].main
    values = {**main.values, **main.made}
    surface, swing = build.target_surface(values, main.terms), build.target_swing(values, main.terms)
    hinge = build.target_hinge(values, main.terms)
    assert surface is not None
    assert swing is not None
    assert hinge is not None
    angles = np.array([0.6, -0.4])
    still, at = np.zeros((2, 3)), np.array([[1.0, 2.0, 3.0], [3.0, 1.0, 2.0]])
    attitude = Rotation.from_rotvec([[0.3, -0.2, 0.5], [-0.7, 0.4, 0.1]])
    shown = (np.array(surface[0]), [list(face) for face in surface[1]])
    one = Clip("capture", "", "", np.array([0.0, 1.0]), still, at, attitude.as_quat(scalar_first=True), shown)
    packed = packing.clip(replace(one, swing=Swing(angles, **hinge)))
    begun = (
        "(async () => { const { Bodies } = await import('dcone/bodies'); const THREE = await import('three');"
        f" const b = new Bodies({json.dumps(packed)}, null, new THREE.Scene()), {{ rest, part }} = b.swing;"
    )
    for frame, angle in enumerate(angles):
        told = browser.ask(
            f"{begun} b.show({frame}); b.body.updateMatrixWorld(true);"
            " return b.clip.surface.corners.map(([r, a, c], n) => (b.clip.swing.corners[n] ? part : rest)"
            ".localToWorld(new THREE.Vector3(a, r, -c)).toArray()); })()"
        )
        wanted = at[frame] + attitude[frame].apply(swing(float(angle)))
        np.testing.assert_allclose(told, wanted[:, [1, 0, 2]] * [1.0, 1.0, -1.0], atol=1e-6)
    faces = browser.ask(
        f"{begun} return [rest, part].map((one) => one.children[0].geometry.attributes.position.count / 3); }})()"
    )
    assert sum(faces) == sum(len(face) - 2 for face in surface[1])
    assert faces[0] == 12


def test_threads_have_the_colour_of_their_tension(browser: Browser, kept: Path) -> None:
    """Tone and colour of the page's own objects, against the table and matplotlib's map."""
    threads = pd.read_parquet(kept / "replay_threads.parquet")
    tension = threads["tension"].to_numpy(float).reshape(threads["time"].nunique(), -1)
    frame = int(np.argmax((tension > 0.01 * tension.max()).sum(axis=1)))
    browser.ask(f"window.dcone.replays.capture.go({frame})")
    tones = np.array(browser.ask("[...window.dcone.replays.capture.bodies.threads.tone.array]"))
    shown = tension[frame] > 1.01e-3 * tension.max()
    assert (tones[~shown & (tension[frame] < 0.99e-3 * tension.max())] == -1.0).all()
    wanted = 1.0 + np.log10(tension[frame][shown] / tension.max()) / 3.0
    np.testing.assert_allclose(tones[shown], wanted, atol=0.003)
    given = browser.ask(
        "[...window.dcone.replays.capture.bodies.threads.object.material.uniforms.colours.value.image.data]"
    )
    assert np.array(given).reshape(256, 4)[:, :3].ravel().tolist() == colours()


def test_a_turning_body_and_its_net_are_in_one_frame(browser: Browser, kept: Path) -> None:
    """The page's axes are (along-track, radial, -cross-track), a turn of ours: a corner must go with it."""
    rows = pd.read_parquet(kept / "capture.parquet")
    browser.ask("window.dcone.replays.capture.go(1e9)")
    told = browser.ask(
        "(() => { const b = window.dcone.replays.capture.bodies; b.body.updateMatrixWorld();"
        " const c = b.clip.surface.corners[0]; const v = b.ship.position.clone().set(c[1], c[0], -c[2]);"
        " return [...b.body.localToWorld(v).toArray(), c]; })()"
    )
    last = rows.iloc[-1]
    turn = Rotation.from_quat([last[f"target.attitude[{i}]"] for i in range(1, 5)], scalar_first=True)
    radial, along, cross = turn.apply(told[3]) + [last[f"target.position[{i}]"] for i in (1, 2, 3)]
    assert told[:3] == pytest.approx([along, radial, -cross], abs=1e-5)


def test_a_number_is_told_alike_by_page_and_package(browser: Browser) -> None:
    rng = np.random.default_rng(7)
    values = [*(rng.uniform(-1.0, 1.0, 400) * 10.0 ** rng.uniform(-9.0, 9.0, 400)), 0.0, 999.96, 9999.7, 1e6, 1e-4]
    rows = [(float(value), float(spread)) for value in values for spread in (0.0, 3e-4, 0.31, 1.4)]
    told = browser.ask(
        f"import('dcone/bytes').then((m) => {[list(row) for row in rows]}.map(([v, s]) => m.spoken(v, 4, s)))"
    )
    assert [(row, one) for row, one in zip(rows, told, strict=True) if spoken(*row) != one] == []


def test_a_tug_is_shown_by_the_frame_that_has_it(browser: Browser, kept: Path) -> None:
    """The buttons of first and largest tug lead to the row whose step had it, where the tether is not slack."""
    replay = "window.dcone.replays.removal"
    marks = browser.ask(f"{replay}.clip.marks")
    rows = pd.read_parquet(kept / "removal.parquet")
    assert marks
    for n, mark in enumerate(marks):
        browser.ask(f"{replay}.parts.marks.children[{n}].click()")
        time = browser.ask(f"{replay}.times[{replay}.frame]")
        assert time == rows["time"][rows["time"] >= mark["time"]].min()
        said = browser.ask(f"{replay}.parts.told.textContent")
        peak = rows.loc[rows["time"] == time, "tether.tension_peak"].iloc[0]
        assert float(said.split("up to ")[1].split(" N")[0]) == pytest.approx(peak, rel=0.02)


def test_the_tether_and_what_holds_it_reach_the_target(browser: Browser) -> None:
    """Of a target that is a point, on which the tether ends short of the centre of mass."""
    bodies = "window.dcone.replays.removal.bodies"
    begin, end = browser.ask(f"[[...{bodies}.held.begin.array], [...{bodies}.held.end.array]]")
    assert begin == pytest.approx(browser.ask(f"[...{bodies}.tether.end.array]"))
    assert end == pytest.approx(browser.ask(f"{bodies}.body.position.toArray()"), abs=1e-5)
    assert np.linalg.norm(np.subtract(end, begin)) > 0.5


def test_keys_step_play_and_turn(browser: Browser) -> None:
    browser.ask("document.querySelector('#replay-capture .stage').focus()")
    frame = "window.dcone.replays.capture.frame"
    for key, shift, wanted in (
        ("Home", False, 0), ("ArrowRight", False, 1), ("ArrowRight", True, 11), ("ArrowLeft", False, 10),
    ):  # fmt: skip
        browser.key(key, shift)
        assert browser.ask(frame) == wanted
    browser.key("End")
    assert browser.ask(f"{frame} === window.dcone.replays.capture.times.length - 1")
    browser.key("Home")
    browser.key("Space")
    assert browser.ask("window.dcone.replays.capture.playing") is True
    browser.key("Space")
    assert browser.ask("window.dcone.replays.capture.playing") is False
    turned = browser.ask("window.dcone.replays.capture.camera.turned")
    browser.key("d")
    assert browser.ask("window.dcone.replays.capture.camera.turned") == pytest.approx(turned + 0.08)
    assert browser.ask("getComputedStyle(document.activeElement).outlineWidth") == "3px"


def test_a_chart_is_zoomed_by_keys_and_shows_all_again(browser: Browser) -> None:
    chart = "window.dcone.charts['removal-tension']"
    browser.ask(f"{chart}.plot.focus()")
    all_of_it = browser.ask(f"{chart}.all")
    browser.key("+")
    low, high = browser.ask(f"{chart}.shown")
    assert high - low == pytest.approx(0.7 * (all_of_it[1] - all_of_it[0]))
    browser.key("0")
    assert browser.ask(f"{chart}.shown") == all_of_it
    tugs = browser.ask(f"{chart}.svg.querySelectorAll('.stems:not(.faint) circle').length")
    assert tugs == browser.ask(f"{chart}.series.find((row) => row.name === 'tugs').x.length") > 0


def test_values_of_a_chart_are_read_by_keys_and_said(browser: Browser, kept: Path) -> None:
    """Every tug of the table in its turn, in a live region; a curve by rows seen apart; in sight when zoomed."""
    chart = "window.dcone.charts['removal-tension']"
    browser.ask(f"{chart}.show(...{chart}.all); {chart}.plot.focus()")
    said = f"{chart}.readout.value"
    assert browser.ask(f"[{chart}.readout.getAttribute('aria-live'), {chart}.plot.getAttribute('role')]") == [
        "polite",
        "application",
    ]
    browser.key("Home")
    assert browser.ask(said).startswith("tension at the communication steps: 0 N at 0 min")
    browser.key("ArrowDown")
    tugs = pd.read_parquet(kept / "tugs.parquet")
    for n, row in tugs.iterrows():
        told = f"tugs, {n + 1} of {len(tugs)}: {spoken(row['peak'])} N at {spoken(row['time'] / 60.0, most=5)} min"
        assert browser.ask(said).startswith(told)
        browser.key("ArrowRight")
    chart = "shown: [0, 1], inner: { width: 100 }, series: [{ kind, x: [0, 1e-6, 2e-6], y: [1, 2, 3] }]"
    walk = "(kind) => { const c = new m.Cursor({ " + chart + " }); return [1, 1, 1].map((n) => (c.walk(n), c.index)); }"
    told = browser.ask(f"import('dcone/cursor').then((m) => ['stems', 'line'].map({walk}))")
    assert told == [[0, 1, 2], [0, 2, 2]], "no tug is left out, of a curve what falls together is"
    mouth = "window.dcone.charts['capture-mouth']"
    browser.ask(f"{mouth}.plot.focus()")
    rows = pd.read_parquet(kept / "capture.parquet")
    for _ in range(3):
        browser.key("ArrowRight", shift=True)
    place = browser.ask(f"{mouth}.cursor.index")
    assert place >= 20
    assert browser.ask(f"[{mouth}.cursor.time, {mouth}.cursor.value]") == pytest.approx(
        rows.iloc[place][["time", "mouth.area"]].tolist(), rel=1e-6
    )
    for _ in range(12):
        browser.key("+")
    low, high = browser.ask(f"{mouth}.shown")
    assert low <= browser.ask(f"{mouth}.cursor.time") <= high
    browser.key("End")
    assert browser.ask(f"{mouth}.shown[1]") == browser.ask(f"{mouth}.all[1]")
    assert browser.ask(f"{mouth}.readout.value").endswith("; captured, hand-over condition met")
    browser.key("0")


def test_a_chart_gives_its_values_as_csv(browser: Browser, kept: Path) -> None:
    told = browser.ask("import('dcone/csv').then((m) => m.csvOf(window.dcone.charts['removal-tension']))")
    head, *lines = told.strip().split("\n")
    assert head.startswith("time since the hand-over [min],tension at the communication steps [N],tugs [N]")
    columns = [line.split(",") for line in lines]
    rows, tugs = (pd.read_parquet(kept / f"{name}.parquet") for name in ("removal", "tugs"))
    for n, table, value in ((1, rows, "tether.tension"), (2, tugs, "peak")):
        own = np.array([(row[0], row[n]) for row in columns if row[n]], dtype=float)
        np.testing.assert_allclose(own[:, 0] * 60.0, table["time"], rtol=1e-12)
        assert (own[:, 1].astype(np.float32) == table[value].to_numpy(np.float32)).all()
    twice = "{ data: { clock: 't', xUnit: 's', unit: 'N' }, series: [{ name: 'a,b', x: [0, 1, 1], y: [1, 2, 3] }] }"
    assert browser.ask(f"import('dcone/csv').then((m) => m.csvOf({twice}))") == 't [s],"a,b [N]"\n0,1\n1,2\n1,3\n'


def test_letters_of_marks_stand_over_the_curves_and_apart(browser: Browser) -> None:
    chart = "window.dcone.charts['capture-energies']"
    letters = f"[...{chart}.svg.querySelectorAll('.mark text')]"
    places = browser.ask(f"{letters}.map((one) => ['x', 'y'].map((name) => +one.getAttribute(name)))")
    assert len(places) == browser.ask(f"{chart}.data.marks.length") > 3
    assert all(y < browser.ask(f"{chart}.margin.top") for _, y in places)
    assert np.diff([x for x, _ in places]).min() >= 10.99
    key = browser.ask(f"{chart}.key_of_marks.textContent")
    assert key.startswith("a mouth widest, ")


def test_no_table_hides_a_column(browser: Browser) -> None:
    """On a narrow screen rows become cards, values beside their heads; else a table slides, and says so."""
    over = "one.scrollWidth > one.clientWidth + 1 && !one.classList.contains('slides')"
    heads = "[...document.querySelectorAll('.stacked td')].map((one) => [one.dataset.head, shown(one)])"
    of_kinds = "['.stacked', '.slides'].map((name) => document.querySelectorAll(name).length)"
    size = {"height": 900, "deviceScaleFactor": 1, "mobile": False}
    try:
        for width, kinds in ((NARROW, (True, False)), (640, (False, True)), (WIDE, (False, False))):
            browser.call("Emulation.setDeviceMetricsOverride", width=width, **size)
            browser.ask("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
            counts = f"[...document.querySelectorAll('.wide')].filter((one) => {over}).length, cards, slide"
            found = (-1, 0, 0)
            began = time.perf_counter()
            while (found[0], found[1] > 1, found[2] > 0) != (0, *kinds) and time.perf_counter() - began < 10.0:
                time.sleep(0.05)
                found = tuple(browser.ask(f"(([cards, slide]) => [{counts}])({of_kinds})"))
            _, cards, slide = found
            assert (found[0], cards > 1, slide > 0) == (0, *kinds)
            if cards:
                shown = "const shown = (one) => getComputedStyle(one, '::before').content"
                told = browser.ask(f"(() => {{ {shown}; return {heads}; }})()")
                assert ["margin of safety", '"margin of safety"'] in told
            if slide:
                assert browser.ask("document.querySelector('.cue:not([hidden])').textContent").startswith("→ ")
                assert browser.ask("document.querySelector('.slides').tabIndex") == 0
    finally:
        browser.call("Emulation.setDeviceMetricsOverride", width=WIDE, **size)


@pytest.mark.parametrize("width", [WIDE, NARROW])
@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_it_fits_and_is_drawn(browser: Browser, place: Path, tmp_path: Path, width: int, dark: bool) -> None:
    browser.call("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
    scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
    browser.call("Emulation.setEmulatedMedia", features=[scheme])
    assert browser.ask("document.documentElement.scrollWidth") <= width
    paper = browser.ask("getComputedStyle(document.body).backgroundColor")
    assert paper == ("rgb(20, 24, 29)" if dark else "rgb(255, 255, 255)")
    top = browser.ask("document.querySelector('#replay-capture .stage').getBoundingClientRect().top + scrollY")
    browser.picture(tmp_path / "stage.png", top=top, height=280)
    pixels = np.asarray(Image.open(tmp_path / "stage.png").convert("RGB"), dtype=int)
    assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 200, "a net, a body, a grid"
    assert browser.said == []


def test_both_ends_of_a_long_tether_are_in_sight(browser: Browser) -> None:
    """A kilometre upright, across and along the view: none of its ends is beyond the edge, and one comes near to it."""
    camera = "window.dcone.replays.removal.camera"
    for turned, raised in ((0.65, 0.38), (0.0, 0.12), (0.0, 1.5)):
        for axis in ("500, 0, 0", "0, 500, 0", "0, 0, 500", "300, 400, 0"):
            seen = browser.ask(
                f"(() => {{ const c = {camera}, v = c.about.clone().set({axis}), ends = [v, v.clone().negate()];"
                f" c.look(v.clone().set(0, 0, 0), 100, {turned}, {raised}, ends); c.place();"
                " return ends.map((one) => one.project(c.eye).toArray()); })()"
            )
            edge = np.abs(np.array(seen)[:, :2]).max()
            assert 0.6 < edge < 0.95 or (axis == "0, 0, 500" and edge < 0.95), "along the view it is seen short"
    browser.ask("window.dcone.replays.removal.look('slanting')")


def test_what_is_folded_is_printed(browser: Browser) -> None:
    browser.ask("document.querySelectorAll('details').forEach((one) => { one.open = false; })")
    browser.ask("dispatchEvent(new Event('beforeprint'))")
    assert browser.ask("[...document.querySelectorAll('details.given')].map((one) => one.open)") == [True, True]


def test_the_switch_overrides_the_system(browser: Browser) -> None:
    browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "light"}])
    seen = []
    for _ in range(3):
        browser.ask("document.getElementById('theme').click()")
        seen.append(
            browser.ask(
                "[document.getElementById('theme').textContent, getComputedStyle(document.body).backgroundColor]"
            )
        )
    light, dark = "rgb(255, 255, 255)", "rgb(20, 24, 29)"
    assert seen == [["theme: light", light], ["theme: dark", dark], ["theme: auto", light]]
