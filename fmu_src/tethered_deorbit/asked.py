"""What a scene may ask of the gains of a reel in place of telling them: rows that no FMU has."""

from __future__ import annotations

from fmu_src.interface import Variable
from fmu_src.rows import choice, parameter, positive

LINEAR_LAWS = ("linear", "regulator", "sampled_linear")
"""Whose loop about a rest has gains, poles and margins."""
GAINS, RESTS = ("given", "lqr", "poles"), ("equilibrium", "towing")
GIVEN, LQR, POLES = range(3)
EQUILIBRIUM, TOWING = range(2)

WEIGHTS = (
    ("reel.length_weight", "length, in reel.length"),
    ("reel.rate_weight", "its rate, in reel.length n"),
    ("reel.angle_weight", "angle, in radians"),
    ("reel.angle_rate_weight", "its rate, in n"),
)
"""Weights of the quadratic regulator, on the states in their order."""
EFFORT_WEIGHT = "reel.effort_weight"


def asked_rows(effort: str) -> tuple[Variable, ...]:
    """What a scene may say of gains that are designed.

    effort    in what the effort of the reel is counted
    """
    count = len(WEIGHTS)
    return (
        choice("reel.gains", "given: as the gains say; lqr: those of the quadratic regulator with the weights; poles: "
               "those that put the poles of the closed loop where they are asked", GAINS),
        choice("reel.about", "what the gains are designed about: the rest near the vertical, the target above the "
               "chaser, or the taut line along the track", RESTS),
        *(parameter(name, "1", f"of the quadratic regulator, on the square of the {what}", 1.0, 0.0, 1e12)
          for name, what in WEIGHTS),
        positive(EFFORT_WEIGHT, "1", f"of the quadratic regulator, on the square of {effort}", 1.0, 1e12),
        parameter("reel.poles[#]", "1", "asked for, in n: the real parts",
                  tuple(-1.0 - 0.25 * k for k in range(count)), -1e6, 1e6, shape=(count,)),
        parameter("reel.poles_imaginary[#]", "1", "asked for, in n: the imaginary parts", 0.0, -1e6, 1e6,
                  shape=(count,)),
    )  # fmt: skip
