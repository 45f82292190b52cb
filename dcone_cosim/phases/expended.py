"""What a chaser has spent: its propellant before, between and in the phases of a run, and the nets that it has left.

mass after = mass before - propellant - net,     propellant by Tsiolkovsky from the change of velocity
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import takewhile

from dcone_cosim import build
from dcone_cosim.errors import HandoffError
from dcone_cosim.findings import Finding
from dcone_cosim.phases import kind_of
from dcone_cosim.results import PhaseResult, RunResult
from dcone_cosim.scene.data import PhaseScene
from orbital.constants import STANDARD_GRAVITY
from orbital.manoeuvres import propellant

TOWED_ON = "chaser.propellant"
"""Output of a tow: propellant used since it began [kg]."""
NET = "catch.mass"
"""Output of a capture: mass of net, bullets and vertex [kg]."""
SHOOTING = "net_capture"
"""Model of the phases that take a net each."""


def net_mass(phase: PhaseScene, left: float | None) -> float:
    """Mass of the net that a phase shoots, with bullets and vertex [kg]: of a model of ours by its values, of a file as
    that of the phase before; `HandoffError` where neither is known."""
    main = phase.main
    if main.fmu is None:
        values = main.values
        return float(build.masses_after(values, main.terms)["target.mass"] - values["target.mass"])
    if left is None:
        raise HandoffError(f"hand-off refused: the mass of the net that {main.fmu.name} shoots is not known beforehand")
    return left


@dataclass(frozen=True)
class Expended:
    """What a manoeuvre takes, and what there is after it.

    before             mass of the chaser as the phase before left it, with the nets that are aboard   [kg]
    speed              change of velocity, sum of the sizes of all burns                              [m/s]
    specific_impulse                                                                                  [s]
    net                mass of the net that the next phase shoots                                     [kg]
    nets               that there are, this one included                                              [1]
    budget             propellant at the first shot; infinite where the scene does not say            [kg]
    earlier            propellant spent until then                                                    [kg]
    """

    before: float
    speed: float
    specific_impulse: float
    net: float
    nets: int
    budget: float
    earlier: float

    @property
    def propellant(self) -> float:
        return propellant(self.before, self.speed, self.specific_impulse)

    @property
    def impulse(self) -> float:
        """Of the exhaust, relative to the chaser [N s]."""
        return self.propellant * self.specific_impulse * STANDARD_GRAVITY

    @property
    def chaser(self) -> float:
        """Mass of the chaser once the next net has left it [kg]."""
        return self.before - self.propellant - self.net

    @property
    def spent(self) -> float:
        """Propellant since the first shot [kg]."""
        return self.earlier + self.propellant

    @classmethod
    def nothing(cls, mass: float) -> Expended:
        """Of a chaser of this mass [kg] that has not moved yet."""
        return cls(mass, 0.0, 1.0, 0.0, 1, math.inf, 0.0)

    def check(self) -> None:
        """`HandoffError` where the propellant, or the chaser, does not last."""
        if self.spent > self.budget:
            raise HandoffError(
                f"hand-off refused: the chaser has spent {self.earlier:.6g} kg of propellant and needs "
                f"{self.propellant:.6g} kg more; it had {self.budget:.6g} kg, handoff.propellant"
            )
        if self.chaser <= 0.0:
            raise HandoffError(
                f"hand-off refused: of a chaser of {self.before:.6g} kg nothing is left once {self.propellant:.6g} kg "
                f"of propellant and a net of {self.net:.6g} kg are gone"
            )

    def findings(self, place: str, failed: bool = False) -> Iterator[Finding]:
        """What it took; of one that failed what it needed, as far as that is known."""
        if failed:
            if self.speed > 0.0:
                yield Finding(place, "velocity_change", "change of the chaser's velocity, needed", self.speed, "m/s")
                yield Finding(place, "propellant", "propellant that it needs", self.propellant, "kg")
                yield Finding(place, "propellant_spent", "propellant spent so far", self.earlier, "kg")
            return
        yield Finding(place, "velocity_change", "change of the chaser's velocity", self.speed, "m/s")
        yield Finding(place, "propellant", "propellant that it took", self.propellant, "kg")
        yield Finding(place, "propellant_spent", "propellant spent since the first shot", self.spent, "kg")
        yield Finding(place, "chaser_mass", "mass of the chaser after the next shot", self.chaser, "kg")
        yield Finding(place, "nets_left", "nets left after the next shot", self.nets - 1)


def expended(run: RunResult, phase: PhaseScene, before: float, speed: float, net: float) -> Expended:
    """Of the manoeuvre before a phase that shoots.

    before    mass of the chaser [kg], net and propellant aboard
    speed     change of velocity that it makes [m/s]
    net       mass of the net [kg]
    """
    names = [one.name for one in run.scene.phases if kind_of(one.name).model == SHOOTING]
    options = run.scene.handoff
    return Expended(
        before,
        speed,
        options.specific_impulse,
        net,
        len(names) - names.index(phase.name),
        options.propellant,
        spent(run, phase.name),
    )


def spent(run: RunResult, until: str) -> float:
    """Propellant [kg] of all manoeuvres and tows of a run before a phase."""
    total = 0.0
    for phase in takewhile(lambda one: one.name != until, run.scene.phases):
        booked, result = getattr(run.handovers.get(phase.name), "expended", None), run.phases.get(phase.name)
        total += 0.0 if booked is None else booked.propellant
        total += 0.0 if result is None else towed_on(result)
    return total


def towed_on(result: PhaseResult) -> float:
    """Propellant [kg] that a phase has used, by its FMU; nothing where that does not tell it."""
    recorder = result.recorder
    return float(recorder.last()[TOWED_ON]) if len(recorder) and TOWED_ON in recorder else 0.0


def of_tows(run: RunResult, until: str) -> float:
    """Propellant [kg] of the tows before a phase since the last shot: their FMUs hold the mass that the chaser had
    then."""
    total = 0.0
    for phase in takewhile(lambda one: one.name != until, run.scene.phases):
        if phase.name in run.phases:
            total = 0.0 if kind_of(phase.name).model == SHOOTING else total + towed_on(run.phases[phase.name])
    return total


def foreseen(run: RunResult, tow: PhaseScene) -> str | None:
    """What is to be said of a tow that would take more propellant than there is if it thrust all the time, by
    |F| t/(Isp g0)."""
    level, specific_impulse = (tow.setting(f"thrust.{name}") for name in ("level", "specific_impulse"))
    if level is None or specific_impulse is None:
        return None
    needed = abs(level) * tow.duration / (specific_impulse * STANDARD_GRAVITY)
    said = f"the {kind_of(tow.name).spoken} would take {needed:.6g} kg of propellant if it thrust all the time"
    return _beyond(run, tow.name, needed, said)


def overdrawn(run: RunResult, result: PhaseResult) -> str | None:
    """What is to be said of a tow that has taken more propellant than there was."""
    taken = towed_on(result)
    said = f"the {kind_of(result.name).spoken} has taken {taken:.6g} kg of propellant"
    return _beyond(run, result.name, taken, said)


def _beyond(run: RunResult, phase: str, needed: float, said: str) -> str | None:
    budget = run.scene.handoff.propellant
    if math.isinf(budget):
        return None
    earlier = spent(run, phase)
    if earlier + needed <= budget:
        return None
    return f"{said}; the chaser had {budget:.6g} kg, handoff.propellant, and {earlier:.6g} kg were spent before"
