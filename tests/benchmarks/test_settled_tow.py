"""A damped day of Table 2, its vibration followed and stepped over: `pytest -m bench -n 0 -s` with this file."""

import time

import pytest

from fmu_src.catalogue import MODELS
from fmu_src.instance import Instance

pytestmark = pytest.mark.bench
REMOVAL = {"reel": "locked", "thrust": "along_track"}
TABLE_2 = {"thrust.level": -0.01, "start.separation": 10.0}


@pytest.mark.parametrize(("days", "macro_step"), [(1.0, 60.0), (1.0, 600.0), (1.0, 86400.0), (30.0, 86400.0)])
def test_a_tow_that_settles_beside_one_that_is_followed(benchmark, days, macro_step):
    """Ratio of CPU times, taken in turns; a macro step by itself costs 11 us of Python in this process."""

    def tow(terms):
        i = Instance(MODELS["tethered_deorbit"], terms, TABLE_2).initialise()
        began = time.process_time()
        while i.time < days * 86400.0:
            i.step(macro_step)
        return time.process_time() - began, i["solver.steps"]

    pairs = [(tow(REMOVAL), tow(REMOVAL | {"level": "settled"})) for _ in range(3)]
    followed, settled = (min(taken) for taken in zip(*pairs, strict=True))
    benchmark.extra_info["ratio"] = followed[0] / settled[0]
    benchmark.pedantic(lambda: tow(REMOVAL | {"level": "settled"}), rounds=1)
    print(f"{days:g} days in macro steps of {macro_step:g} s: {followed[0]:.4f} s, {followed[1]:g} steps; settled "
          f"{settled[0]:.4f} s, {settled[1]:g} steps; ratio {followed[0] / settled[0]:.1f}")  # fmt: skip
