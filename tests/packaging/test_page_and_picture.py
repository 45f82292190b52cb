"""The documentation page and the picture an FMU carries."""

import io
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest
from PIL import Image

import fmu_src
from fmu_src.catalogue import MODELS
from fmu_src.packaging import documentation, picture
from tests.conftest import CAPTURE
from tests.packaging import toy

TERMS = {"net_capture": CAPTURE, "tethered_deorbit": {"reel": "locked"}, "reel_control": {}}


class Text(HTMLParser):
    """Text and tags of a page; AssertionError if a tag is closed that is not open."""

    def __init__(self, page):
        super().__init__()
        self.open, self.tags, self.parts = [], [], []
        self.feed(page)
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        if tag not in ("meta", "img", "br", "hr"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.parts.append(data)


@pytest.mark.parametrize("name", list(TERMS))
def test_page_tells_terms_variables_faults_and_categories(name):
    interface = MODELS[name].interface(TERMS[name])
    page = documentation.page(interface, Path(fmu_src.__file__).parent / name)
    parsed = Text(page)
    text = " ".join(" ".join(parsed.parts).split())
    for group in interface.model.groups:
        term = interface.terms.get(group)
        expected = interface.model.groups[group].terms[term].summary if term else f"{group} left out"
        assert " ".join(expected.split()) in text
    for v in interface.variables:
        if v.at_interface:
            assert v.description in text, v.name
            assert re.sub(r"\[#\].*", "", v.name) in text
    for fault in interface.model.faults:
        assert " ".join(fault.text.split()) in text
    assert "logStatusDiscard" in text
    assert [t for t, _ in parsed.tags].count("h1") == 1
    assert ("img", {"src": "../model.png", "alt": name.replace("_", " ").capitalize()}) in parsed.tags


def test_page_shows_rates_and_dependences():
    page = documentation.page(toy.INTERFACE, Path("nowhere"))
    row = re.search(r"<tr>\s*<td><code>y</code></td>.*?</tr>", page, re.S).group()
    assert "<code>y_rate</code>" in row
    assert "<code>push</code>, <code>pull</code>" in row
    assert "[-10, 10]" in page
    assert "(0, 100]" in page
    assert "grid[1..3].at[1..2]" in page
    assert "left out" in page


def test_pictures_are_small_distinct_and_the_same_each_time():
    made = {name: picture.png(model.interface(TERMS[name])) for name, model in MODELS.items()}
    assert len(set(made.values())) == len(MODELS)
    for name, data in made.items():
        assert len(data) < 30_000
        assert data == picture.png(MODELS[name].interface(TERMS[name]))
        image = Image.open(io.BytesIO(data))
        assert image.size == (picture.WIDTH, picture.HEIGHT)
        assert len(image.convert("RGB").getcolors()) > 8  # something is drawn
        kinds = {data[k + 4 : k + 8] for k in chunks(data)}
        assert kinds == {b"IHDR", b"PLTE", b"IDAT", b"IEND"}  # no date, no version


def chunks(data):
    """Where each part of a PNG begins."""
    at = 8
    while at < len(data):
        yield at
        at += 12 + int.from_bytes(data[at : at + 4], "big")


def test_a_model_without_a_drawing_shows_its_inputs_and_outputs():
    other = MODELS["reel_control"].interface({})
    assert picture.png(toy.INTERFACE) != picture.png(other)
