"""The next debris of a mission: the chaser lets go of the one that it has towed, comes to another, and shoots a net.

velocity change = |sqrt(mu/a1) - sqrt(mu/a2)| + what the scene says     from the orbit of the release to that of [orbit]
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dcone_cosim.errors import HandoffError
from dcone_cosim.findings import Finding
from dcone_cosim.fmu.component import Steppable
from dcone_cosim.ledger import LedgerRow, closure_finding, require_closed
from dcone_cosim.phases.capture import Capture, CaptureOptions
from dcone_cosim.phases.expended import NET, TOWED_ON, Expended, expended, net_mass, of_tows
from dcone_cosim.phases.phase import Document, Main, Stage
from dcone_cosim.phases.second_shot import MASS, FurtherShot, about_handover, about_net, elements, vector
from dcone_cosim.results import Handover, RunResult
from dcone_cosim.scene.data import PhaseScene
from dcone_cosim.scene.expected import TEXT, Expected
from dcone_cosim.scene.mistakes import Mistake
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.manoeuvres import spiral_speed

TARGET = "target.mass"
FALLING = "engine.propellant_left"
"""Output of a tow whose masses fall as propellant is used."""
BODIES = ("chaser", "target", "center")
FASTEST = 2e4
"""From the lowest orbit to the lowest one the other way round takes less [m/s]."""


@dataclass(frozen=True)
class NextCaptureOptions(CaptureOptions):
    """What concerns the master of the capture of another debris.

    like              phase that it is like
    velocity_change   of the chaser on its way, beside the spiral from one orbit to the other [m/s]
    """

    like: str = ""
    velocity_change: float = 0.0


@dataclass
class NextHandover:
    """From the tow of one debris to the capture of the next.

    time       from the begin of the tow to the release [s]
    left       what the tow left; the propellant is that of all tows since the shot
    axes       semi-major axes of the chaser's orbit at the release, and of that of the next debris [m]
    """

    time: float
    phase: PhaseScene
    left: Mapping[str, float]
    axes: tuple[float, float]
    expended: Expended
    start: float = 0.0
    reach: float | None = None
    rows: list[LedgerRow] = field(default_factory=list)
    failure: str = ""

    def parameters(self, component: Steppable) -> dict[str, float]:
        return {MASS: self.expended.chaser}

    def close(self, component: Steppable) -> None:
        """Masses by what both FMUs say, and the momentum of both bodies as they part."""
        self.rows = list(_rows(self, component.get([MASS, NET])))
        require_closed(self.rows)

    def recall(self, told: Mapping[str, Any]) -> None:
        self.rows, self.failure = [LedgerRow.of(row) for row in told["rows"]], told["failure"]

    def findings(self) -> list[Finding]:
        place = f"hand-off to {self.phase.name}"
        height = self.axes[0] - EARTH_EQUATORIAL_RADIUS
        rows = [
            Finding(place, "time", "debris let go, after its tow began", self.time, "s"),
            Finding(
                place,
                "released_axis",
                "semi-major axis there, less Earth's radius",
                height,
                "m",
                0.0,
                "km",
            ),
            *self.expended.findings(place, bool(self.failure)),
        ]
        return [*rows, *closure_finding(place, self.rows)]

    def told(self) -> dict[str, Any]:
        return {
            "time": {"value": self.time, "unit": "s", "clock": "since the tow before began"},
            "rows": [row.as_dict() for row in self.rows],
            "semi_major_axes": {"value": list(self.axes), "unit": "m"},
            "propellant": {"value": self.expended.propellant, "unit": "kg"},
            "impulse": {"value": self.expended.impulse, "unit": "N s"},
            "left": dict(self.left),
            "failure": self.failure,
        }


def _rows(record: NextHandover, held: Mapping[str, float]) -> Iterator[LedgerRow]:
    left, spent = record.left, record.expended
    towed, mass = left[TOWED_ON], left[MASS]
    gone = towed + spent.propellant
    yield LedgerRow(
        "mass, chaser and nets aboard", "kg", mass, held[MASS] + held[NET], gone, "propellant of tow and transfer", mass
    )
    yield LedgerRow("mass, debris", "kg", left[TARGET], 0.0, left[TARGET], "let go", left[TARGET])
    if FALLING in left:  # the masses at the release are not among what is told
        return
    chaser, target, pair = (vector(left, f"{body}.velocity") for body in BODIES)
    before, after = (mass + left[TARGET]) * pair, mass * chaser + left[TARGET] * target
    size = float(np.linalg.norm(before))
    for axis, was, now in zip("xyz", before.tolist(), after.tolist(), strict=True):
        yield LedgerRow(f"linear momentum, both bodies as they part, {axis}", "N s", was, now, 0.0, "", size)


class NextCapture(Capture):
    name = "next_capture"
    prefix = "next_capture_"
    follows = ("removal", "second_tow")
    alone = False
    keys: Mapping[str, Expected] = {
        **Capture.keys,
        "like": Expected("1", TEXT),
        "velocity_change": Expected("m/s", example="10 m/s", minimum=0.0, maximum=FASTEST),
    }
    handoff_keys = FurtherShot.handoff_keys
    takes = (
        *(MASS, TARGET),
        *(one for body in BODIES for of in ("position", "velocity") for one in elements(f"{body}.{of}", np.zeros(3))),
    )
    takes_too = (FALLING,)
    taken_over = (MASS,)

    def options(self, found: Mapping[str, Any], main: Main | None) -> NextCaptureOptions:
        own = {key: value for key, value in found.items() if key in ("like", "velocity_change")}
        plain = super().options({key: value for key, value in found.items() if key not in own}, main)
        return NextCaptureOptions(**vars(plain), **own)

    def faults(self, document: Document) -> Iterator[Mistake]:
        yield from super().faults(document)
        yield from about_handover(self, document)

    def value_faults(self, before: PhaseScene | None, own: PhaseScene, tables: Mapping[str, Any]) -> Iterator[Mistake]:
        yield from super().value_faults(before, own, tables)
        yield from about_net(own, tables) if before is not None else ()

    def take_over(self, stage: Stage) -> Handover | None:
        """What is left of the chaser; `HandoffError` where its propellant does not bring it there."""
        if stage.before is None:
            return None
        run, phase, tow = stage.run, stage.phase, stage.run.phases[stage.before.name]
        left = {**run.left[stage.before.name], TOWED_ON: of_tows(run, self.name)}
        altitude = phase.setting("orbit.altitude")
        assert altitude is not None, "the contract asks for it"
        place, speed = vector(left, "chaser.position"), vector(left, "chaser.velocity")
        axis = 1.0 / (2.0 / float(np.linalg.norm(place)) - float(speed @ speed) / EARTH_MU)
        axes = axis, EARTH_EQUATORIAL_RADIUS + altitude
        mass = left[MASS] - left[TOWED_ON]
        record = NextHandover(tow.end - tow.start, phase, left, axes, Expended.nothing(mass))
        run.handovers[self.name] = record
        if axis <= 0.0:
            raise HandoffError("hand-off refused: the chaser is on no closed orbit when it lets go")
        change = spiral_speed(*axes) + phase.options.velocity_change
        record.expended = expended(run, phase, mass, change, net_mass(phase, None))
        record.expended.check()
        return record

    def clock(self, run: RunResult) -> str:
        return "since the shot at the next debris"


PHASE = NextCapture()
