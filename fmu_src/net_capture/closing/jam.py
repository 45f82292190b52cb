"""A reel that jams: from an instant on it holds the cord that is out, and the others go on.

One that has jammed before the reels start never takes its cord up: that side of the mouth keeps its whole length.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fmu_src.extremes import Extreme, times
from fmu_src.interface import Term
from fmu_src.net_capture.planes import MOST_BULLETS
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.rows import at_least_zero, parameter
from orbital.kernel import kernel


def make(composition: Any) -> Any:
    """Kernel `holds(p, i)`: whether the reel of pair i has jammed, by the grid time."""
    now = composition.clock.now

    @kernel
    def holds(p, i):
        """Whether the reel of pair i has jammed.

        Checked  tests/net_capture/test_springs.py
        """
        return i + 1 == p.jam_reel and now(p) >= p.jam_time

    return holds


def refuses(scene: Scene) -> Iterator[Refusal]:
    """A reel that is not there, and an instant that never comes."""
    reel, time = int(scene.values["jam.reel"]), scene.values["jam.time"]
    most = scene.parts["net"].checks.bullets(scene.values)
    if reel > most:
        yield Refusal("jam.reel", f"{reel}", f"must be at most {most}: this mouth has so many reels")
    if time > scene.duration:
        expected = f"must be at most {scene.duration:g} s, the duration, or leave the table out"
        yield Refusal("jam.time", f"{time:g} s", expected)


PART = Term(
    "a reel of the closing cord that jams",
    (
        parameter(
            "jam.reel",
            "1",
            "which one, counted from 1: that between the bullet of this number and the next",
            1,
            1,
            MOST_BULLETS,
            kind="Integer",
        ),
        at_least_zero("jam.time", "s", "from when on it holds its cord as it is, since the shot", 0.0),
    ),
    needs=("closing",),
    extremes=(
        Extreme(
            "a reel that jams before it starts",
            "one side of the mouth keeps all of its cord while the others draw",
            "energy_gained",
            {"jam.reel": 1, "jam.time": 0.0},
            chief=True,
        ),
        Extreme(
            "a reel that jams under a stiff cord",
            "what it has drawn it holds against the tugs of a cord a hundred times as stiff",
            "energy_gained",
            {"jam.reel": 1, "closing.axial_stiffness": times("closing.axial_stiffness", 1e2)},
        ),
    ),
    make=make,
    refuses=refuses,
)
