"""The validation page is that of its stored rows, these are the tests', and no comparison passes for nothing."""

import ast
import json
import math
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests import validation, validation_page
from tests.validation import ROOT, Validated, closed_form, experiment, other_code

TEST = "tests/some/test_file.py::test_some"
HALF = closed_form("one half")


def stored() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(validation.RESULT.read_text(encoding="utf-8"))
    return found


def comparing() -> Iterator[str]:
    """Every test in the sources that uses the fixture, as the page names it."""
    for path in sorted((ROOT / "tests").rglob("test_*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for function in (node for node in tree.body if isinstance(node, ast.FunctionDef)):
            if function.name.startswith("test_") and "validated" in [each.arg for each in function.args.args]:
                yield f"{path.relative_to(ROOT).as_posix()}::{function.name}"


def test_page_is_that_of_the_stored_rows() -> None:
    result = stored()
    assert validation.PAGE.read_text(encoding="utf-8") == validation_page.render(result)
    assert result["command"] == validation.COMMAND
    assert {"dcone-cosim", "numba", "numpy"} == set(result["version"])
    for row in result["rows"]:
        row["found"] += 0.1 * abs(row["found"]) + 1.0
    assert validation.PAGE.read_text(encoding="utf-8") != validation_page.render(result)


def test_rows_are_of_tests_that_are_there_and_of_all_of_them() -> None:
    """Their numbers are compared with the stored ones wherever the tests run: see `Validated`."""
    named = {validation_page.function(row["test"]) for row in stored()["rows"]}
    assert named == set(comparing())
    assert len(named) > 50


def test_stored_rows_hold() -> None:
    for row in stored()["rows"]:
        assert row["level"] in validation.LEVELS
        assert row["share"] <= 1.0
        if row["expected"] is not None:
            difference = abs(row["found"] - row["expected"])
            assert difference == pytest.approx(row["share"] * validation.allowed(row), rel=1e-6, abs=1e-300)
        else:
            low, high = row["tolerance"]["within"]
            assert (-math.inf if low is None else low) <= row["found"] <= (math.inf if high is None else high)


def recording(folder: Path, test: str = TEST) -> Validated:
    return Validated(test, {}, folder)


@pytest.mark.parametrize(
    ("found", "expected", "tolerance", "holds"),
    [
        (0.5005, 0.5, {"rel": 1e-3}, True),
        (0.5006, 0.5, {"rel": 1e-3}, False),
        (-0.5, 0.5, {"rel": 1e-3}, False),
        (1e-13, 0.0, {"rel": 1e-3}, False),
        (0.0, 0.0, {"rel": 1e-3}, True),
        (0.5009, 0.5, {"abs": 1e-3}, True),
        (0.5011, 0.5, {"abs": 1e-3}, False),
        (math.nan, 0.5, {"abs": 1e3}, False),
        (math.inf, 0.5, {"abs": 1e3}, False),
        (0.5, math.nan, {"rel": 1e3}, False),
        ([0.5, 0.5005], 0.5, {"rel": 1e-3}, True),
        ([0.5, 0.5011, 0.5], 0.5, {"rel": 1e-3}, False),
        ([0.5, 3.0], [0.5, 2.0], {"abs": [1e-3, 1.5]}, True),
        ([0.5, 3.0], [0.5, 2.0], {"abs": [1e-3, 0.5]}, False),
        (0.5, None, {"within": (0.4, 0.6)}, True),
        (0.61, None, {"within": (0.4, 0.6)}, False),
        (math.nan, None, {"within": (0.4, 0.6)}, False),
        (0.5, None, {"within": (0.4, None)}, True),
        (0.3, None, {"within": (0.4, None)}, False),
        (-0.3, None, {"within": (0.0, None)}, False),
        (0.5, None, {"within": (None, 0.6)}, True),
        (0.7, None, {"within": (None, 0.6)}, False),
    ],
)
def test_a_comparison_holds_or_fails(
    tmp_path: Path, found: Any, expected: Any, tolerance: dict[str, Any], holds: bool
) -> None:
    if holds:
        recording(tmp_path)(HALF, "half", found, expected, **tolerance)
        (row,) = validation.gathered(tmp_path)
        assert row["of"] == np.size(found)
    else:
        with pytest.raises(AssertionError, match="half"):
            recording(tmp_path)(HALF, "half", found, expected, **tolerance)
        assert validation.gathered(tmp_path) == []


@pytest.mark.parametrize(
    ("source", "expected", "tolerance"),
    [
        (HALF, 0.5, {}),
        (HALF, 0.5, {"rel": 1.0, "abs": 1.0}),
        (HALF, 0.5, {"within": (0.0, 1.0)}),
        (HALF, None, {"rel": 1.0}),
        (validation.Source("guess", "one half"), 0.5, {"rel": 1.0}),
    ],
)
def test_a_comparison_says_what_it_is(tmp_path: Path, source: Any, expected: Any, tolerance: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"a comparison has|a level is"):
        recording(tmp_path)(source, "half", 0.5, expected, **tolerance)


def test_the_page_must_tell_of_it_as_it_is(tmp_path: Path) -> None:
    recording(tmp_path)(HALF, "half", 0.5, 0.5, "m", rel=1e-3)
    kept = {(TEST, "half"): validation.gathered(tmp_path)}
    Validated(TEST, kept)(HALF, "half", 0.5004, 0.5, "m", rel=1e-3)
    for source, what, expected, unit, tolerance in (
        (HALF, "half", 0.5002, "m", {"rel": 1e-4}),
        (HALF, "half", 0.5, "m", {"abs": 5e-4}),
        (HALF, "half", 0.5011, "m", {"rel": 1e-3}),
        (HALF, "half", 0.5, "s", {"rel": 1e-3}),
        (HALF, "a half", 0.5, "m", {"rel": 1e-3}),
        (other_code("one half"), "half", 0.5, "m", {"rel": 1e-3}),
        (closed_form("1/2"), "half", 0.5, "m", {"rel": 1e-3}),
    ):
        with pytest.raises(AssertionError, match=r"does not tell .* `python -m tests.validation`"):
            Validated(TEST, kept)(source, what, expected, expected, unit, **tolerance)
    with pytest.raises(AssertionError, match="does not tell"):
        Validated(TEST + "_other", kept)(HALF, "half", 0.5, 0.5, "m", rel=1e-3)


@pytest.mark.parametrize(
    ("expected", "tolerance", "changed", "told"),
    [
        (0.5, {"abs": 1e-3}, (0.5, {"abs": 1.0005e-3}), True),  # computed, elsewhere
        (0.5, {"abs": 1e-3}, (0.5, {"abs": 2e-3}), False),
        (0.5, {"abs": 1e-3}, (0.5015, {"abs": 1e-3}), False),
        (None, {"within": (0.4, 0.6)}, (None, {"within": (0.4, 0.7)}), False),
        (None, {"within": (0.4, None)}, (None, {"within": (0.4, None)}), True),
        (None, {"within": (0.4, None)}, (None, {"within": (0.3999, None)}), False),
        (None, {"within": (0.4, None)}, (None, {"within": (0.4, 0.6)}), False),
        ([0.5, 0.5], {"rel": 1e-3}, ([0.5, 0.5, 0.5], {"rel": 1e-3}), False),
        ([0.5, 0.7], {"rel": 1e-3}, ([0.5, 0.8], {"rel": 1e-3}), True),  # a course may end elsewhere
        ([0.5, 0.7], {"rel": 1e-3}, ([0.5, 0.7], {"rel": 1e-2}), False),
        ([0.5, 0.7], {"abs": 1e-3}, ([0.5, 0.7], {"abs": 1e-2}), False),
        ([0.5, 0.7], {"abs": [1e-3, 1e-3]}, ([0.5, 0.7], {"abs": [1e-3, 1e-2]}), True),
    ],
)
def test_what_of_a_comparison_is_told(
    tmp_path: Path, expected: Any, tolerance: dict[str, Any], changed: tuple[Any, dict[str, Any]], told: bool
) -> None:
    recording(tmp_path)(HALF, "half", 0.5 if expected is None else expected, expected, **tolerance)
    kept = {(TEST, "half"): validation.gathered(tmp_path)}
    other, its = changed
    if told:
        Validated(TEST, kept)(HALF, "half", 0.5 if other is None else other, other, **its)
    else:
        with pytest.raises(AssertionError, match="does not tell"):
            Validated(TEST, kept)(HALF, "half", 0.5 if other is None else other, other, **its)


def test_with_the_option_only_comparing_tests_are_run() -> None:
    items: list[Any] = [SimpleNamespace(fixturenames=names) for names in (["validated"], ["shoot"], [])]
    items.append(SimpleNamespace())  # not every item is a function
    dropped: list[Any] = []
    hook = SimpleNamespace(pytest_deselected=lambda items: dropped.extend(items))
    for folder, kept in ((None, 4), (Path("x"), 1)):
        config: Any = SimpleNamespace(getoption={validation.OPTION: folder}.__getitem__, hook=hook)
        validation.keep_validating(config, items)
        assert (len(items), len(dropped)) == (kept, 4 - kept)
    assert items[0].fixturenames == ["validated"]


@pytest.mark.parametrize("outcome", [0, 1])
def test_the_page_is_written_after_a_run_that_holds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], outcome: int
) -> None:
    def run(command: list[str], **_: Any) -> Any:
        (folder,) = (each.partition("=")[2] for each in command if each.startswith(validation.OPTION))
        recording(Path(folder), "tests/orbital/test_half.py::test_half")(HALF, "half", 0.5, 0.5, rel=1e-3)
        return SimpleNamespace(returncode=outcome)

    monkeypatch.setattr("tests.validation.subprocess.run", run)
    monkeypatch.setattr(validation, "find_spec", lambda name: object())
    monkeypatch.setattr(validation, "RESULT", tmp_path / "validation.json")
    monkeypatch.setattr(validation, "PAGE", tmp_path / "validation.md")
    assert validation.main([]) == outcome
    assert {path.name for path in tmp_path.iterdir()} == (set() if outcome else {"validation.json", "validation.md"})
    assert ("stays as it was" in capsys.readouterr().err) == bool(outcome)
    if outcome == 0:
        assert validation.PAGE.read_text(encoding="utf-8") == validation_page.render(stored())
        assert [row["what"] for row in stored()["rows"]] == ["half"]
    monkeypatch.setattr(validation, "find_spec", lambda name: None)
    with pytest.raises(SystemExit):
        validation.main([])
    assert "pip install -e '.[test,peers]'" in capsys.readouterr().err


