"""Nets that bullets leave one by one, or that their canister holds on to: what a free net keeps they need not, and what
is asked of them they meet."""

import numpy as np
import pytest

from dcone_cosim.criteria import Evidence
from dcone_cosim.phases.capture_criteria import criteria
from tests.net_capture.released import COARSE, EACH, RELEASED
from tests.net_capture.test_wall import PACKED, SHOT

ALIKE = COARSE | {"net.damping_ratio": 0.3}
CASES = {
    "all alike": (RELEASED, ALIKE, ("tether", "spin", "ejection")),
    "each in its own way": (RELEASED, ALIKE | EACH, ("tether", "spin")),
    "held by the canister": (PACKED, SHOT, ()),
}


@pytest.mark.parametrize("case", CASES)
def test_what_is_asked_of_it_it_meets(shoot, case):
    terms, values, idle = CASES[case]
    net = shoot(values, terms)
    scalars = list(net.interface.scalars())
    outputs = [n for n, _, v, _ in scalars if v.causality == "output"]
    given = {n: float(net[n]) for n, _, v, _ in scalars if v.causality in ("parameter", "input")}
    rows = []
    for _ in range(41):
        rows.append([net.time, *(net[name] for name in outputs)])
        net.step(0.03)
    columns = dict(zip(["time", *outputs], np.array(rows, dtype=float).T, strict=True))
    named = {group: term for group, term in terms.items() if group not in idle}
    found = {c.key: c for c in criteria(Evidence(columns, given, {**named, "precision": "double"}, 1.2))}
    assert [key for key, c in found.items() if not c.value <= c.stable] == []
    assert ("flight" in found) == (case == "all alike")
    assert {"momentum", "energy_rises", "energy_gained"} <= set(found)
