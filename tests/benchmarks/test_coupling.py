"""Error and CPU time of a reel control coupled to the removal, both FMUs: `pytest -m bench -n 0 -s
tests/benchmarks/test_coupling.py`.

Prints the tables of dcone_cosim/coupling/README.md. Reference: the removal with the same law inside, one FMU. With a
motor behind the law there is no such FMU: the reference is the pair at a hundredth of the motor's lag, inputs moving
on.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import numpy as np
import pytest

from dcone_cosim import build
from dcone_cosim.fmu.component import Archive, Component
from tests.cosim.reel_pair import CASES, FEED_FORWARD, LENGTH, pair, whole

pytestmark = pytest.mark.bench
LAG = 5.0
"""Of the motor [s]."""
STEPS = (30.0, 10.0, 3.0, 1.0)
TOLERANCES = (1e-2, 1e-3, 1e-4)
CONTROLLER_FIRST = ("controller", "removal")
FIXED: dict[str, dict[str, Any]] = {
    "Jacobi, held": {"method": "jacobi"},
    "Gauss-Seidel, held": {"method": "gauss_seidel"},
    "Jacobi, linear": {"method": "jacobi", "extrapolation": "linear"},
    "Gauss-Seidel, linear, controller first": {"extrapolation": "linear", "order": CONTROLLER_FIRST},
}
CONTROLLED: dict[str, dict[str, Any]] = {
    "error-controlled, held": {"control": "error"},
    "error-controlled, linear, controller first": {
        "control": "error",
        "extrapolation": "linear",
        "order": CONTROLLER_FIRST,
    },
}


@pytest.fixture(scope="module")
def archives() -> Iterator[dict[str, Archive]]:
    wanted = {
        "commanded": ("tethered_deorbit", {"reel": "commanded"}),
        "linear": ("tethered_deorbit", {"reel": "linear"}),
        "controller": ("reel_control", {}),
        "lagging": ("reel_control", {"motor": "lag"}),
    }
    paths = build.ensure(list(wanted.values()), print)
    with ExitStack() as stack:
        yield {name: stack.enter_context(Archive(path)) for name, path in zip(wanted, paths, strict=True)}


@pytest.mark.parametrize("motor", ["no motor", "motor"])
@pytest.mark.parametrize("case", CASES)
def test_error_against_coupling_step(case: str, motor: str, archives: dict[str, Archive]) -> None:
    def removal(law: str) -> Component:
        return Component(archives[law], "removal")

    def controller() -> Component:
        made = Component(archives["controller" if motor == "no motor" else "lagging"], "controller")
        made.set({"reel.length": LENGTH, "feed_forward": FEED_FORWARD})
        if motor == "motor":
            made.set({"motor.time_constant": LAG})
        return made

    reference = (
        whole(case, removal)
        if motor == "no motor"
        else pair(case, removal, controller, extrapolation="linear", step=LAG / 100.0)
    )
    print(f"\n{case}, {motor}; reference: {reference.cpu:.3f} s CPU\n")
    print("| coupling | step or tolerance | steps | rejected | error of tension [N] | of separation [m] | CPU [s] |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for table, settings, key in ((FIXED, STEPS, "step"), (CONTROLLED, TOLERANCES, "tolerance")):
        for name, coupling in table.items():
            errors = []
            # with held inputs the steps go with the tolerance: a third takes minutes
            for value in settings[: 2 if coupling == {"control": "error"} else None]:
                found = pair(case, removal, controller, **coupling, **{key: value})
                errors.append(found.errors(reference))
                cells = [name, f"{value:g}{' s' if key == 'step' else ''}"]
                cells += [f"{found.statistics[count]:g}" for count in ("steps", "rejected")]
                cells += [*(f"{error:.1e}" for error in errors[-1]), f"{found.cpu:.3f}"]
                print(f"| {' | '.join(cells)} |")
            order = np.polyfit(np.log(settings[: len(errors)]), np.log(errors), 1)[0]
            print(f"| {name}: slope | | | | {order[0]:.2f} | {order[1]:.2f} | |")
