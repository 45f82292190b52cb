"""README's pictures made again, from a gallery of the scenes that they are of: `python -m tests.report.pictures`.

    mission-capture.png, mission-tension.png    figures of the run of `mission` in the gallery
    mission-page.png                            its page in Chromium, the line moved to 2 mm

Those of accuracy are measured, and have commands of their own: see tests/README.md.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path

from PIL import Image

from dcone_cosim.progress import Progress
from dcone_cosim.report.gallery import make
from tests.report.browser import Browser

PLACE = Path(__file__).parents[2] / ".readme"
SCENE = "mission"
FIGURES: Mapping[str, str] = {
    "mission-capture.png": "capture_in_space.png",
    "mission-tension.png": "tether_tension.png",
}
"""Name among README's pictures, and in the folder of the run."""
PAGE = "mission-page.png"
MOVED = "2"
"""Diameter of the line that the picture of the page shows [mm]."""
PATIENCE = 300.0
"""[s]"""


def pictures(place: Path, gallery: Path) -> list[Path]:
    """Make all of them in a folder; the gallery goes on from what is in its own."""
    index, failed = make([SCENE], gallery, Progress())
    if failed:
        raise SystemExit(f"no pictures: {failed[SCENE]}")
    for name, figure in FIGURES.items():
        shutil.copyfile(index.parent / "runs" / SCENE / figure, place / name)
    _page(index.parent / f"{SCENE}.html", place / PAGE)
    return [place / name for name in (*FIGURES, PAGE)]


def _page(page: Path, path: Path) -> None:
    """The tow in the page with another line, as a picture of few colours."""
    done = "document.getElementById('live-tow').dataset.done"
    with tempfile.TemporaryDirectory() as profile:
        browser = Browser(Path(profile), 1280)
        try:
            browser.open(page)
            _wait(browser, done)
            browser.ask(
                "(() => { const [k] = window.dcone.live.knobs;"
                f" k.number.value = {MOVED}; k.number.dispatchEvent(new Event('change')); }})()"
            )
            _wait(browser, f"{done} === String(window.dcone.live.number)")
            _wait(browser, "!document.querySelector('#live-tow .figures').innerText.includes('…')")
            top, height = (
                browser.ask(f"document.getElementById('{name}').getBoundingClientRect().{side}")
                for name, side in (("ask", "top"), ("live-tow", "height"))
            )
            browser.picture(path, top=top + browser.ask("scrollY") - 10.0, height=height + 60.0)
        finally:
            browser.close()
    Image.open(path).convert("RGB").quantize(128, dither=Image.Dither.NONE).save(path, optimize=True)


def _wait(browser: Browser, condition: str) -> None:
    began = time.perf_counter()
    while not browser.ask(condition):
        if time.perf_counter() - began > PATIENCE:
            raise SystemExit(f"the page does not come to an end: {browser.said}")
        time.sleep(0.05)


if __name__ == "__main__":
    kept = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(tempfile.mkdtemp())
    print(*pictures(PLACE, kept), sep="\n")
