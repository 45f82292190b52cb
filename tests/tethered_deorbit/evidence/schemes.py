"""What each scheme makes of slack and taut, of undamped motion over a day, and of a stiff damped line; what it costs.

    python -m tests.tethered_deorbit.evidence.schemes

makes `schemes.json` again, in some minutes. Four things are measured, for each scheme:

order       slope of the error over the step, of one mass on a line, in closed form: while it stays taut; over three
            tugs with the changes stepped over, as if there were none; and over three tugs with steps cut to end on each
            change, as the model does
tolerance   how the time of Table 2's fifth undamped tug falls with all three tolerances
drift       energy gained or lost in a day without a field, damping or thrust, as a share of what vibrates: a pair that
            whirls and vibrates on a taut line, and one that flies from tug to tug
stiff       seconds of processor time, and the error of the mean tension, of an hour's tow on one metre of 1 TPa at ten
            times critical damping, by tolerances; and what a step costs where nothing is stiff
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import brentq

from fmu_src.instance import Instance
from fmu_src.integrators import dop853, gauss, radau
from fmu_src.integrators.scheme import AdaptiveScheme
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from orbital.kernel import kernel
from orbital.oscillators import reduced_mass

RESULT = Path(__file__).with_name("schemes.json")
COMMAND = "python -m tests.tethered_deorbit.evidence.schemes"
MAKE: dict[str, Callable[..., AdaptiveScheme]] = {
    "dop853": dop853.make_dop853,
    "gauss": gauss.make_gauss,
    "radau": radau.make_radau,
}
PULL, OMEGA, APEX, TUGS = 1.0, 10.0, -0.5, 3
"""Acceleration by which the line is pulled, frequency of the taut line, stretch at the start (slack); tugs counted."""
STEPS = {
    "dop853": (0.09, 0.072, 0.057, 0.045, 0.036),
    "gauss": (0.11, 0.087, 0.069, 0.055, 0.043),
    "radau": (0.06, 0.045, 0.033, 0.025, 0.018),
}
"""Steps at which the errors are far from rounding, and already asymptotic [s]."""
SMALL = 1e-10


@kernel
def motion(context: Any, state: Any, rate: Any, elapsed: float) -> None:
    """x'' = g - w^2 x while taut, g while slack: always taut, always slack, or by the sign of x (context 1, 0, -1)."""
    taut = context[0] > 0.5 or (context[0] < -0.5 and state[0] > 0.0)
    rate[0] = state[1]
    rate[1] = PULL - (OMEGA * OMEGA * state[0] if taut else 0.0)


@kernel
def strict(context: Any, state: Any, error: Any) -> float:
    return (error[0] * error[0] + error[1] * error[1]) / (SMALL * SMALL)


def exact(time: float) -> Any:
    """State at a time after the start at rest, from flight and vibration in closed form."""
    speed = math.sqrt(-2.0 * PULL * APEX)
    flight = speed / PULL
    contact = 2.0 * (0.5 * math.pi + math.atan(PULL / (speed * OMEGA))) / OMEGA
    since = math.fmod(time + flight, 2.0 * flight + contact)
    if since < 2.0 * flight:
        return np.array([0.5 * PULL * since**2 - speed * since, PULL * since - speed])
    phase, mean = OMEGA * (since - 2.0 * flight), PULL / OMEGA**2
    x = mean * (1.0 - math.cos(phase)) + speed / OMEGA * math.sin(phase)
    return np.array([x, mean * OMEGA * math.sin(phase) + speed * math.cos(phase)])


def fly(scheme: AdaptiveScheme, step: float, phase: float, landing: bool) -> float:
    """Error of the state half-way to the tug after the last that is counted, steps of one size but where they are cut.

    phase     share of a step by which the first is shorter
    landing   steps end on changes; else these are stepped over
    """
    contact = 2.0 * (0.5 * math.pi + math.atan(PULL / (math.sqrt(-2.0 * PULL * APEX) * OMEGA))) / OMEGA
    end = 0.5 + TUGS * (2.0 + contact)
    context, state, out = np.array([0.0 if landing else -1.0]), np.array([APEX, 0.0]), np.zeros(2)
    stages, now = np.zeros(scheme.stages), 0.0

    def attempt(size: float) -> float:
        """The stretch after a step, whose end is then in `out`."""
        if size == 0.0:
            return float(state[0])
        motion(context, state, stages[:2], 0.0)
        scheme.attempt(context, state, size, stages, out)
        return float(out[0])

    while now < end - 1e-13:
        size = min(step * (1.0 - phase) if now == 0.0 else step, end - now)
        there = attempt(size) * (1.0 if context[0] < 0.5 else -1.0)
        changed = landing and there > 0.0
        if changed:
            size = brentq(attempt, 0.0, size, xtol=1e-15, rtol=1e-15)
            attempt(size)
        state, now = out.copy(), now + size
        if changed:
            context[0] = 1.0 - context[0]
    return float(np.linalg.norm(state - exact(now)))


def swing(scheme: AdaptiveScheme, step: float) -> float:
    """Error of the state on a line that stays taut: root of the mean square over two seconds, three swings."""
    context, state, out, stages = np.array([1.0]), np.array([0.0, 1.0]), np.zeros(2), np.zeros(scheme.stages)
    mean, errors = PULL / OMEGA**2, []
    for k in range(1, round(2.0 / step) + 1):
        motion(context, state, stages[:2], 0.0)
        scheme.attempt(context, state, step, stages, out)
        state, phase = out.copy(), OMEGA * k * step
        x = mean * (1.0 - math.cos(phase)) + math.sin(phase) / OMEGA
        errors.append(math.dist(state, (x, mean * OMEGA * math.sin(phase) + math.cos(phase))))
    return math.sqrt(np.mean(np.square(errors)))


def slope(steps: Sequence[float], errors: Sequence[float]) -> float:
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def orders(name: str, phases: int) -> dict[str, float]:
    """Observed orders; errors over changes are roots of mean squares over so many phases of the steps."""
    scheme, steps = MAKE[name](motion, strict, 2), STEPS[name]
    found = {"smooth": slope(steps, [swing(scheme, step) for step in steps])}
    for kind, landing in (("landed on", True), ("stepped over", False)):
        errors = [
            math.sqrt(np.mean([fly(scheme, step, k / phases, landing) ** 2 for k in range(phases)])) for step in steps
        ]
        found[kind] = slope(steps, errors)
    return {kind: round(value, 2) for kind, value in found.items()}


def run(name: str, terms: dict[str, str], parameters: dict[str, Any], duration: float, step: float) -> Instance:
    """An instance after a time, in macro steps."""
    i = Instance(MODEL, {"reel": "locked", "solver": name} | terms)
    for key, value in parameters.items():
        if isinstance(value, tuple):
            i.array(key)[:] = value
        else:
            i[key] = value
    i.initialise()
    while i.time < duration - 1e-6:
        i.step(step)
    return i


def tolerances(factor: float) -> dict[str, float]:
    return {
        "solver.tolerance_orbit": max(1e-9, 1e-7 * factor),
        "solver.tolerance_separation": 1e-10 * factor,
        "solver.tolerance_stretch": 1e-11 * factor,
    }


FIFTH = 4443.443814288451
"""Time of Table 2's fifth undamped tug [s], of the reference in quadruple precision."""


