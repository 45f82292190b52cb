"""Figures of a campaign's file: names and units held against what a scene can tell."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import dcone_cosim
from dcone_cosim.campaign.figures import BY_PHASE, TEXT, check_figures, check_names, unit_of
from dcone_cosim.campaign.shipped import shipped
from dcone_cosim.cases.rows import Row
from dcone_cosim.loading import load
from dcone_cosim.phases import capture_report, closed_report, removal_report
from dcone_cosim.scene.mistakes import SceneError
from dcone_cosim.transaction import HAND_OFF
from tests.campaign.conftest import spec_of

SOURCES = Path(dcone_cosim.__file__).parent
OF_ALL = ("capture", "removal", "second_tow")
TOLD_IN = {
    "loads.py": OF_ALL,
    "reports/summary.py": OF_ALL,
    "phases/end.py": OF_ALL,
    "phases/capture_report.py": ("capture",),
    "phases/closed_report.py": ("capture",),
    "phases/removal_report.py": ("removal", "second_tow"),
    "phases/released.py": ("removal", "second_tow"),
    "phases/second_tow.py": (HAND_OFF,),
    "phases/second_shot.py": (HAND_OFF,),
    "phases/next_capture.py": (HAND_OFF,),
    "phases/expended.py": (HAND_OFF,),
    "transaction.py": (HAND_OFF,),
}
JUST = '[[dispersion]]\nkey = "removal.thrust.level"\ndistribution = "normal"\ndeviation = "5 %"\n'
PEAK = 'success = {{ figure = "removal.largest_tug_peak", below = {} }}\n'


def told() -> Iterator[tuple[str, str, str | None]]:
    """Phase, key and unit of every figure that the reports name outright; a unit of None is not told there."""
    for file, phases in TOLD_IN.items():
        for call in ast.walk(ast.parse((SOURCES / file).read_text(encoding="utf-8"))):
            if not (isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "Finding"):
                continue
            key, value = call.args[1], call.args[3] if len(call.args) > 3 else None
            unit = call.args[4] if len(call.args) > 4 else None
            if not isinstance(key, ast.Constant) or key.value == "wall":
                continue
            given = unit.value or "1" if isinstance(unit, ast.Constant) else None
            assert value is not None or given is None
            for phase in phases:
                yield phase, key.value, given


def test_every_figure_of_the_reports_is_in_the_table() -> None:
    found = list(told())
    assert len(found) > 60
    for phase, key, unit in found:
        known = unit_of(f"{phase}.{key}", BY_PHASE)
        assert unit is None or known in (unit, None), (phase, key, unit)
    rows = [*capture_report._CAPTURE_ROWS, *capture_report._CATCH_ROWS]
    for key, _, unit in [*rows, *closed_report._QUALITY_ROWS, *closed_report._PULL_ROWS]:
        assert unit_of(f"capture.{key}", BY_PHASE) == (unit or "1"), key
    for mode in removal_report.MODES:
        assert unit_of(f"removal.level_{mode}", BY_PHASE) == "1"


@pytest.mark.parametrize(
    ("key", "unit"),
    [
        ("removal.if_thrust_at", "s"),
        ("removal.if_thrust_meets", TEXT),
        ("removal.if_thrust", "m"),
        ("removal.line.margin_of_safety", "1"),
        ("second_tow.line.stress", "Pa"),
        ("removal.mean.first_tug", None),
        ("hand-off.spin", "N m s"),
        ("hand-off.body_rate", "rad/s"),
    ],
)
def test_units(key: str, unit: str | None) -> None:
    assert unit_of(key, BY_PHASE) == unit


@pytest.mark.parametrize("name", sorted(shipped()))
def test_shipped_campaigns_name_figures_that_there_are(name: str) -> None:
    from dcone_cosim.campaign.reading import read

    spec = read(shipped()[name])
    check_names(spec, load(spec.scene))


@pytest.mark.parametrize(
    ("text", "line", "said"),
    [
        ('record = ["removal.frist_tug"]\n', 6, "did you mean 'removal.first_tug'?"),
        ('record = ["removal.frist_tug?"]\n', 6, "did you mean 'removal.first_tug'?"),
        ('record = ["capture.outcome"]\n', 6, "is no figure that table2-deorbit can tell"),
        ('record = ["hand-off.spin"]\n', 6, "is no figure that table2-deorbit can tell"),
        ('record = ["nothing"]\n', 6, "is no figure that table2-deorbit can tell"),
        ('indices = ["removal.taut_from_start"]\n', 6, "is a text; expected a figure that is a number"),
        ('record = ["removal.tugs"]\n' + PEAK.format('"10 N"'), 7, "add it to record"),
        (PEAK.format('"10 kg"'), 6, 'is in N, its bound is in kg; expected one with its unit such as "10 N"'),
        (PEAK.format('"50 m"'), 6, "is in N, its bound is in m"),
        (PEAK.format('"50 N m"'), 6, "is in N, its bound is in N m"),
        (PEAK.format("10"), 6, "is in N, its bound is a pure number"),
        (PEAK.format('"10 %"'), 6, "is in N, its bound is a pure number"),
        ('success = { figure = "removal.tugs", above = "3 m" }\n', 6, "is a pure number, its bound is in m"),
    ],
)
def test_what_is_told_before_anything_is_run(text: str, line: int, said: str) -> None:
    with pytest.raises(SceneError) as error:
        check_names(spec_of(text + JUST), load("table2-deorbit"))
    assert str(error.value).startswith("tow.toml: ")
    assert f"line {line}: " in str(error.value)
    assert said in str(error.value)


@pytest.mark.parametrize("bound", ['"10 N"', '"10 mN"', '"10 kg m/s2"'])
def test_bounds_that_fit(bound: str) -> None:
    check_names(spec_of(PEAK.format(bound) + JUST), load("table2-deorbit"))
    check_names(spec_of('success = { figure = "removal.settled_share", above = "90 %" }\n' + JUST), load("mission"))
    check_names(spec_of('success = { figure = "hand-off.body_rate", below = "5 deg/s" }\n' + JUST), load("mission"))


def test_the_scene_as_it_is_has_the_last_word() -> None:
    """A figure whose unit no table tells, of an FMU from elsewhere."""
    nominal = Row("k", "completed", 0, "", {"plant.level": 3.0}, {"plant.level": "K"})
    spec = spec_of('success = { figure = "plant.level", above = "3 m" }\n' + JUST)
    with pytest.raises(SceneError, match=r'line 6: success.above = "3 m": plant.level is in K, its bound is in m'):
        check_figures(spec, nominal)
    check_figures(spec_of('success = { figure = "plant.level", above = "3 K" }\n' + JUST), nominal)
    with pytest.raises(SceneError, match="is no figure of table2-deorbit as it is"):
        check_figures(spec_of('record = ["plant.levle"]\n' + JUST), nominal)