def test_rows_of_some_files_are_made_anew_and_the_others_stay() -> None:
    """And the page says of how many, when, and by which version."""
    rows = [{"test": f"tests/orbital/test_{name}.py::test_it", "found": 0.0} for name in ("a", "b", "c")]
    whole = validation.result(rows)
    files = ["tests/orbital/test_b.py", "tests/orbital/test_d.py"]
    made = [{"test": f"{file}::test_it", "found": 1.0} for file in files]
    found = validation.renewed(whole, made, files)
    assert [(row["test"][19], row["found"]) for row in found["rows"]] == [
        ("a", 0.0),
        ("b", 1.0),
        ("c", 0.0),
        ("d", 1.0),
    ]
    assert found["date"] == whole["date"]
    assert list(found["again"]) == files
    twice = validation.renewed(found, [], ["tests/orbital/test_a.py"])
    assert len(twice["again"]) == 3
    assert "Those of 2 test files were made again on" in validation_page._again(found)
    assert validation_page._again(whole) == ""


def test_rows_of_several_processes_and_cases_become_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each process writes a file of its own; of a test's cases the one nearest to its tolerance is shown."""
    for worker, case, found in (("gw1", "a", [0.5001, 0.5]), ("gw0", "b", [0.5004, 0.5, 0.5]), ("gw1", "c", [0.5002])):
        monkeypatch.setenv("PYTEST_XDIST_WORKER", worker)
        recording(tmp_path, f"tests/orbital/test_half.py::test_half[{case}]")(HALF, "half", found, 0.5, "m", rel=1e-3)
    assert {path.name for path in tmp_path.iterdir()} == {"gw0.jsonl", "gw1.jsonl"}
    rows = validation.gathered(tmp_path)
    assert sorted(row["test"][-2] for row in rows) == ["a", "b", "c"]
    (row,) = validation_page.merged(rows)
    assert (row["found"], row["of"]) == (0.5004, 6)
    link = "[half](../tests/orbital/test_half.py)"
    expected = f"| half (worst of 6) | one half | 0.5 | 0.5004 | 0.08 % | 0.1 % | m | {link} |"
    assert validation_page.line(row) == expected
    page = validation_page.render(validation.result(rows))
    assert expected in page.splitlines()
    assert validation_page.NO_EXPERIMENT in page
    recording(tmp_path, "tests/cosim/test_half.py::test_half")(experiment("a ruler"), "half", 0.5, within=(0.4, 0.6))
    page = validation_page.render(validation.result(validation.gathered(tmp_path)))
    assert "### Experiment: hand-over and coupling" in page
    assert validation_page.NO_EXPERIMENT not in page
    with pytest.raises(ValueError, match="no subject"):
        validation_page.subject("tests/elsewhere/test_half.py::test_half")


