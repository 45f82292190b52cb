"""One choice of terms with all that closes, holds and judges a catch, compiled once for the tests of these parts."""

HOLDING = {
    "net": "square",
    "gravity": "none",
    "target": "box",
    "contact": "inelastic",
    "closing": "springs",
    "jam": "plain",
    "tether": "slack",
    "settling": "speed",
    "quality": "plain",
    "pull_off": "plain",
}
ALONE = {"vertex.mass": 0.0, "jam.time": 1e9, "chaser.start_position[2]": -300.0}
"""Nothing jams, and the target is far away."""
