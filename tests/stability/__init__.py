"""Extremes, their criteria, and the command that tries them."""

COARSE_NET = {
    "net.side": 24.0,
    "net.mesh": 3.0,
    "net.mass": 0.33,
    "net.density": 1440.0,
    "net.youngs_modulus": 70e9,
    "net.damping_ratio": 0.106,
    "net.segments": 1,
    "net.fold_side": 0.5,
    "chaser.mass": 2000.0,
    "bullets.mass": 0.5,
    "bullets.speed": 3.0,
    "bullets.angle": 0.7,
    "vertex.mass": 0.15,
}
"""The net that limits and seeded faults are judged with: a coarse one of Table 1."""
