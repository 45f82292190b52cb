"""Planar, pyramidal and conical nets for a debris of 2 m side by side, with and without damping, with nothing to catch.

    python -m tests.net_capture.evidence.shapes

flies the nets of the scenes `planar-2m`, `pyramidal-2m` and `conical-2m`, folded and shot as there, eight times
each, and prints the table of the model's page.
"""

from __future__ import annotations

import numpy as np

from dcone_cosim.loading import load
from fmu_src.instance import Instance
from fmu_src.net_capture.implied import rows
from fmu_src.net_capture.interface import MODEL

SCENES = ("planar-2m", "pyramidal-2m", "conical-2m")
WITHOUT = ("target", "contact", "closing", "nodes")
SHOTS = 8
SPAN, STEP = 8.0, 0.02
OPEN = 0.8
"""Share of what the open net holds above which it counts as open."""


def flight(terms, values, seed, damping):
    """Mouth area [m2] and volume [m3] at all steps."""
    given = values | {"net.damping_ratio": damping, "solver.seed": seed, "solver.jitter[3]": 1e-6}
    net = Instance(MODEL, terms | {"volume": "plain"}, given).initialise()
    found = []
    for _ in range(round(SPAN / STEP)):
        net.step(STEP)
        found.append((net["mouth.area_ratio"], net["net.volume"]))
    return np.array(found)


def row(scene, damping):
    """Figures of one net, each the mean over the shots."""
    (phase,) = load(scene).phases
    terms = {name: term for name, term in phase.main.terms.items() if name not in WITHOUT}
    names = {name for v in MODEL.interface(terms).variables for name in v.element_names()}
    values = {name: value for name, value in phase.main.parameters.items() if name in names}
    told = {one.key: one.value for one in rows({**phase.main.defaults, **phase.main.parameters}, phase.main.terms)}
    shots = [flight(terms, values, seed, damping) for seed in range(SHOTS)]
    first = [STEP * (np.argmax(s[:, 0] > OPEN) + 1) for s in shots]
    times = [STEP * (s[:, 0] > OPEN).sum() for s in shots]
    area, volume = [s[:, 0].max() for s in shots], [s[:, 1].max() for s in shots]
    full = [STEP * (s[:, 1] > OPEN * s[:, 1].max()).sum() for s in shots]
    means = [float(np.mean(one)) for one in (first, area, times, volume, full)]
    return values["net.mass"], 1e3 * told["canister.volume"], *means


def main() -> None:
    heads = ("net", "damping ratio", "mass", "stowed", "mouth 80 % open at", "largest mouth", "80 % open for")
    print("|", *(f"{head} |" for head in (*heads, "largest volume", "80 % of it for")))
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for scene in SCENES:
        for damping in (0.106, 0.0):
            mass, stowed, first, area, times, volume, full = row(scene, damping)
            since = f"{first:.2f} s" if times > 0.0 else "never"
            print(
                f"| `{scene}` | {damping:g} | {mass:.3f} kg | {stowed:.2g} l | {since} | {100 * area:.0f} % | "
                f"{times:.2f} s | {volume:.1f} m3 | {full:.2f} s |"
            )


if __name__ == "__main__":
    main()
