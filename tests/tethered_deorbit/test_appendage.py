"""A hinged appendage that is held fast as the tow begins, judged by sums over mass points; no formula of it is used."""

from typing import Any

import numpy as np
import pytest

from fmu_src.extremes import Extreme
from fmu_src.instance import ModelFault
from fmu_src.tethered_deorbit import stress
from fmu_src.tethered_deorbit.interface import EQUAL_VELOCITY, MODEL
from tests.cosim.raw_world import Points
from tests.plain import PlainInstance, plain
from tests.validation import Validated, other_code

__all__ = ["plain"]
FREE = {"reel": "locked", "environment": "none", "target": "rigid", "appendage": "frozen"}
AXIS, HINGE = np.array([0.3, -1.2, 0.8]), np.array([0.9, 0.2, -0.4])
Array = np.ndarray


def elements(matrix: Array) -> tuple[float, ...]:
    return tuple(float(matrix[place]) for place in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))


class Hinged:
    """Two rigid clouds of points joined by a hinge, body axes of the one along inertial axes, before it is held."""

    def __init__(self, seed: int, rate: float) -> None:
        rng = np.random.default_rng(seed)
        places = [rng.normal(size=(12, 3)), np.array([2.5, 0.4, -0.6]) + 0.5 * rng.normal(size=(9, 3))]
        masses = [rng.uniform(20.0, 60.0, 12), rng.uniform(3.0, 9.0, 9)]
        everything = Points(np.concatenate(masses), np.concatenate(places), np.zeros((21, 3)))
        center = everything.center()[0]
        self.turning = 0.05 * rng.normal(size=3)
        places = [place - center for place in places]
        self.hinge = HINGE - center
        about_hinge = rate * AXIS / np.linalg.norm(AXIS)
        moving = [np.cross(self.turning, place) for place in places]
        moving[1] = moving[1] + np.cross(about_hinge, places[1] - self.hinge)
        self.panel = Points(masses[1], places[1], moving[1])
        self.all = Points(masses[0], places[0], moving[0]) + self.panel
        self.rate = rate

    def parameters(self) -> dict[str, Any]:
        return {
            "start.condition": EQUAL_VELOCITY,
            "target.mass": float(self.all.mass.sum()),
            "target_inertia": elements(self.all.inertia()),
            "target_start_rate": tuple(self.turning),
            "appendage.mass": float(self.panel.mass.sum()),
            "appendage_inertia": elements(self.panel.inertia()),
            "appendage_center": tuple(self.panel.center()[0]),
            "appendage_hinge": tuple(self.hinge),
            "appendage_axis": tuple(AXIS),
            "appendage.rate": self.rate,
        }

    def own_energy(self) -> float:
        """Kinetic, about the centre of mass of all."""
        drift = self.all.center()[1]
        return self.all.energy() - 0.5 * float(self.all.mass.sum()) * float(drift @ drift)


@pytest.mark.parametrize("seed", range(4))
def test_momentum_stays_and_what_is_lost_is_told(plain: None, validated: Validated, seed: int) -> None:
    points = Hinged(seed, 0.4)
    i = PlainInstance(MODEL, FREE, points.parameters())
    size = float(np.linalg.norm(points.all.spin()))
    still = Hinged(seed, 0.0)
    source = other_code("sums over mass points in inertial axes")
    what = "appendage that is held fast: "
    validated(source, what + "spin of the whole", i.array("target_spin"), points.all.spin(), "N m s", abs=1e-12 * size)
    np.testing.assert_allclose(
        i.array("appendage_momentum"), points.all.spin() - still.all.spin(), rtol=0.0, atol=1e-12 * size
    )
    kept = points.all.energy_if_rigid()
    assert i["target.spin_energy"] == pytest.approx(kept, rel=1e-12)
    lost = points.own_energy() - kept
    validated(source, what + "energy that its hinge takes", i["appendage.energy"], lost, "J", rel=1e-10)
    assert i["appendage.energy"] > 0.01 * points.own_energy()


def test_one_that_stands_still_changes_nothing(plain: None) -> None:
    given = Hinged(0, 0.0).parameters()
    i = PlainInstance(MODEL, FREE, given)
    own = {name: value for name, value in given.items() if not name.startswith("appendage")}
    bare = PlainInstance(MODEL, {k: v for k, v in FREE.items() if k != "appendage"}, own)
    assert i.array("target_spin").tolist() == bare.array("target_spin").tolist()
    assert i["appendage.energy"] == 0.0


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"appendage.mass": 1e5}, r"appendage\.mass"),
        ({"appendage_axis": (0.0, 0.0, 0.0)}, r"appendage\.axis"),
        ({"appendage_inertia": (1.0, 1.0, 3.0, 0.0, 0.0, 0.0)}, r"no body has that inertia.*appendage\.inertia"),
    ],
)
def test_what_is_no_appendage(plain: None, change: dict[str, Any], why: str) -> None:
    with pytest.raises(ModelFault, match=why):
        PlainInstance(MODEL, FREE, Hinged(0, 0.4).parameters() | change)


def test_a_point_has_none() -> None:
    from fmu_src.tethered_deorbit.model import make_entry

    with pytest.raises(ValueError, match="appendage needs a target that turns"):
        make_entry({"reel": "locked", "appendage": "frozen"})


@pytest.mark.parametrize("extreme", stress.APPENDAGE, ids=lambda extreme: extreme.name)
def test_at_its_extremes_the_motion_becomes_spin(plain: None, extreme: Extreme) -> None:
    """What a stability report tries of it: the spin of all is that of the appendage about the target's centre."""
    usual: dict[str, Any] = {"target.mass": 1000.0, "start.condition": EQUAL_VELOCITY}
    given = {
        name.replace(".", "_") if isinstance(value, tuple) else name: value
        for name, value in extreme.given(usual).items()
    }
    i = PlainInstance(MODEL, FREE, usual | {"target_start_rate": (0.0, 0.0, 0.0)} | given)
    inertia = i.array("appendage_inertia")
    center, hinge = i.array("appendage_center"), i.array("appendage_hinge")
    axis = i.array("appendage_axis") / np.linalg.norm(i.array("appendage_axis"))
    speed = i["appendage.rate"] * np.cross(axis, center - hinge)
    spin = i["appendage.rate"] * inertia[:3] * axis + i["appendage.mass"] * np.cross(center, speed)
    assert i.array("target_spin") == pytest.approx(spin, rel=1e-12, abs=1e-15)
    assert np.linalg.norm(spin) > 0.0
    assert i["appendage.energy"] > 0.0
