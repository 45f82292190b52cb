"""Tension over the last orbit: the mean of what it was, judged by closed forms and by a pendulum of our own."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from dcone_cosim.phases.stepping import PhaseLoop
from dcone_cosim.phases.tension import last_orbit
from dcone_cosim.progress import Progress
from dcone_cosim.recorder import TugLog
from dcone_cosim.results import PhaseResult
from dcone_cosim.scene.data import Scene
from tests.cosim.in_process import KernelComponent
from tests.cosim.test_summary import found, removal_run

MakeScene = Callable[..., Scene]
AXIS = 7178137.0
"""Of an orbit of 6052.41 s [m]."""


def recorded(scene: Scene, tugs: TugLog | None = None, end: float = 7500.0, **columns: Sequence[float]) -> PhaseResult:
    """A removal of rows 100 s apart whose clock begins at 50 s."""
    times = 50.0 + np.arange(0.0, end + 1.0, 100.0)
    named = {name.replace("__", "."): list(values)[: len(times)] for name, values in columns.items()}
    named["center.semi_major_axis"] = [AXIS] * len(times)
    return removal_run(scene, named, list(times), tugs or TugLog(1)).phases["removal"]


class TestWindow:
    """Rows 100 s apart up to 7500 s: an orbit before the end is 1447.6 s, and the row before that is at 1400 s."""

    TIME = np.arange(0.0, 7501.0, 100.0)
    TENSION = 0.02 + 1e-9 * TIME**2

    def test_the_mean_is_that_of_the_impulse(self, make_scene: MakeScene) -> None:
        impulse = 0.02 * self.TIME + 1e-9 * self.TIME**3 / 3.0
        told = last_orbit(recorded(make_scene("removal"), tether__tension=self.TENSION, tether__impulse=impulse))
        assert (told.window, told.is_orbit) == (6100.0, True)
        exact = 0.02 + 1e-9 * (7500.0**3 - 1400.0**3) / 3.0 / 6100.0
        assert told.mean == pytest.approx(exact, rel=1e-12)
        assert told.sampled == {"least", "largest"}

    def test_without_it_the_rows_are_samples_and_said_to_be(self, make_scene: MakeScene) -> None:
        run = removal_run(
            make_scene("removal"),
            {"tether.tension": list(self.TENSION), "center.semi_major_axis": [AXIS] * 76},
            list(self.TIME),
            TugLog(1),
        )
        told = last_orbit(run.phases["removal"])
        # the trapezoids of a square are too large by h^2 f'' / 12
        exact = 0.02 + 1e-9 * (7500.0**3 - 1400.0**3) / 3.0 / 6100.0
        assert told.mean == pytest.approx(exact + 1e-9 * 2.0 * 100.0**2 / 12.0, rel=1e-12)
        assert told.least == self.TENSION[14]
        rows = found(run)
        assert rows["tension_mean"].label == "mean tension, last orbit (of rows)"
        assert rows["tension_window"].value == 6100.0
        assert "tether.tension" not in rows, "the last row is one sample of a libration"

    def test_a_phase_of_less_than_an_orbit_counts_whole_and_says_so(self, make_scene: MakeScene) -> None:
        result = recorded(make_scene("removal"), end=6000.0, tether__tension=self.TENSION)
        told = last_orbit(result)
        assert (told.window, told.is_orbit) == (6000.0, False)
        assert last_orbit(recorded(make_scene("removal"), end=6100.0, tether__tension=self.TENSION)).is_orbit

    def test_rows_far_apart_tell_of_several_orbits_and_say_so(self, make_scene: MakeScene) -> None:
        """A row an hour and a half apart from the next holds one orbit, rows a day apart hold fourteen."""
        for apart, label in ((3000.0, "mean tension, last orbit"), (86400.0, "mean tension, last 14.3 orbits")):
            time = np.arange(4) * apart
            columns = {"tether.tension": [0.02] * 4, "tether.impulse": list(0.02 * time),
                       "center.semi_major_axis": [AXIS] * 4}  # fmt: skip
            rows = found(removal_run(make_scene("removal"), columns, list(time), TugLog(1)))
            assert rows["tension_mean"].label == label
            assert rows["tension_mean"].value == pytest.approx(0.02, rel=1e-12)

    def test_what_holds_over_a_macro_step_counts_from_the_first_step_of_the_window(self, make_scene: MakeScene) -> None:
        """The row at 1400 s tells of the step before it, which is not in the window."""
        least, peak = np.full(76, 0.01), np.full(76, 0.5)
        least[14], peak[14] = 0.0, 9.0
        columns = {"tether__tension": self.TENSION, "tether__tension_least": least, "tether__tension_peak": peak}
        told = last_orbit(recorded(make_scene("removal"), **columns))
        assert (told.least, told.largest) == (0.01, 0.5)
        least[15], peak[15] = 0.0, 9.0
        told = last_orbit(recorded(make_scene("removal"), **columns))
        assert (told.least, told.largest) == (0.0, 9.0)

    @pytest.mark.parametrize(
        ("flag", "when", "until"),
        [
            ("release__released", "release__time", "the line was cut"),
            ("break__broken", "break__time", "the line broke"),
        ],
    )
    def test_of_a_line_that_parts_it_is_the_orbit_before(
        self, make_scene: MakeScene, flag: str, when: str, until: str
    ) -> None:
        """At 6950 s: an orbit before is 897.6 s, the row before that at 800 s. What is slack after does not count."""
        parted = self.TIME > 6950.0
        impulse = np.where(parted, 0.02 * 6950.0, 0.02 * self.TIME)
        columns = {
            "tether__tension": np.where(parted, 0.0, 0.02),
            "tether__impulse": impulse,
            "tether__tension_least": np.where(parted, 0.0, 0.01),
            "tether__tension_peak": np.where(self.TIME > 7050.0, 0.0, np.where(parted, 0.7, 0.5)),
            flag: parted,
            when: np.where(parted, 6950.0, 0.0),
        }
        told = last_orbit(recorded(make_scene("removal"), **columns))
        assert (told.window, told.is_orbit, told.until) == (6150.0, True, until)
        assert told.mean == pytest.approx(0.02, rel=1e-12)
        assert (told.least, told.largest) == (0.01, 0.7)
        del columns["tether__impulse"], columns["tether__tension_least"]
        told = last_orbit(recorded(make_scene("removal"), **columns))
        assert (told.mean, told.least) == pytest.approx((0.02, 0.02), rel=1e-12)

    @pytest.mark.parametrize(("at", "largest"), [(1449.0, 0.07625), (1451.0, 30.0)])
    def test_a_tug_counts_from_the_begin_of_the_window(self, make_scene: MakeScene, at: float, largest: float) -> None:
        tugs = TugLog(1)
        tugs.update(1, np.array([[at, 30.0, 0.01]]))
        told = last_orbit(recorded(make_scene("removal"), tugs, tether__tension=self.TENSION))
        assert told.largest == pytest.approx(largest)
        assert (told.mean is None) == (largest == 30.0), "no mean of rows that tugs fall between"


def towed(duration: float, **parameters: float) -> PhaseResult:
    """Table 2's pair, in this process."""
    component = KernelComponent("removal", "removal", {"reel": "locked", "thrust": "along_track"})
    component.set({name.replace("__", "."): value for name, value in parameters.items()})
    component.enter_initialisation(0.0)
    component.exit_initialisation()
    return PhaseLoop(component, 60.0, 0.0, duration, Progress()).run()


