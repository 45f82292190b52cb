"""What a scene is told of threads of several kinds."""

import numpy as np
import pytest

from fmu_src.net_capture.implied import rows
from fmu_src.net_capture.nets.own_graph import NODES, THREADS
from tests.conftest import FREE
from tests.net_capture import own_files
from tests.net_capture.told import every


def test_threads_of_several_kinds_are_told_from_least_to_most():
    nodes, threads, _ = own_files.unlike()
    terms = FREE | {"net": "table"}
    values = {**every(terms, {}), NODES: nodes, THREADS: threads}
    found = {row.key: row for row in rows(values, terms)}
    stiffness, length = threads[:, 5], threads[:, 3]
    assert found["thread.stiffness"].value == pytest.approx(stiffness.max())
    assert found["thread.stiffness_least"].value == pytest.approx(stiffness.min())
    assert found["thread.axial_stiffness"].value == pytest.approx((stiffness * length).min())
    assert found["thread.axial_stiffness_most"].value == pytest.approx((stiffness * length).max())
    for key, word in (
        *(("thread.stiffness", "stiffest"), ("thread.stiffness_least", "least stiff")),
        *(("thread.axial_stiffness", "softest"), ("thread.axial_stiffness_most", "hardest")),
        *(("thread.dashpot", "stiffest"), ("knot.mass", "heaviest")),
    ):
        assert word in found[key].label
    assert found["thread.dashpot"].value == pytest.approx(threads[np.argmax(stiffness), 7])
