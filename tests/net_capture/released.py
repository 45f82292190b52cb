"""A free flight with every part of the release: one choice of terms, and so one build, for all tests of them."""

from tests.conftest import FREE

RELEASED = FREE | {"ejection": "4", "spin": "turning", "tether": "dragging"}
COARSE = {"net.side": 8.0, "net.mesh": 4.0, "chaser.mass": 40.0, "tether.friction": 0.0, "tether.length": 1e3}
EACH = {
    "ejection.speed_error[1]": 0.4,
    "ejection.angle_error[2]": 0.1,
    "ejection.side_angle[1]": 0.2,
    "ejection.delay[3]": 0.35,
    "ejection.stays[4]": True,
}
"""One bullet faster and off to the side, one wider, one late, one that stays."""
