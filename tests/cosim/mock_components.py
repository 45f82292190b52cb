"""Stand-ins for FMUs, in plain Python: they offer what the master asks of a component, and nothing else.

`MockCapture` drifts a target, a chaser and a net along straight lines and is captured at a set instant; `MockRemoval`
holds what it is given and reports tugs from a list. Both can be told to misbehave, or to lack what is optional.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from dcone_cosim.contract import OUTCOMES
from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.component import VariableInfo


class MockComponent:
    """Named values with a causality; subclasses say how a step changes them."""

    def __init__(self, name: str, can_save: bool = True) -> None:
        self.name = name
        self.can_save = can_save
        self.can_vary_step = True
        self.can_interpolate = False
        self.values: dict[str, float] = {}
        self.variables: dict[str, VariableInfo] = {}
        self.time = self.start = 0.0
        self.calls: list[tuple[float, float]] = []
        self.closed = False
        self._kept: dict[str, tuple[float, dict[str, float]]] = {}

    def declare(self, names: Iterable[str], causality: str, value: float = 0.0, kind: str = "Real") -> None:
        for name in names:
            self.values[name] = value
            self.variables[name] = VariableInfo(name, len(self.variables), kind, "1", causality, "")

    def set(self, values: Mapping[str, float]) -> None:
        for name, value in values.items():
            if name not in self.values:
                raise FmuError(f"{self.name}: no variable {name!r}")
            self.values[name] = value

    def get(self, names: Sequence[str]) -> dict[str, float]:
        return {name: float(self.values[name]) for name in names}

    def reader(self, names: Sequence[str]) -> MockReader:
        return MockReader(self, names)

    @property
    def since(self) -> float:
        """Time since the start of this instance: what a contract's instants count."""
        return self.time - self.start

    def enter_initialisation(self, start: float, stop: float | None = None) -> None:
        self.time = self.start = start

    def exit_initialisation(self) -> None:
        self.refresh()

    def step(self, time: float, size: float) -> None:
        assert abs(time - self.time) <= 1e-9 * max(1.0, abs(time)), "the master left a gap in time"
        self.calls.append((time, size))
        self.time = time + size
        self.refresh()

    def refresh(self) -> None:
        """Bring the outputs up to the present time."""

    def save(self, key: str = "") -> None:
        assert self.can_save
        self._kept[key] = (self.time, copy.copy(self.values))

    def restore(self, key: str = "") -> None:
        time, values = self._kept[key]
        self.time, self.values = time, copy.copy(values)

    def release(self, key: str = "") -> None:
        self._kept.pop(key, None)

    def close(self) -> None:
        self.closed = True


class MockReader:
    def __init__(self, component: MockComponent, names: Sequence[str]) -> None:
        self.names = tuple(names)
        self.values = np.zeros(len(self.names))
        self._component = component

    def __call__(self) -> np.ndarray:
        self.values[:] = [self._component.values[name] for name in self.names]
        return self.values


def elements(name: str, size: int = 3) -> list[str]:
    return [f"{name}[{i}]" for i in range(1, size + 1)]


