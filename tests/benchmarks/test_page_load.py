"""How long a page with a replay of 10 MB takes until it can be used, in Chromium without a window and without a GPU."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path
from statistics import median

import numpy as np
import pytest

from dcone_cosim.report import packing
from dcone_cosim.report.page import of_folder
from tests.report.browser import Browser, chromium
from tests.report.conftest import kept
from tests.report.test_packing import decoded

__all__ = ["kept"]
SIZE = 10_000_000
"""Of the replay, in bytes before they are text."""
TIMES = 5
DATA = re.compile(r'(<script type="application/json" id="data">)(.*?)(</script>)', re.DOTALL)


def with_frames(content: str, size: int) -> tuple[str, int, int]:
    """A page whose net has so many frames that its replay has that size; frames, and bytes of the net's arrays."""
    head = DATA.search(content)
    assert head is not None
    data = json.loads(head[2].replace("<\\/", "</"))
    clip = next(one for one in data["clips"] if "net" in one)
    frames, nodes, _ = clip["net"]["nodes"]["shape"]
    threads = clip["net"]["tensions"]["shape"][1]
    wanted = -(-size // (6 * nodes + threads))
    turn = np.resize([*range(frames), *range(frames - 2, 0, -1)], wanted)

    def again(part: dict[str, object], dtype: str) -> None:
        array = decoded(part).astype(dtype)[turn]
        part["shape"], part["data"] = list(array.shape), packing.text_of(array)

    for name in ("chaser", "target", "attitude", "line", "bullets"):
        if name in clip:
            again(clip[name], "<f4")
    again(clip["net"]["nodes"], "<u2")
    again(clip["net"]["tensions"], "u1")
    clip["times"] = packing.doubles(np.linspace(0.0, 60.0, wanted))
    text = json.dumps(data, separators=(",", ":")).replace("</", "<\\/")
    return content[: head.start(2)] + text + content[head.end(2) :], wanted, wanted * (6 * nodes + threads)


def spent(browser: Browser) -> float:
    """CPU time of all processes of a browser [s]."""
    tick = os.sysconf("SC_CLK_TCK")
    parents, times = {}, {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        number = int(path.parent.name)
        parents[number], times[number] = int(fields[1]), (int(fields[11]) + int(fields[12])) / tick
    wanted, found = [browser.process.pid], 0.0
    while wanted:
        one = wanted.pop()
        found += times.get(one, 0.0)
        wanted += [number for number, parent in parents.items() if parent == one]
    return found


@pytest.mark.bench
def test_a_page_with_a_replay_of_ten_megabytes(kept: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Until it is ready, by the page's own clock from its navigation on; and the CPU time of its main thread."""
    chromium()
    content = of_folder(kept, tmp_path / "report.html")
    large, frames, size = with_frames(content, SIZE)
    rows = {}
    for name, text in (("as it is", content), ("with 10 MB of replay", large)):
        page = tmp_path / "page.html"
        page.write_text(text)
        found = []
        browser = Browser(tmp_path / f"profile-{len(rows)}")
        try:
            browser.call("Performance.enable", timeDomain="threadTicks")
            for _ in range(TIMES):
                before = spent(browser)
                browser.open(page)
                browser.ask("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
                metrics = {one["name"]: one["value"] for one in browser.call("Performance.getMetrics")["metrics"]}
                found.append(
                    (browser.ask("window.dcone.ready") / 1e3, metrics["TaskDuration"], spent(browser) - before)
                )
            shown = browser.ask("window.dcone.replays.capture.times.length")
            assert browser.said == []
            assert text is content or shown == frames
        finally:
            browser.close()
        rows[name] = (page.stat().st_size, *(median(column) for column in zip(*found, strict=True)))
    with capsys.disabled():
        print()
        for name, (length, ready, busy, cpu) in rows.items():
            print(
                f"page {name}, {length / 1e6:.1f} MB: ready after {ready:.2f} s; CPU time of its main thread "
                f"{busy:.2f} s, of all of Chromium, which draws without a GPU, {cpu:.2f} s"
            )
        print(f"the replay has {frames} frames, {size / 1e6:.1f} MB; median of {TIMES}")
