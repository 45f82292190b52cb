"""What `dcone.size` hands on: ranges as the command line says them, whatever they were given as."""

from __future__ import annotations

from typing import Any

import pytest
from astropy import units

import dcone_cosim as dc
from dcone_cosim.sizing import commands


@pytest.mark.parametrize(("least", "most"), [("-20 mN", "-5 mN"), (-0.02 * units.N, -5.0 * units.mN)])
def test_ranges_are_read_as_those_of_the_command_line(least: Any, most: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    handed = []
    monkeypatch.setattr(commands, "of_scene", lambda name, options, *rest: handed.append(options))
    dc.size("table2-deorbit", ranges={"removal.thrust.level": (least, most)}, factor_of_safety=3.0)
    (options,) = handed
    assert options.factor_of_safety == 3.0
    ends = [units.Quantity(end).to_value(units.N) for end in options.ranges["removal.thrust.level"]]
    assert ends == pytest.approx([-0.02, -0.005], rel=1e-12)
