"""Kernels that are kept: found again by what they are made from, whatever the record around their fields."""

from __future__ import annotations

import importlib
import json
import math
import shutil
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from dcone_cosim.api import load_scene
from dcone_cosim.loading import shipped
from fmu_src.catalogue import MODELS
from orbital import keeping, linking, vectors
from orbital.kernel import kernel
from orbital.keys import Keys, NoKeyError
from tests import emitting, kernels

pytestmark = pytest.mark.usefixtures("compiled")
MODULE = """
import json
import sys
from pathlib import Path

import numpy as np

from orbital import keeping
from orbital.kernel import entry, kernel, view

LIMIT = 3.0


@kernel
def half(x):
    return 0.5 * min(x, LIMIT)


def make_add(factor, half):
    @kernel
    def add(p, x):
        p.sum += factor * half(x) + tail(p.offsets)[0]
    return add


@view
def tail(values):
    return values[1:]


@kernel
def tell(records, command):
    records[0].other = command
    records[0].other += int(tail(records[0].offsets)[0])


def make_entry(dtype):
    add = make_add(2.0, half)

    @entry(dtype)
    def model_entry(command, records, work, time, step):
        tell(records, command)
        add(records[0], time)
        return 0
    return model_entry


compiled = []
compile = keeping.PartDispatcher.compile
def note(self, sig):
    compiled.append(self.py_func.__name__)
    return compile(self, sig)
keeping.PartDispatcher.compile = note
keeping.keep_in(Path(sys.argv[2]))
name, text = make_entry(np.dtype([tuple(field) for field in json.loads(sys.argv[1])], align=True)).module_text()
Path(sys.argv[3]).write_text(text.replace(name, "dcone_entry"))
print(json.dumps(compiled))
"""
FIELDS: list[tuple[object, ...]] = [("sum", "f8"), ("offsets", "f8", [2]), ("other", "i8")]
OTHER_ORDER = [("other", "i8"), ("more", "f8", [3]), ("offsets", "f8", [2]), ("sum", "f8")]


class Compiler:
    """Compiles the entry in a process that has compiled nothing before, and knows which kernels that took."""

    def __init__(self, folder: Path) -> None:
        self._folder, self.kept, self.text = folder, folder / "kept", MODULE

    def __call__(self, fields: list[tuple[object, ...]]) -> list[str]:
        """Names of the kernels that were compiled."""
        (self._folder / "module.py").write_text(self.text)
        arguments = [json.dumps(fields), str(self.kept), str(self._folder / "model.ll")]
        names: list[str] = json.loads(emitting.run(self._folder / "module.py", arguments))
        return names

    @property
    def ir(self) -> str:
        """The text without what a build strikes out."""
        lines = (self._folder / "model.ll").read_text().splitlines()
        return "\n".join(line for line in lines if "NumbaEnv" not in line)

    def run(self, fields: list[tuple[object, ...]], time: float) -> float:
        """What the entry adds up to."""
        library = self._folder / f"{len(list(self._folder.iterdir()))}.so"
        kernels._library(self._folder / "model.ll", library)
        shape = [(name, kind, tuple(*extents)) for name, kind, *extents in fields]
        records = np.zeros(1, np.dtype(shape, align=True))
        records["offsets"] = 0.0, 0.25
        assert kernels.Entry(library)(7, records, np.zeros(1), time, 0.0) == 0
        assert records["other"] == 7
        return float(records["sum"][0])