def by_tolerance(name: str) -> dict[str, Any]:
    rows = []
    for factor in (1e4, 1e3, 1e2, 1e1, 1.0):
        i = run(name, {"thrust": "along_track"}, {"tether.damping_ratio": 0.0, **tolerances(factor)}, 4446.0, 4446.0)
        count = int(i["tether.tug_count"])
        error = abs(float(i.array("tug_time")[count - 5]) - FIFTH) if count >= 5 else math.nan
        rows.append({"times_default": factor, "steps": int(i["solver.steps"]), "error_s": float(f"{error:.2e}")})
    far = [row for row in rows if row["error_s"] > 5e-9]  # the reference itself is good to 1e-9 s
    power = slope([row["times_default"] for row in far], [row["error_s"] for row in far])
    return {"rows": rows, "power_of_tolerance": round(power, 2)}


WHIRL = {"start_relative_position": (12.0051, 0.0, 0.0), "start_relative_velocity": (0.005, 0.6, 0.0)}
"""Stretched by 5.1 mm, as whirling at 0.05 rad/s keeps it, the line lengthens at 5 mm/s: it swings by 2 mm, taut."""
FLIGHT = {"start_relative_position": (11.0, 1.0, 0.0), "start_relative_velocity": (0.5, 0.02, 0.0)}