@pytest.mark.parametrize(
    ("value", "step", "told"),
    [
        (3523.7471549, 35.0, "3523.75"),
        (1119.008376273, 1e-4, "1119.00838"),
        (0.025865077, 2.6e-6, "0.0258651"),
        (-5.0e-9, 1e-9, "-5e-09"),
        (0.0, 1e-9, "0"),
        (math.pi, 0.0, "3.14159265359"),
    ],
)
def test_numbers_have_the_digits_that_the_tolerance_asks_for(value: float, step: float, told: str) -> None:
    assert validation_page.number(value, step) == told


def test_the_interval_of_the_net_gun() -> None:
    """Wilson: p is an end where (x/n - p)^2 = z^2 p (1 - p)/n, z = 1.959964. Clopper and Pearson's begins at 0.762."""
    low, high = validation_page.interval(20, 21)
    assert (round(low, 3), round(high, 3)) == (0.773, 0.992)
    for end in (low, high):
        assert (20 / 21 - end) ** 2 == pytest.approx(1.959964**2 * end * (1.0 - end) / 21, rel=1e-6)
    assert "0.773 and 0.992" in validation_page.open_experiments()[0].known


def test_open_comparisons_say_what_is_missing() -> None:
    page = validation.PAGE.read_text(encoding="utf-8")
    for entry in validation_page.open_experiments():
        assert entry.missing in page
    for name in ("ESA's net gun", "RemoveDEBRIS", "PATENDER", "ADRiNET", "Si et al. (2021)", "MoorDyn"):
        assert name in page
