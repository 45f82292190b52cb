"""Single precision is refused where a substep is too short for it: rounding would drive the net."""

import numpy as np
import pytest

from dcone_cosim.build import defaults
from fmu_src.net_capture.interface import MODEL, refusals
from fmu_src.net_capture.precision import STEPS_BETWEEN, spacing

SIZES = (0.3, 1.0, 4.0, 15.999, 16.0, 20.0, 100.0)


def told(precision, **changes):
    terms = {"net": "square", "gravity": "none", "precision": precision}
    interface = MODEL.interface(terms)
    values = defaults(interface) | {name.replace("__", "."): value for name, value in changes.items()}
    return refusals(interface.terms, values)


@pytest.mark.parametrize("size", SIZES)
def test_the_distance_of_neighbouring_numbers(size):
    assert spacing(size) == np.spacing(np.float32(size))


def test_a_substep_in_which_nothing_can_move_is_refused():
    """Found by `dcone stability`: at a damping ratio of 10 single precision gave a net 5.5 times its energy."""
    (found,) = told("single", net__damping_ratio=10.0)
    assert (found.name, found.value) == ("solver.precision", "single")
    assert STEPS_BETWEEN == 24.0
    assert f"must be at least 24 of that, {24.0 * np.spacing(np.float32(20.0)):.2g} m" in found.expected
    assert told("double", net__damping_ratio=10.0) == []


def test_usual_nets_are_not():
    assert told("single") == []
    assert told("single", net__mesh=0.5, net__damping_ratio=0.05) == []


def test_what_counts_is_the_way_in_a_substep():
    """Twice the speed, or twice the step, and half as far away: each makes up for a substep half as long."""
    least = {"net__damping_ratio": 0.106, "solver__step_ratio": 0.1125}
    assert told("single", **least, bullets__speed=3.0) != []
    assert told("single", **least, bullets__speed=6.0) == []
    assert told("single", **least | {"solver__step_ratio": 0.225}) == []
    near = {"chaser.start_position[2]": -7.0}
    assert told("single", **least, **near) == []