@pytest.fixture(scope="module")
def warm(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the entry was compiled."""
    folder = tmp_path_factory.mktemp("warm")
    assert set(Compiler(folder)(FIELDS)) == {"add", "half", "tell"}
    return folder


@pytest.fixture
def compiler(tmp_path: Path, warm: Path) -> Compiler:
    """One that finds all kernels kept."""
    shutil.copytree(warm, tmp_path / "own")
    return Compiler(tmp_path / "own")


def test_a_second_build_compiles_nothing_but_the_entry_and_gives_the_same_text(compiler: Compiler) -> None:
    first = compiler.ir
    assert compiler(FIELDS) == []
    assert compiler.ir == first
    assert "place." not in first, "places are numbers by now"
    assert compiler.run(FIELDS, 1.5) == 1.5 + 0.25


def test_fields_may_lie_elsewhere(compiler: Compiler) -> None:
    assert compiler(OTHER_ORDER) == []
    assert compiler.run(OTHER_ORDER, 8.0) == 3.0 + 0.25


@pytest.mark.parametrize(("kind", "sum_"), [("f4", 3.25), ("i8", 3.0)])
def test_a_field_of_another_type_is_another_kernels(compiler: Compiler, kind: str, sum_: float) -> None:
    fields = [("sum", kind), *FIELDS[1:]]
    assert compiler(fields) == ["add"]
    assert compiler.run(fields, 4.5) == sum_


def test_an_array_of_another_length_is_another_kernels(compiler: Compiler) -> None:
    assert set(compiler([FIELDS[0], ("offsets", "f8", [3]), FIELDS[2]])) == {"add", "tell"}


def test_what_is_new_is_compiled_and_no_more(compiler: Compiler) -> None:
    compiler.text = compiler.text.replace("make_add(2.0", "make_add(4.0")
    assert compiler(FIELDS) == ["add"]
    assert compiler.run(FIELDS, 8.0) == 6.25
    text = compiler.ir
    shutil.rmtree(compiler.kept)
    assert set(compiler(FIELDS)) == {"add", "half", "tell"}
    assert compiler.ir == text, "it does not show what was compiled before"


def test_another_kernel_that_is_called_alike_leaves_its_caller_as_it_is(compiler: Compiler) -> None:
    compiler.text = compiler.text.replace("0.5 * min(x, LIMIT)", "x - LIMIT")
    assert compiler(FIELDS) == ["half"]
    assert compiler.run(FIELDS, 8.0) == 10.25
    text = compiler.ir
    shutil.rmtree(compiler.kept)
    assert set(compiler(FIELDS)) == {"add", "half", "tell"}
    assert compiler.ir == text, "it does not show what came from where"


@pytest.mark.parametrize(
    ("was", "becomes", "sum_"),
    [
        ("return 0.5 * min(x, LIMIT)", "return int(x)", 16.25),
        ("def half(x):", "def half(x, y=0.5):", 3.25),
        ("factor * half(x)", "factor * half(x) + half(x)", 4.75),
    ],
    ids=["gives another type", "is called with more", "is called twice"],
)
def test_a_kernel_that_is_called_otherwise_is_another_for_its_caller(
    compiler: Compiler, was: str, becomes: str, sum_: float
) -> None:
    compiler.text = compiler.text.replace(was, becomes)
    assert "add" in compiler(FIELDS)
    assert compiler.run(FIELDS, 8.0) == sum_


def test_which_of_two_kernels_is_called_is_in_the_callers_key(compiler: Compiler) -> None:
    """Of (a, b), (b, a) and (a, a) the last is another: there one kernel is called twice."""
    compiler.text = compiler.text.replace(
        "half(x) + tail", "(half(x) - third(x)) + tail").replace("(factor, half)", "(factor, half, third)").replace(
        "make_add(2.0, half)", "make_add(2.0, half, third)").replace(
        "@kernel\ndef half", "@kernel\ndef third(x):\n    return x / 4.0\n\n\n@kernel\ndef half")  # fmt: skip
    assert set(compiler(FIELDS)) == {"add", "third"}
    assert compiler.run(FIELDS, 8.0) == -1.0 + 0.25
    compiler.text = compiler.text.replace("make_add(2.0, half, third)", "make_add(2.0, third, half)")
    assert compiler(FIELDS) == []
    assert compiler.run(FIELDS, 8.0) == 1.0 + 0.25
    compiler.text = compiler.text.replace("make_add(2.0, third, half)", "make_add(2.0, half, half)")
    assert compiler(FIELDS) == ["add"]
    assert compiler.run(FIELDS, 8.0) == 0.25


def test_a_kernel_that_is_an_argument_is_not_kept_and_nor_is_who_calls_it(compiler: Compiler) -> None:
    """What the one that is given it calls is known to neither."""
    compiler.text = compiler.text.replace(
        "def tell(records, command):\n    records[0].other = command",
        "def fill(records, value, rule):\n    records[0].other = int(2.0 * rule(value))\n\n\n"
        "@kernel\ndef tell(records, command):\n    fill(records, command, half)",
    )
    assert {"tell", "fill"} <= set(compiler(FIELDS))
    compiler.text = compiler.text.replace("0.5 * min(x, LIMIT)", "0.5 * x")
    assert set(compiler(FIELDS)) == {"tell", "fill", "half"}
    assert compiler.run(FIELDS, 8.0) == 8.25


@kernel
def callee(x):
    return x


def make(factor, called, text="x"):
    """Key of a kernel, and of whatever it is made from."""
    scope = {"__name__": __name__, "kernel": kernel, "factor": factor, "called": called, "LIMIT": 3.0, "np": np}
    exec(f"@kernel\ndef made(x, y=1.0):\n    return factor * called({text})", scope)
    return Keys().of(scope["made"])


@kernel
def another(x):
    return x + 1.0


def test_what_a_kernel_is_made_from_is_in_its_key():
    first = make(2.0, callee)
    assert make(2.0, callee) == first
    different = [
        make(2, callee),
        make(3.0, callee),
        make(2.0, another),
        make(2.0, callee, "y"),
        make(2.0, callee, "-x"),
    ]
    assert len({first, *different}) == 6


def test_what_is_closed_over_is_in_its_key():
    def close_over(value):
        @kernel
        def made(x):
            return x * value

        return Keys().of(made)

    values = (1.0, 1, True, "1", None, (1.0,), (1.0, 1.0), callee, another, np.float32(1.0), np.ones(2), np.ones(3))
    assert len({close_over(value) for value in values}) == len(values)
    assert close_over((callee, 2.0)) == close_over((callee, 2.0))


class Two(NamedTuple):
    one: Any
    other: Any


def test_of_things_with_names_those_that_are_named_are_in_the_key():
    """And all of them where it is not told which."""

    def named(two):
        @kernel
        def made(x):
            return x * two.one

        return Keys().of(made)

    def counted(two):
        @kernel
        def made(x):
            return x * two[0]

        return Keys().of(made)

    assert named(Two(2.0, 3.0)) == named(Two(2.0, another)) != named(Two(1.0, 3.0))
    assert counted(Two(2.0, 3.0)) != counted(Two(2.0, 4.0))


@kernel
def through_a_module(x):
    return x * vectors.OF_A_TEST


def test_what_a_module_holds_is_in_the_key(monkeypatch):
    """Of its attributes those alone that the kernel names."""
    monkeypatch.setattr(vectors, "OF_A_TEST", 2.0, raising=False)
    first = Keys().of(through_a_module)
    monkeypatch.setattr(vectors, "OF_NOBODY", object(), raising=False)
    assert Keys().of(through_a_module) == first
    monkeypatch.setattr(vectors, "OF_A_TEST", 3.0)
    assert Keys().of(through_a_module) != first


def test_what_has_no_hash_has_no_key():
    with pytest.raises(NoKeyError, match="no hash of <object"):
        Keys().of((1.0, object()))


def test_machine_code_for_one_record_is_never_taken_for_that_of_another(monkeypatch, tmp_path):
    """What is linked of a kernel has one name for both, and the engine, were it to see that, one function."""
    monkeypatch.setattr(linking, "parts", linking.parts)
    monkeypatch.setattr(keeping.KeptDispatcher, "store", None, raising=False)
    keeping.keep_in(tmp_path)
    scope = {"kernel": kernel, "math": math, "__name__": __name__}
    lines = "\n    ".join(f"p.sum += math.sin(p.sum + {k}.0)" for k in range(40))
    exec(f"@kernel\ndef long(p, x):\n    p.sum = x\n    {lines}\n    p.other = 5", scope)
    exec("@kernel\ndef both(records, x):\n    long(records[0], x)\n    long(records[0], records[0].sum)", scope)
    found = []
    for fields in (FIELDS, OTHER_ORDER):
        records = np.zeros(1, np.dtype([tuple(field) for field in fields], align=True))
        scope["both"](records, 0.5)
        found.append((records["sum"][0], records["other"][0], records["offsets"].any()))
    expected = 0.5
    for k in (*range(40), *range(40)):
        expected += math.sin(expected + k)
    assert found == [(pytest.approx(expected, rel=1e-12), 5, False)] * 2


def test_a_damaged_file_is_compiled_again(compiler: Compiler) -> None:
    first = compiler.ir
    for path in compiler.kept.rglob("*"):
        if path.is_file():
            data = bytearray(path.read_bytes())
            data[-20] ^= 0xFF
            path.write_bytes(data)
    assert set(compiler(FIELDS)) == {"add", "half", "tell"}
    assert compiler.ir == first


def test_a_store_that_can_not_be_written_keeps_nothing(compiler: Compiler) -> None:
    shutil.rmtree(compiler.kept)
    compiler.kept.touch()
    assert set(compiler(FIELDS)) == {"add", "half", "tell"}
    assert compiler.run(FIELDS, 1.5) == 1.75


def test_every_kernel_of_the_shipped_scenes_has_a_key() -> None:
    """Else it would be compiled again for each choice of terms, and nobody would notice but by the clock."""
    keys = Keys()
    chosen = {
        (component.model, tuple(component.terms.items()))
        for name in shipped()
        for phase in load_scene(name).checked.phases
        for component in phase.components
        if component.fmu is None
    }
    assert len(chosen) > 20
    for model, terms in chosen:
        keys.of(importlib.import_module(MODELS[model].module).make_entry(dict(terms)))
