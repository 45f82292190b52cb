"""Which cases are worth looking at."""

from __future__ import annotations

from pathlib import Path

from dcone_cosim.campaign.engine import Made
from dcone_cosim.campaign.worst import worst
from dcone_cosim.cases.rows import Row
from tests.campaign.conftest import spec_of

JUST = '[[dispersion]]\nkey = "removal.thrust.level"\ndistribution = "normal"\ndeviation = "5 %"\n'


def test_failures_and_extremes() -> None:
    spec = spec_of('record = ["removal.peak"]\nsuccess = { figure = "removal.peak", below = "6 N" }\n' + JUST)
    peaks = [1.0, 7.0, 6.5, 3.0, 9.0, 8.0]
    made = [
        Made(number, (0.0,), Row(str(number), "completed", 0, "", {"removal.peak": peak}, {"removal.peak": "N"}))
        for number, peak in enumerate(peaks, 1)
    ]
    made.append(Made(7, (0.0,), Row("7", "FMU failed", 5, "its fault")))
    found = worst(spec, made, Path("my runs"))
    assert [one.number for one in found] == [2, 3, 5, 7]
    assert found[2].why == "nearest to, or farthest beyond, removal.peak below 6 N; largest removal.peak: 9 N"
    assert found[3].why == "FMU failed"
    assert (found[0].command, found[0].page) == ("dcone campaign rerun 'my runs' 2", "cases/2/report.html")
