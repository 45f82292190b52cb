"""Between which nodes the largest tension is: against springs between the nodes as they are shown."""

import numpy as np
import pytest

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from tests.conftest import FREE
from tests.net_capture.memory import graph

CONE = {"net.radius": 4.0, "net.depth": 3.0, "net.top_radius": 1.0, "net.mesh": 0.7, "net.segments": 2}
TERMS = FREE | {"net": "cone", "nodes": "500", "threads": "900", "tensions": "plain"}


def test_tensions_and_their_place():
    """Undamped: T = k (r - L) of every thread by the nodes at its ends, and their energies add up; the peak's nodes are
    those of the thread that bears most, in steps as short as the substep."""
    values = {**CONE, "net.damping_ratio": 0.0, "net.fold_side": 7.99, "bullets.angle": 1.4}
    net = Instance(MODEL, TERMS, values).initialise()
    assert net["thread.tension_peak_index"] == 0
    assert net["thread.tension_max_time"] == -1.0
    count = int(net["net.threads"])
    held = graph(net)
    slots = np.flatnonzero(np.isin(np.arange(held.ends.max() + 1), held.ends))
    number = np.searchsorted(slots, held.ends) + 1
    seen, before = set(), np.zeros(count)
    for step in range(150):
        net.step(net["solver.substep"] if step else 0.15)
        ends = net.array("thread_node")[:count].astype(int)
        np.testing.assert_array_equal(ends, number)
        node = net.array("node_position")
        r = np.linalg.norm(node[ends[:, 1] - 1] - node[ends[:, 0] - 1], axis=1)
        tension = held.stiffness * np.maximum(r - held.length, 0.0)
        np.testing.assert_allclose(net.array("thread_tension")[:count], tension, rtol=1e-9, atol=1e-9)
        energy = 0.5 * np.sum(tension**2 / held.stiffness)
        assert net["energy.elastic"] == pytest.approx(energy, rel=1e-9, abs=1e-12)
        place = net.array("thread_tension_peak_node").astype(int).tolist()
        if step:
            # of both ends of the substep
            most = max(before, tension, key=np.max)
            assert net["thread.tension_peak"] == pytest.approx(most.max(), rel=1e-9)
            assert place == ends[np.argmax(most)].tolist()
            seen.add(tuple(place))
        before = tension
    assert net["thread.tension_max"] > 1.0
    assert len(seen) > 3
    assert 0.0 < net["thread.tension_max_time"] <= net.time
    assert (net.array("thread_tension_max_node") > 0).all()
