"""The same catch under both laws of contact: quality of the capture, impulse on the target, loss.

    python -m tests.net_capture.evidence.laws [HOW_MANY]

makes `laws.json` again, 0.6 CPU-s a pair on one core; what there is is stored every 20 pairs. Table 1's scene at a mesh
of 2 m, starts jittered by 1 mm; of each start one shot under law A with a restitution, and one under law B without
friction, whose damping ratio gives the same restitution in closed form. The impulse is what the target has taken in
all, m |v|: in the end, where it scatters by a fifth from start to start as the net swings about the target; in the mean
of the last two seconds (`held`), over which that comes to little; and two seconds after the first touch (`early`), when
all folds are still alike. The quality index is that of the literature,

    J = 0.1 |V_n - V_t|/V_t + 0.1 |S_n - S_t|/S_t + 0.8 |q|/L

of the hull of all nodes and of the target, q from the target's centre to the net's centre of mass, L the target's
longest edge; a second before the end, when the mouth is closed.
"""

from __future__ import annotations

import json
import math
import sys
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.spatial import ConvexHull

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from orbital.oscillators import snap_restitution
from tests import kernels
from tests.conftest import CAPTURE
from tests.net_capture.memory import shown

RESULT = Path(__file__).with_name("laws.json")
COMMAND = "python -m tests.net_capture.evidence.laws"
SHOTS = 160
EVERY = 20
"""Pairs after which what there is is stored."""
RESTITUTION = 0.5
END, HELD, EARLY, STEP = 18.0, 2.0, 12.0, 0.1
"""End of a shot, the last seconds of which the mean is told, an instant two seconds after the first touch, and time
between two looks [s]."""
LAWS = ("inelastic", "penalty")
JUDGED = ("quality", "impulse", "held", "early")
TOLD = ("contact.impulse", "contact.loss", "thread.tension_max", "t_capture", "energy.remainder", "closing.work")
COMMON = {"net.mesh": 2.0, "closing.time": 11.2, "target.start_rate[1]": 0.02, "target.start_rate[3]": 0.03}


def damping_ratio(restitution: float) -> float:
    """Of a contact that gives this share of the speed back."""
    return float(brentq(lambda zeta: snap_restitution(zeta) - restitution, 1e-9, 1.0 - 1e-9))


def quality(net: Instance) -> float:
    """The capture quality index [1]."""
    hull, edges = ConvexHull(shown(net)), net.array("target_size")
    volume, surface = edges.prod(), 2.0 * (edges.prod() / edges).sum()
    away = np.linalg.norm(net.array("catch_position") - net.array("target_position")) / edges.max()
    return float(0.1 * abs(hull.volume - volume) / volume + 0.1 * abs(hull.area - surface) / surface + 0.8 * away)


def values(law: str, seed: int) -> dict[str, float]:
    """Parameters of a shot."""
    own = {"contact.restitution": RESTITUTION}
    if law == "penalty":
        own = {"contact.damping_ratio": damping_ratio(RESTITUTION), "contact.friction": 0.0}
    return COMMON | own | {f"solver.jitter[{i}]": 1e-3 for i in (1, 2, 3)} | {"solver.seed": seed}


def shoot(seed: int) -> list[dict[str, Any]]:
    """A shot under each law, from the same start."""
    shots = []
    for law in LAWS:
        net = Instance(MODEL, CAPTURE | {"contact": law}, values(law, seed)).initialise()
        index, taken = math.nan, []
        for look in range(1, round(END / STEP) + 1):
            net.step(STEP)
            taken.append(float(net["target.mass"] * np.linalg.norm(net.array("target_velocity"))))
            if look == round((END - 1.0) / STEP):
                index = quality(net)
        shots.append({"law": law, "seed": seed, "quality": index, "impulse": taken[-1]})
        shots[-1] |= {"held": float(np.mean(taken[-round(HELD / STEP) :])), "early": taken[round(EARLY / STEP) - 1]}
        shots[-1] |= {name: float(net[name]) for name in TOLD}
    return shots


def rounded(value: Any) -> Any:
    """To seven digits."""
    return float(f"{value:.7g}") if isinstance(value, float) else value


def compared(shots: list[dict[str, Any]], name: str) -> dict[str, float]:
    """Means under both laws, standard deviations, difference of the means over the first, its standard error."""
    a, b = (np.array([rounded(shot[name]) for shot in shots if shot["law"] == law]) for law in LAWS)
    error = math.sqrt(a.var(ddof=1) / len(a) + b.var(ddof=1) / len(b)) / abs(a.mean())
    found = {"a": a.mean(), "b": b.mean(), "spread": a.std(ddof=1), "spread_b": b.std(ddof=1)}
    found |= {"apart": b.mean() / a.mean() - 1.0, "error": error}
    return {key: rounded(float(value)) for key, value in found.items()}


def stored() -> list[dict[str, Any]]:
    """The shots of `laws.json`."""
    told = json.loads(RESULT.read_text(encoding="utf-8"))
    return [dict(zip(told["columns"], row, strict=True)) for row in told["shots"]]


def store(shots: list[dict[str, Any]]) -> None:
    """What has been flown so far, a shot a line, in seven digits."""
    told = {
        "command": COMMAND,
        "version": {name: version(name) for name in ("dcone-cosim", "numba", "numpy")},
        "restitution": RESTITUTION,
        "end": END,
        "pairs": len(shots) // 2,
        "compared": {name: compared(shots, name) for name in (*JUDGED, *TOLD)},
        "columns": list(shots[0]),
    }
    lines = ",\n".join(json.dumps([rounded(value) for value in shot.values()]) for shot in shots)
    head = json.dumps(told, indent=1).removesuffix("\n}")
    RESULT.write_text(f'{head},\n "shots": [\n{lines}\n]}}\n', encoding="utf-8")


def main(arguments: list[str]) -> None:
    number = int(arguments[0]) if arguments else SHOTS
    shots: list[dict[str, Any]] = []
    for seed in range(1, number + 1):
        shots += shoot(seed)
        if seed % EVERY == 0 or seed == number:
            store(shots)
            print(seed, *(f"{name} {compared(shots, name)}" for name in JUDGED), flush=True)


if __name__ == "__main__":
    kernels.alone()
    main(sys.argv[1:])
