"""Terms say what they need; a capacity follows from its net; an unknown unit is answered with those that are known."""

from __future__ import annotations

import importlib
import re
from collections.abc import Callable
from dataclasses import replace

import pytest

from dcone_cosim import build
from dcone_cosim.errors import InputError
from dcone_cosim.loading import find, load
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.reports import figures
from dcone_cosim.scene.data import Scene
from dcone_cosim.scenes.reading import parse
from fmu_src.interface import Term, check_implemented
from fmu_src.lanes import REALS
from fmu_src.net_capture.composition import Composition
from tests.cosim.mock_components import MockCapture

MESH = 'side = "12 m"'
MakeScene = Callable[..., Scene]


def without(text: str, table: str) -> str:
    """A scene's text without one of its tables."""
    found = re.subn(rf"(?ms)^\[{re.escape(table)}\]$.*?(?=^\[)", "", text)
    assert found[1] == 1
    return found[0]


@pytest.fixture
def shot() -> str:
    return find("table1-capture").read_text()


class TestNeeds:
    def test_contact_without_a_target_is_a_mistake_in_the_scene(self) -> None:
        text = without(find("mission").read_text(), "capture.target")
        with pytest.raises(InputError, match=r"capture\.contact.*: needs the table \[capture\.target\]") as told:
            parse(text, "mine", "mine")
        assert "capture.contact.restitution" not in str(told.value), "what follows from the mistake is not told"

    @pytest.mark.parametrize("name", sorted(build.CATALOGUE))
    def test_terms_are_declared_that_are_implemented_and_no_others(self, name: str) -> None:
        """A part of the net says itself how its kernels are made; the others keep a table."""
        model = build.CATALOGUE[name]
        if name == "net_capture":
            # outputs for so many nodes and bullets, and what an ejector's data or a section come to, ask for no kernels
            none = (*build.FAMILIES, "bullets", "ejector", "section")
            groups = {name: group for name, group in model.groups.items() if name not in none}
            assert sorted(groups.pop("precision").terms) == sorted(REALS)
            assert all(term.make is not None for group in groups.values() for term in group.terms.values())
            return
        implemented = importlib.import_module(model.module).IMPLEMENTED
        assert set(implemented) == set(model.groups)
        for group_name, group in model.groups.items():
            assert sorted(implemented[group_name]) == sorted(group.terms)

    def test_one_that_no_kernel_implements_is_built_by_none(self) -> None:
        """A gravity of another name was built as none at all, and a reel of another name as a commanded one."""
        model = build.CATALOGUE["net_capture"]
        gravity = replace(model.groups["gravity"], terms={**model.groups["gravity"].terms, "j2": Term("oblate")})
        more = replace(model, groups={**model.groups, "gravity": gravity})
        with pytest.raises(ValueError, match=r"net_capture: no kernel implements gravity = 'j2'"):
            Composition(more, more.interface({"net": "square", "gravity": "j2"}).terms)
        assert Composition(more, more.interface({"net": "square", "gravity": "hill"}).terms).gravity.bends
        reel = build.CATALOGUE["tethered_deorbit"]
        implemented = importlib.import_module(reel.module).IMPLEMENTED
        with pytest.raises(ValueError, match=r"tethered_deorbit: no kernel implements reel = 'spring'"):
            check_implemented(reel, implemented, {"reel": "spring"})
        check_implemented(reel, implemented, {"reel": next(iter(reel.groups["reel"].terms))})
        removal = importlib.import_module(build.CATALOGUE["tethered_deorbit"].module)
        with pytest.raises(ValueError, match="reel = 'elastic'"):
            removal.make_entry({"reel": "elastic"})

    def test_a_term_that_lacks_what_it_needs_is_no_interface(self) -> None:
        with pytest.raises(ValueError, match="contact = 'inelastic' needs a choice of target"):
            build.CATALOGUE["net_capture"].interface({"net": "square", "gravity": "none", "contact": "inelastic"})


class TestCapacity:
    """Nodes of a net of k meshes a side: (k + 1)^2 knots, and s - 1 on each of 2 k (k + 1) threads cut into s."""

    def nodes(self, *settings: str) -> str:
        text = find("mission").read_text()
        assert text.count("capacity = 625\n") == 1
        return self.of(parse(text.replace("capacity = 625\n", ""), "mine", "mine", settings=settings))

    @staticmethod
    def of(scene: Scene) -> str:
        return scene.phases[0].main.terms["nodes"]

    @pytest.mark.parametrize(
        ("side", "segments", "count"), [(12, 1, 13 * 13), (24, 1, 25 * 25), (6, 3, 7 * 7 + 2 * 2 * 6 * 7)]
    )
    def test_it_follows_the_mesh(self, side: int, segments: int, count: int) -> None:
        settings = f"capture.net.side={side} m", "capture.net.mesh=1 m", f"capture.net.segments={segments}"
        assert self.nodes(*settings) == str(count)

    def test_unless_it_is_given(self) -> None:
        assert self.of(load("mission")) == "625"
        assert self.nodes("capture.nodes.capacity=700") == "700"
        with pytest.raises(InputError, match="capacity"):
            self.nodes("capture.nodes.capacity=0")

    def test_a_net_that_is_none_is_told_of_as_such(self) -> None:
        with pytest.raises(InputError, match=r"capture\.net\.side") as told:
            self.nodes("capture.net.mesh=11.7 m")
        assert "capacity" not in str(told.value)


def test_without_nodes_it_says_why_there_is_no_picture(make_scene: MakeScene, tmp_path) -> None:
    result = run_scene(make_scene("capture"), lambda *_: MockCapture(), Progress())
    assert not result.phases["capture"].snapshots.times
    (note,) = [note for note in figures.draw_all(result, tmp_path) if "picture" in note]
    assert note.startswith("no picture of the net in space: the scene has no table [capture.nodes]")
    assert not (tmp_path / "capture_in_space.png").exists()


@pytest.mark.parametrize(
    ("key", "value", "known"),
    [
        ("capture.net.side", "40 inch", "a length: m, mm, cm, km"),
        ("capture.net.side", "1 nmi", "a length: m, mm, cm, km"),
        ("removal.thrust.level", "1 lbf", "a force: N, mN, kN"),
        ("removal.duration", "1 month", "a time: s, ms, min, h, d, wk, yr"),
        ("capture.net.mass", "1 lb", "a mass: kg, g, t"),
    ],
)
def test_a_unit_that_is_not_known_is_answered_with_those_that_are(key: str, value: str, known: str) -> None:
    with pytest.raises(InputError) as told:
        load("mission", [f"{key}={value}"])
    assert f"has the unit '{value.split()[1]}', which is not known; known for {known}" in str(told.value)


@pytest.mark.parametrize(
    ("scene", "setting", "told"),
    [
        ("edt", 'removal.power.source="solar"', r"removal\.power.*needs the table \[removal\.engine\]"),
        ("edt", "removal.power.battery_share=0.5", r"removal\.power.*needs the table \[removal\.shadow\]"),
        ("pull-off", 'capture.leads.kind="plain"', r"capture\.leads.*cannot go together with \[capture\.closing\]"),
        ("pull-off", 'capture.leads.length="1 m"', r"capture\.leads.*cannot go together with \[capture\.closing\]"),
    ],
)
def test_a_part_whose_need_has_a_need_and_one_without_another_term_are_told(
    scene: str, setting: str, told: str
) -> None:
    """Power needs an engine, which needs a thrust; leads have but one term, which does not go beside a closing."""
    with pytest.raises(InputError, match=told):
        load(scene, [setting])
