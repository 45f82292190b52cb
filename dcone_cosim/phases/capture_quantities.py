"""By what a capture is judged when it is computed in another way."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from dcone_cosim import build
from dcone_cosim.contract import bullets
from dcone_cosim.quantities import Quantity, at
from dcone_cosim.results import PhaseResult

NAMES = ("mouth_area", "t80", "bullets", "impulse", "captured", "t_capture", "energy_book", "thread_peak")
EACH = (1, 2, 3)


def quantities(result: PhaseResult, parameters: Mapping[str, float], instants: Sequence[float]) -> Iterator[Quantity]:
    """Mouth, bullets, impulse on the target, instant of capture, and the largest tension of a thread."""
    recorder = result.recorder
    if not len(recorder):
        return
    last = recorder.last()
    flat = _flat_area(result)
    if "mouth.area" in recorder:
        curve = at(recorder, "mouth.area", instants)
        yield Quantity("mouth_area", "mouth area over time", curve.tolist(), "m2", flat, "the flat net's area")
    if last.get("mouth.t80", -1.0) >= 0.0:
        yield Quantity("t80", "mouth over 80 % from", [last["mouth.t80"]], "s", resolution=build.LOOKS_EVERY)
    names = [f"bullet[{b}].position[{i}]" for b in bullets(recorder.names) for i in EACH]
    if names:
        places = np.concatenate([at(recorder, name, instants) for name in names])
        side = math.sqrt(flat)
        yield Quantity("bullets", "bullets' positions over time", places.tolist(), "m", side, "the net's side", False)
    if "target.mass" in parameters and "target.velocity[1]" in recorder:
        velocity = recorder.vector("target.velocity")
        impulse = parameters["target.mass"] * float(np.linalg.norm(velocity[-1] - velocity[0]))
        if impulse > 0.0:
            yield Quantity("impulse", "impulse on the target by the end", [impulse], "N.s")
    if "captured" in last and "mouth.girth" in last:
        yield Quantity("captured", "whether it is captured", [float(last["captured"] > 0.0)], "1", 1.0, "1")
        if last.get("t_capture", -1.0) >= 0.0:
            yield Quantity("t_capture", "captured at", [last["t_capture"]], "s", resolution=build.LOOKS_EVERY)
    if "energy.remainder" in recorder and "energy.kinetic" in recorder:
        entered = float(build.energy_entered(recorder)[-1])
        left = [last["energy.remainder"]]
        if entered > 0.0:
            yield Quantity("energy_book", "left over in the energy book", left, "J", entered, "what came in", False)
    if "thread.tension_max" in last:
        yield Quantity("thread_peak", "largest tension of a thread", [last["thread.tension_max"]], "N", meant=False)


def _flat_area(result: PhaseResult) -> float:
    """Area of the flat mouth [m2], or of the largest there was where the FMU does not tell."""
    recorder = result.recorder
    if "mouth.area" not in recorder:
        return 1.0
    area = recorder["mouth.area"]
    widest = int(np.argmax(area))
    if "mouth.area_ratio" in recorder and recorder["mouth.area_ratio"][widest] > 0.0:
        return float(area[widest] / recorder["mouth.area_ratio"][widest])
    return max(float(area[widest]), 1e-12)
