"""What a tool sees of the shot beside its outputs: rates, inputs that no output follows at once, faults that name."""

import numpy as np
import pytest

from fmu_src.instance import Instance, ModelFault
from fmu_src.net_capture.interface import MODEL
from tests.conftest import CAPTURE, FREE
from tests.plain import PlainInstance, plain

__all__ = ["plain"]


def shot(**parameters: float) -> Instance:
    return Instance(MODEL, CAPTURE, {"net.mesh": 4.0} | {k.replace("__", "."): v for k, v in parameters.items()})


def test_rates_are_the_velocities() -> None:
    """Differences of the positions over a short step in free flight; of the step after, they are not."""
    i = shot().initialise()
    i.step(1.0)
    names = [v.name for v in i.interface.variables if v.rate]
    assert len(names) == 5
    seen = []
    for _ in range(3):
        seen.append({n: i.record[n.replace("[#]", "").replace(".", "_")].copy() for n in names})
        if len(seen) == 2:
            i.differentiate()
            rate = i.rate("bullet[1].position[2]")
            velocities = {
                v.name: i.array(v.rate.replace("[#]", "").replace(".", "_")).copy()
                for v in i.interface.variables
                if v.rate
            }
        i.step(1e-3)
    assert rate == velocities["bullet[#].position[#]"][0, 1]
    for name in names:
        difference = (seen[2][name][0] - seen[0][name][0]) / 2e-3
        assert difference == pytest.approx(velocities[name], abs=1e-3), name
    assert np.abs(velocities["bullet[#].position[#]"]).max() > 1.0


def test_no_output_follows_an_input_at_once() -> None:
    i = shot().initialise()
    i.step(1.0003)
    before = i.record.copy(), i.work.copy()
    i["tether.vertex_tension"], i["close.command"] = 5.0, True
    i.refresh()
    i.differentiate()
    outputs = [v for v in i.interface.variables if v.causality == "output"]
    assert all(np.array_equal(i.record[v.field], before[0][v.field]) for v in outputs)
    assert not any(v.partials for v in outputs)
    i.step(0.1)
    assert not np.array_equal(i.record["vertex_velocity"], before[0]["vertex_velocity"])


@pytest.mark.parametrize(
    ("name", "value", "shown"),
    [
        ("net.side", 25.0, 6.25),
        ("net.fold_side", 30.0, 30.0),
        ("net.segments", 64, 384.0),
        ("target.start_attitude[1]", 0.5, 0.5),
        ("target.principal_inertia[1]", 7.0, 7.0),
        ("chaser.start_position[2]", -1.0, 0.0),
    ],
)
def test_faults_name_the_variable(name: str, value: float, shown: float) -> None:
    i = shot()
    i[name] = value
    if name == "net.segments":
        i["net.mesh"] = 1.0
        shown = 24.0 * 64.0
    with pytest.raises(ModelFault) as caught:
        i.initialise()
    first = name.replace("[2]", "[1]")
    assert f"({first}, value {shown:g}," in str(caught.value)
    assert shot().initialise().record["fault_index"][0] == 0


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize(("what", "count"), [("nodes", 9), ("threads", 12)])
def test_a_net_of_more_than_can_be_told_is_refused(what: str, count: int) -> None:
    """Two meshes a side have nine knots on twelve threads: there is room for these, or there is none for the last."""
    values = {"net.side": 4.0, "net.mesh": 2.0}
    made = PlainInstance(MODEL, FREE | {what: str(count)}, values)
    assert made[f"net.{what}"] == count
    with pytest.raises(ModelFault, match=rf"the net has more {what} than this FMU has outputs for.*, value {count:g},"):
        PlainInstance(MODEL, FREE | {what: str(count - 1)}, values)
