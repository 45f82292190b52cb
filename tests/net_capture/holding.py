"""One choice of terms with all that closes, holds and judges a catch, compiled once for the tests of these parts."""

HOLDING = {
    "net": "square",
    "gravity": "none",
    "closing": "springs",
    "jam": "plain",
}
ALONE = {"vertex.mass": 0.0, "jam.time": 1e9}
"""Nothing jams."""
