"""Nets laid out and folded by compiled kernels and by the functions that these were written as: the same bits."""

from __future__ import annotations

import numpy as np
import pytest

from tests.net_capture.laid import Layer
from tests.net_capture.test_folding import CASES, NETS, SET
from tests.net_capture.test_rigging import NETS as RIGGED
from tests.net_capture.test_rigging import RIGS, values_of

pytestmark = pytest.mark.evidence


def both(shape: str, **rigged: str) -> tuple[Layer, Layer]:
    return Layer(shape, **rigged), Layer(shape, compiled=True, **rigged)


@pytest.mark.parametrize("shape", RIGGED)
def test_with_all_that_is_rigged(shape: str) -> None:
    values = values_of(shape, *RIGS)
    plain, compiled = (layer.lay(values) for layer in both(shape, **dict.fromkeys(RIGS, "plain")))
    assert plain.work.tobytes() == compiled.work.tobytes()
    assert plain.bound == compiled.bound
    assert plain.work.tobytes() != both(shape)[0].lay(RIGGED[shape]).work.tobytes()


@pytest.mark.parametrize(("shape", "pattern"), CASES)
def test_in_the_canister(shape: str, pattern: str) -> None:
    layers = both(shape, folding=pattern, **({"bullets": "6"} if shape == "hexagon" else {}))
    places = [layer.fold(layer.lay(NETS[shape] | SET[pattern])) for layer in layers]
    np.testing.assert_array_equal(places[0], places[1])
    assert np.ptp(places[0]) > 0.1
