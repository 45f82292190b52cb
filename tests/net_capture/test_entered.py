"""What a book of energy is measured by: all that came in, from whoever gave it."""

import numpy as np
import pytest

from fmu_src.cautions import Range
from fmu_src.net_capture.cautions import after
from fmu_src.net_capture.entered import by_the_end, over_time

FALL = {
    # 0.33 kg let go from rest in air: m g h = 50 J, of which the air takes most
    "energy.kinetic": np.array([1e-9, 3.0, 5.42]),
    "energy.potential": np.array([0.0, -20.0, -50.21]),
    "energy.remainder": np.array([0.0, -1e-6, -1.9e-6]),
}
SPIN = {
    # a heavy spinning target gives 3053 J to the net that it hits
    "energy.kinetic": np.array([23.0, 23.0, 1058.7]),
    "closing.work": np.array([0.0, 0.0, 6.0]),
    "target.energy": np.array([272378.7, 272378.7, 269325.2]),
    "energy.remainder": np.array([0.0, 0.0, -15.25]),
}
HISTORY = {
    # lifted by a gravity that turns round: the reel's work on the way is negative
    "energy.kinetic": np.array([1e-9, 0.2, 0.54]),
    "gravity.work": np.array([0.0, 1.0, 1.89]),
    "energy.potential": np.array([0.0, -0.04, 1.36]),
    "tether.work": np.array([0.0, -0.5, -0.25]),
    "energy.remainder": np.array([0.0, 8e-5, 7e-5]),
}
CASES = ((FALL, 50.21), (SPIN, 23.0 + 6.0 + 3053.5), (HISTORY, 1.89 + 0.04 + 0.5))


def seen_of(columns):
    def seen(name):
        if name not in columns:
            return None
        column = columns[name]
        return Range(float(column.min()), float(column.max()), float(column[0]), float(column[-1]))

    return seen


@pytest.mark.parametrize(("columns", "expected"), CASES)
def test_it_is_what_gave(columns, expected):
    entered = over_time(columns)
    assert entered[-1] == pytest.approx(expected, rel=1e-6)
    assert by_the_end(seen_of(columns)) == pytest.approx(entered[-1], rel=1e-12)
    assert np.all(np.diff(entered) >= 0.0)
    assert entered[0] == columns["energy.kinetic"][0]


@pytest.mark.parametrize(("columns", "expected"), CASES)
def test_the_warning_is_of_a_hundredth_of_it(columns, expected):
    """Silent as it stands; with a remainder of 1.1 % of what came in it says so."""
    assert not list(after({}, (), {}, seen_of(columns)))
    left = {**columns, "energy.remainder": np.array([0.0, 0.0, -0.011 * expected])}
    (caution,) = after({}, (), {}, seen_of(left))
    assert f"of the {expected:.3g} J that came in, 1.1 %" in caution.sentence


def test_an_fmu_without_a_kinetic_energy_is_not_measured():
    assert by_the_end(seen_of({"closing.work": np.array([0.0, 1.0])})) is None
