"""What a test run compiles once for all its processes."""

import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest

from fmu_src import instance
from fmu_src.catalogue import MODELS
from fmu_src.instance import Instance
from fmu_src.packaging import compile, tools
from orbital.kernel import kernel
from tests import kernels
from tests.conftest import CAPTURE, FREE

MODEL = MODELS["reel_control"]


def test_whoever_comes_second_waits_for_what_the_first_makes(tmp_path):
    made = []

    def make(path):
        made.append(path)
        path.write_text("half")
        time.sleep(0.2)
        path.write_text("whole")

    with ThreadPoolExecutor(4) as pool:
        paths = list(pool.map(lambda _: kernels.made_once(tmp_path / "x.so", make), range(4)))
    assert [path.read_text() for path in paths] == ["whole"] * 4
    assert len(made) == 1


def test_what_could_not_be_made_is_made_by_the_next(tmp_path):
    def fail(path):
        path.write_text("half")
        raise OSError("full")

    with pytest.raises(OSError, match="full"):
        kernels.made_once(tmp_path / "x.ll", fail)
    assert not (tmp_path / "x.ll").exists()
    assert kernels.made_once(tmp_path / "x.ll", lambda path: path.write_text("whole")).read_text() == "whole"


@pytest.mark.skipif(kernels.compiled_where_run(), reason="numba is asked for code that no library holds")
def test_kernels_that_are_made_from_the_same_are_compiled_once():
    def times(factor):
        @kernel
        def product(x):
            return factor * x

        return product

    first, same, other = times(2.5), times(2.5), times(3.5)
    assert first.dispatcher is same.dispatcher
    assert other.dispatcher is not first.dispatcher
    assert (first(2.0), same(2.0), other(2.0)) == (5.0, 5.0, 7.0)
    assert (same(2), other(2)) == (5.0, 7.0)
    assert len(first.dispatcher.overloads) == 2


@pytest.fixture
def asked(monkeypatch, tmp_path):
    """Terms that were compiled since the start of a run of its own, which finds nothing in the user's cache."""
    emit, asked = kernels.emit_quickly, []
    for module, name in ((compile, "emit"), (instance, "entry_of")):
        monkeypatch.setattr(module, name, getattr(module, name))  # put back afterwards
    monkeypatch.setattr(
        kernels, "emit_quickly", lambda model, terms, *to: (asked.append(dict(terms)), emit(model, terms, *to))
    )
    monkeypatch.setattr(kernels.builds, "kernels", lambda *_: None)
    kernels.share(tmp_path)
    return asked


@pytest.mark.skipif(kernels.compiled_where_run(), reason="numba is asked for code that no library holds")
def test_each_choice_of_terms_is_compiled_once(asked, tmp_path):
    for terms in ({}, {"motor": "lag"}, {}, {"motor": "lag"}):
        made = Instance(MODEL, terms, {"length": 12.5, "gain.proportional": 2.0, "feed_forward": 0.5}).initialise()
        assert isinstance(made.entry, kernels.Entry)
        assert made["tension"] == 1.5
        made["length"] = 13.0
        made.step(0.1)
        assert (made["tension"] == 2.5) == (terms == {})
        compile.emit(MODEL, made.interface.terms, tmp_path / "model.ll", tmp_path / "kernels")
    assert asked == [{}, {"motor": "lag"}]


@pytest.mark.parametrize(
    ("model", "before", "terms"),
    [
        ("reel_control", {"motor": "lag"}, {}),
        # in its text are numbers that numba gave to types
        pytest.param("net_capture", FREE, CAPTURE, marks=pytest.mark.evidence),
    ],
)
def test_the_text_is_that_of_a_process_that_begins_with_nothing(model, before, terms, numba_as_it_comes, tmp_path):
    """Whatever the one that compiled it has compiled before."""
    made = []
    quickly = kernels.emit_quickly
    for k, (emit, chosen) in enumerate(((quickly, before), (quickly, terms), (kernels.emit, terms))):
        interface = MODELS[model].interface(chosen)
        emit(interface.model, interface.terms, tmp_path / f"{k}.ll", tmp_path / "kernels")
        made.append((tmp_path / f"{k}.ll").read_text())
    assert made[1] == made[2]
    assert made[0] != made[1]


def test_what_cannot_be_compiled_says_why(tmp_path):
    with pytest.raises(
        tools.BuildError,
        match=r"compiling the kernels of reel_control failed:(.|\n)*no kernel implements motor = 'none such'",
    ):
        kernels.emit_quickly(MODEL, {"motor": "none such"}, tmp_path / "x.ll", tmp_path / "kernels")
    kernels.emit_quickly(MODEL, MODEL.interface({}).terms, tmp_path / "x.ll", tmp_path / "kernels")


def test_a_model_of_a_tests_own_is_compiled_where_it_is(asked):
    made = Instance(replace(MODEL), {}, {"length": 12.5}).initialise()
    assert not isinstance(made.entry, kernels.Entry)
    assert asked == []