class MockCapture(MockComponent):
    """Captured from `instant` on; `reports` puts the instant into `t_capture`, `outcome` replaces the good one."""

    def __init__(
        self,
        instant: float = 7.1234567,
        reports: bool = False,
        can_save: bool = True,
        outcome: str = "captured",
        spin: float = 0.0,
        fails_at: float = np.inf,
        line: float | None = None,
    ) -> None:
        super().__init__("capture", can_save)
        self.instant, self.reports, self.ends_as, self.fails_at = instant, reports, outcome, fails_at
        self.declare(["chaser.mass"], "parameter", 2000.0)
        self.declare(["target.mass"], "parameter", 1000.0)
        self.declare(elements("chaser.start_velocity"), "parameter")
        for name in ("chaser.position", "chaser.velocity", "target.position", "target.velocity", "target.rate"):
            self.declare(elements(name), "output")
        self.declare(elements("target.inertia"), "output", 1500.0)
        self.declare(elements("target.spin"), "output")
        self.declare(elements("target.attitude", 4), "output")
        self.declare(elements("vertex.position"), "output")
        self.declare(["target.reach"], "output", 1.5 * np.sqrt(3.0))
        if line is not None:
            self.declare(["tether.length"], "parameter", line)
        self.declare(["catch.mass"], "output", 6.0)
        for name in ("catch.position", "catch.velocity", "catch.spin"):
            self.declare(elements(name), "output")
        self.declare(elements("catch.inertia", 6), "output")
        self.declare(["energy.kinetic"], "output", 12.0)
        self.declare(["t_capture"], "output", -1.0)
        self.declare(["captured", "settled"], "output", kind="Boolean")
        self.declare(["outcome"], "output", kind="Integer")
        self.values |= {"target.attitude[1]": 1.0, "target.spin[3]": spin, "chaser.velocity[2]": -0.005}
        self.values |= {"catch.velocity[2]": 5.0 / 3.0}

    def refresh(self) -> None:
        if self.time >= self.fails_at:
            raise FmuError(f"{self.name}: the mock was told to fail at {self.fails_at} s")
        done = self.since >= self.instant
        self.values["chaser.position[2]"] = -12.0 - 0.005 * self.since
        self.values["catch.position[2]"] = -12.0 + 5.0 / 3.0 * self.since
        self.values |= {"vertex.position[1]": 0.3, "vertex.position[2]": self.values["catch.position[2]"] - 1.5}
        good = self.ends_as in ("captured", "settled")
        self.values["captured"] = float(done and good)
        self.values["outcome"] = float(OUTCOMES.index(self.ends_as) if done else 0)
        if "t_capture" in self.values:
            self.values["t_capture"] = self.instant if done and good and self.reports else -1.0


class MockRemoval(MockComponent):
    """Holds its parameters; `tampered` changes values after they are set, `tugs` are (time, peak, speed)."""

    RING = 2

    def __init__(
        self,
        tampered: Mapping[str, float] | None = None,
        tugs: Sequence[tuple[float, float, float]] = (),
        grows: float = 0.0,
        without: Sequence[str] = (),
    ) -> None:
        super().__init__("removal")
        self.tampered, self.tugs, self.grows = dict(tampered or {}), list(tugs), grows
        self.declare(["chaser.mass", "target.mass", "start.condition"], "parameter")
        line = {"tether.rest_length": 12.0, "target.attachment_distance": 0.0}
        for name in line.keys() - set(without):
            self.declare([name], "parameter", line[name])
        self.declare(["orbit.altitude", "orbit.true_anomaly", "thrust.level"], "parameter")
        for name in ("center_position", "center_velocity", "relative_position", "relative_velocity"):
            self.declare(elements(f"start.{name}"), "parameter")
        self.declare(["separation"], "output")
        self.declare(["tether.tug_count"], "output", kind="Integer")
        self.declare(["tether.taut"], "output", kind="Boolean")
        for i in range(1, self.RING + 1):
            self.declare([f"tug[{i}].{field}" for field in ("time", "peak", "speed")], "output")

    def exit_initialisation(self) -> None:
        self.values |= {name: factor * self.values[name] for name, factor in self.tampered.items()}
        super().exit_initialisation()

    def refresh(self) -> None:
        self.values["separation"] = float(np.linalg.norm([self.values[n] for n in elements("start.relative_position")]))
        seen = [tug for tug in self.tugs if tug[0] <= self.since]
        self.values["tether.tug_count"] = float(len(seen))
        self.values["tether.taut"] = float(bool(seen) and self.since - seen[-1][0] < self.grows)
        for place, (time, peak, speed) in enumerate(reversed(seen[-self.RING :]), start=1):
            grown = peak if self.since - time >= self.grows else 0.5 * peak
            self.values |= {f"tug[{place}].time": time, f"tug[{place}].peak": grown, f"tug[{place}].speed": speed}
