"""In what two scenes differ: told by key, by what reaches an FMU, and not by how it is written."""

from __future__ import annotations

from dcone_cosim.loading import load
from dcone_cosim.resume.differences import differences


def told(*settings: str) -> set[str]:
    return {row.told() for row in differences(load("mission"), load("mission", settings))}


def test_the_same_said_otherwise_is_no_difference() -> None:
    assert told() == set()
    assert told("removal.tether.diameter=0.1 cm", "title=another") == set()


def test_a_parameter_a_duration_an_option_and_a_term() -> None:
    assert told("removal.tether.diameter=2 mm") == {"removal.tether.diameter: was 0.001, is 0.002"}
    assert told("removal.duration=1 h") == {"removal.duration: was 21600, is 3600"}
    assert told("capture.hand_over=settled", "capture.settling.by=speed") >= {
        "capture.hand_over: was captured, is settled"
    }
    assert "removal.target: was point, is rigid" in told("removal.target.body=rigid")
    assert told("handoff.point_tolerance=0.02") == {"handoff.point_tolerance: was 0.2, is 0.02"}


def test_a_key_that_reaches_two_phases() -> None:
    assert told("orbit.altitude=700 km") == {
        "capture.orbit.altitude: was 800000, is 700000",
        "removal.orbit.altitude: was 800000, is 700000",
    }


def test_a_phase_that_is_left_out() -> None:
    assert told('phases=["capture"]') >= {"removal: was a phase, is nothing"}