RATE, LENGTH, REDUCED, PUSH = 1.0381289e-3, 12.0, 2000.0 / 3.0, 0.01 / 2000.0
"""Of Table 2: n [rad/s], line [m], reduced mass [kg], acceleration of the chaser by its thrust [m/s2]."""


def test_at_the_equilibrium_mean_least_and_largest_are_the_tide_s() -> None:
    """3 n^2 m_r l = 0.0258651 N, whatever the thrust."""
    angle = math.asin(PUSH / (3.0 * RATE**2 * LENGTH))
    length = LENGTH + 0.0258651 / 3926.99
    handed = {
        "start.relative_position[1]": length * math.cos(angle),
        "start.relative_position[2]": length * math.sin(angle),
    }
    told = last_orbit(towed(9000.0, **handed, **{"start.condition": 3}))
    for value in (told.mean, told.least, told.largest):
        assert value == pytest.approx(0.0258651, rel=1e-3)


def test_table_2_against_a_pendulum() -> None:
    """Hill's equations of a line of fixed length, integrated by scipy from the state at the begin of the window.

    With rho = l (cos a, sin a): a'' = -3 n^2 sin a cos a + f/l cos a, T = m_r (l a'^2 + 2 n l a' + 3 n^2 l cos^2 a
    + f sin a), f the push on the chaser, backwards.
    """
    result = towed(86400.0)
    told, recorder = last_orbit(result), result.recorder
    begin = int(np.searchsorted(recorder["time"], 86400.0 - told.window))
    x, y = (recorder[f"relative.position[{i}]"][begin] for i in (1, 2))
    u, v = (recorder[f"relative.velocity[{i}]"][begin] for i in (1, 2))
    start = [math.atan2(y, x), (x * v - y * u) / (x * x + y * y)]

    def slope(_: float, state: Sequence[float]) -> list[float]:
        sine, cosine = math.sin(state[0]), math.cos(state[0])
        return [state[1], -3.0 * RATE**2 * sine * cosine + PUSH / LENGTH * cosine]

    times = np.linspace(0.0, told.window, 20001)
    angle, rate = solve_ivp(slope, (0.0, told.window), start, t_eval=times, rtol=1e-10, atol=1e-12).y
    tide = 3.0 * RATE**2 * LENGTH * np.cos(angle) ** 2
    tension = REDUCED * (LENGTH * rate**2 + 2.0 * RATE * LENGTH * rate + tide + PUSH * np.sin(angle))
    assert told.is_orbit
    assert told.mean == pytest.approx(float(np.trapezoid(tension, times)) / told.window, rel=2e-3)
    assert told.least == pytest.approx(tension.min(), rel=2e-2)
    assert told.largest == pytest.approx(tension.max(), rel=2e-3)
    assert 0.02 < told.mean < 0.03
    # the twin: the last row, which was told before, is far from it
    assert abs(recorder["tether.tension"][-1] - told.mean) > 0.03
