"""Error against run time of what a user can trade: `pytest -m bench -n 0 -s
tests/benchmarks/test_error_against_time.py`.

Prints the tables of tests/README.md. Reference of each row: the finest setting of the same table.
"""

import time

import pytest

from fmu_src.catalogue import MODELS
from fmu_src.instance import Instance
from tests.conftest import FREE

pytestmark = pytest.mark.bench
RATIOS = (0.0, 0.9, 0.5, 0.25, 0.1, 0.05)
"""Shares of the stability bound; zero: the default, which follows the damping."""
LOOSER = (1e6, 1e4, 1e2, 1.0, 1e-1)


def timed(model, terms, parameters, measure):
    instance = Instance(MODELS[model], terms, parameters).initialise()
    began = time.process_time()
    result = measure(instance)
    return result, time.process_time() - began


@pytest.mark.parametrize("damping", [0.106, 0.0])
def test_net_step_against_error(damping):
    """Mouth area and the energy book's remainder at 8 s, by the substep."""

    def opened(net):
        net.step(8.0)
        return net["mouth.area"], net["energy.remainder"], net["solver.substep"]

    timed("net_capture", FREE, {}, lambda net: net.step(0.1))
    rows = []
    for ratio in RATIOS:
        change = {"solver.step_ratio": ratio, "net.damping_ratio": damping}
        rows.append((ratio, *timed("net_capture", FREE, change, opened)))
    finest = rows[-1][1][0]
    print(f"\n| step_ratio, damping ratio {damping:g} | substep [s] | CPU [s] | error of the mouth area | remainder |")
    print("| --- | --- | --- | --- | --- |")
    for ratio, (area, remainder, substep), taken in rows:
        error = "(reference)" if ratio == RATIOS[-1] else f"{abs(area / finest - 1.0):.0e}"
        print(
            f"| {ratio or 'default'} | {substep:.1e} | {taken:.2f} | {error} | {100.0 * abs(remainder) / 9.0:.2g} % |"
        )


def test_removal_tolerance_against_error():
    """Time and peak of the fifth tug of Table 2 and the CPU time of a day, by the solver's tolerances."""
    terms = {"reel": "locked", "thrust": "along_track"}
    base = {"thrust.level": -0.01, "start.separation": 10.0, "tether.damping_ratio": 0.05}
    rows = MODELS["tethered_deorbit"].interface(terms).scalars()
    defaults = {n: start for n, _, v, start in rows if v.causality == "parameter" and n.startswith("solver.tolerance")}

    def fifth(pair):
        pair.step(4050.0)
        found = pair["tug[1].time"], pair["tug[1].peak"], pair["tether.tug_count"]
        pair.step(86400.0 - 4050.0)
        return found

    timed("tethered_deorbit", terms, base, fifth)
    rows = []
    for factor in LOOSER:
        scaled = {name: start * factor for name, start in defaults.items()}
        found, taken = timed("tethered_deorbit", terms, base | scaled, fifth)
        rows.append((factor, taken, *found))
    print("\n| tolerances x | CPU per day [s] | error of the fifth tug's time [s] | of its peak |")
    print("| --- | --- | --- | --- |")
    for factor, taken, when, peak, count in rows:
        same = count == rows[-1][4]
        time_error = f"{abs(when - rows[-1][2]):.1e}" if same else f"{count} tugs, not {rows[-1][4]}"
        peak_error = f"{abs(peak / rows[-1][3] - 1.0):.1e}" if same else "-"
        print(f"| {factor:g} | {taken:.3f} | {time_error} | {peak_error} |")