def drift(name: str) -> dict[str, Any]:
    """Energy after a day less that at the start, over that of the vibration or of the flight."""
    found: dict[str, Any] = {}
    free = {"start.condition": HANDED_OVER, "tether.damping_ratio": 0.0}
    for what, start, speed in (("whirling", WHIRL, 0.005), ("from tug to tug", FLIGHT, 0.5)):
        begin = run(name, {"environment": "none"}, free | start, 0.0, 60.0)["energy.relative"]
        i = run(name, {"environment": "none"}, free | start, 86400.0, 60.0)
        change = (i["energy.relative"] - begin) / (0.5 * reduced_mass(2000.0, 1000.0) * speed**2)
        tugs = int(i["tether.tug_count"])
        found[what] = {"per_day": float(f"{change:.1e}"), "steps": int(i["solver.steps"]), "tugs": tugs}
    return found


def hour(name: str, change: dict[str, float]) -> tuple[float, float, int]:
    """Impulse of the line over an hour's tow on a stiff line, processor time and steps."""
    start: dict[str, Any] = {
        "start.condition": HANDED_OVER,
        "start_relative_position": (0.9, 0.2, 0.0),
        "start_relative_velocity": (0.002, 0.0, 0.0),
    }
    line = {"tether.youngs_modulus": 1e12, "tether.rest_length": 1.0, "tether.damping_ratio": 10.0}
    began = time.process_time()
    i = run(name, {"thrust": "along_track"}, line | start | change, 3600.0, 3600.0)
    return i["tether.impulse"], time.process_time() - began, int(i["solver.steps"])


def stiff() -> dict[str, Any]:
    """Of dop853 and radau; the truth is that of gauss, at a tenth of the tolerances."""
    truth, _, _ = hour("gauss", tolerances(0.1))
    rows = []
    for name in ("dop853", "radau"):
        for label, change in (
            ("default", {}),
            ("tolerance_orbit 1e-3 m", {"solver.tolerance_orbit": 1e-3}),
            ("a hundred times the default", tolerances(100.0)),
            ("a hundredth of the separation's and stretch's, tolerance_orbit 1e-5 m",
             {"solver.tolerance_orbit": 1e-5, "solver.tolerance_separation": 1e-12, "solver.tolerance_stretch": 1e-13}),
        ):  # fmt: skip
            best = min((hour(name, change) for _ in range(3)), key=lambda found: found[1])
            error = abs(best[0] / truth - 1.0)
            rows.append({"scheme": name, "tolerances": label, "steps": best[2], "cpu_s": round(best[1], 4),
                         "error_of_mean_tension": float(f"{error:.1e}")})  # fmt: skip
    return {"rows": rows}


def cost(names: Sequence[str]) -> dict[str, Any]:
    """Processor time of a step of a taut line of Table 2, over that of dop853's, where all take the steps they like."""
    found = {}
    hanging = {"start.condition": HANDED_OVER, "start_relative_position": (12.00001, 0.0, 0.0)}
    for name in names:
        best = math.inf
        for _ in range(3):
            began = time.process_time()
            i = run(name, {"thrust": "along_track"}, hanging, 20000.0, 20000.0)
            best = min(best, (time.process_time() - began) / i["solver.steps"])
        found[name] = best
    return {name: round(value / found["dop853"], 2) for name, value in found.items()}


def main() -> dict[str, Any]:
    result: dict[str, Any] = {
        "command": COMMAND,
        "version": {name: version(name) for name in ("dcone-cosim", "numba", "numpy")},
        "cost_of_a_step": {},
        "schemes": {},
    }
    for name in MAKE:
        result["schemes"][name] = {
            "order": orders(name, 24),
            "tolerance": by_tolerance(name),
            "drift": drift(name),
        }
        print(name, json.dumps(result["schemes"][name]), flush=True)
    result["stiff"] = stiff()
    result["cost_of_a_step"] = cost(list(MAKE))
    print(json.dumps(result["stiff"]), json.dumps(result["cost_of_a_step"]))
    RESULT.write_text(json.dumps(result, indent=1) + "\n")
    return result


if __name__ == "__main__":
    main()
