"""The required line is a fixed point: its own peak, not that of another line, is what it bears.

By hand: a run of the scene with a line of that diameter, by the master alone, and the strength that it then has.
"""

from __future__ import annotations

import math

import pytest

from dcone_cosim.cases.alone import Alone
from dcone_cosim.cases.runner import Memory, Runner
from dcone_cosim.cases.workers import Workers
from dcone_cosim.loading import load
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.scene_fmus import SceneFmus
from dcone_cosim.sizing import required, work
from dcone_cosim.sizing.ground import Ground
from dcone_cosim.sizing.result import Sizing
from dcone_cosim.sizing.study import held
from orbital.materials import MATERIALS
from tests.sizing.conftest import SHORT

SAFETY = 2.5
TECHNORA = MATERIALS["Technora"]


HARD = (
    *("removal.duration=10 min", "removal.macro_step=5 s", "removal.thrust.level=-50 N"),
    *("removal.start.condition='equal_velocity'", "removal.tether.diameter=3 mm"),
)
"""A burn that draws the line taut at half a metre per second; the scene's own line is thicker than it has to be."""


def tugs_with(diameter: float, modulus: float, settings: tuple[str, ...] = HARD) -> list[tuple[float, float, float]]:
    """Tugs of the scene with a line of that diameter [m] and stiffness [Pa], without any of the sizing."""
    line = [f"removal.tether.diameter={diameter!r} m", f"removal.tether.youngs_modulus={modulus!r} Pa"]
    scene = load("table2-deorbit", [*settings, *line])
    with SceneFmus(scene, Progress()) as fmus:
        log = run_scene(scene, fmus.instantiate, Progress()).phases["removal"].tugs
    assert log is not None
    return list(log.rows.values())


@pytest.fixture(scope="module")
def sought() -> required.Search:
    ground = Ground(Alone("table2-deorbit", HARD, None), Progress())
    with Workers(1) as workers:
        ground.runner = Runner(Memory(), workers, 2, work.run)
        (found,) = required.search(ground, [(TECHNORA, 2e-4)], [{}], SAFETY)
    return found


def test_the_line_bears_its_own_peak(sought: required.Search) -> None:
    assert sought.thick is not None
    diameter = sought.thick[0]
    peak = max(peak for _, peak, _ in tugs_with(diameter, TECHNORA.youngs_modulus))
    assert TECHNORA.strength is not None
    strength = TECHNORA.strength * math.pi * diameter**2 / 4.0
    assert strength / (SAFETY * peak) == pytest.approx(1.0, abs=0.01)
    assert strength >= SAFETY * peak, "it is the thick end that is told"
    thinner = 0.99 * diameter
    peak = max(peak for _, peak, _ in tugs_with(thinner, TECHNORA.youngs_modulus))
    assert TECHNORA.strength * math.pi * thinner**2 / 4.0 < SAFETY * peak, "and none much thinner would do"


def test_a_fixed_peak_would_be_wrong(sought: required.Search) -> None:
    """The peak of the scene's own line asks for another diameter by far, and that one would be far off its own need."""
    assert sought.thick is not None
    assert TECHNORA.strength is not None
    peak = max(peak for _, peak, _ in tugs_with(3e-3, 60e9))
    wrong = math.sqrt(4.0 * SAFETY * peak / (math.pi * TECHNORA.strength))
    assert not 0.8 < wrong / sought.thick[0] < 1.25
    own = max(peak for _, peak, _ in tugs_with(wrong, TECHNORA.youngs_modulus))
    assert not 0.8 < own / peak < 1.25


def test_closed_form_by_hand(done: Sizing, sought: required.Search) -> None:
    """A = F^2 g^2 v^2 E m/(l sigma^2) + 2 F P/sigma at the speed of the hardest tug, P the pull of the thrust."""
    assert sought.thick is not None
    assert TECHNORA.strength is not None
    zeta = 0.05
    turn = (3.0 * math.acos(zeta) - math.pi) / math.sqrt(1.0 - zeta**2)
    _, _, speed = max(tugs_with(sought.thick[0], TECHNORA.youngs_modulus), key=lambda tug: tug[1])
    pull = SAFETY * math.exp(-zeta * turn) * speed / TECHNORA.strength
    area = pull**2 * TECHNORA.youngs_modulus * (2000.0 / 3.0) / 12.0 + 2.0 * SAFETY * (50.0 / 3.0) / TECHNORA.strength
    assert math.sqrt(4.0 * area / math.pi) == pytest.approx(sought.thick[0], rel=0.01)
    rows = done["required"].set_index("material")
    assert rows.diameter["Technora yarn"] >= rows.closed["Technora yarn"] * 0.9
    assert (rows.wrong_from_peak / rows.diameter).min() > 1.25


def test_tugs_are_the_analytic_snap(done: Sizing) -> None:
    """v sqrt(k m_r) exp(-zeta (3 acos zeta - pi)/sqrt(1 - zeta^2)) at the speed of impact, within half a per cent."""
    stiffness, zeta = 60e9 * math.pi * 1e-6 / 4.0 / 12.0, 0.05
    share = math.exp(-zeta * (3.0 * math.acos(zeta) - math.pi) / math.sqrt(1.0 - zeta**2))
    hard = [tug for tug in tugs_with(1e-3, 60e9, SHORT) if tug[1] > 5.0]
    assert len(hard) >= 6
    for _, peak, speed in hard[:4]:
        assert peak == pytest.approx(speed * math.sqrt(stiffness * 2000.0 / 3.0) * share, rel=5e-3)
    assert done.study is not None
    told = held(done.study.ground, done.study.nominal)
    assert len(told) >= len(hard)
    for one in told:
        assert one.difference == pytest.approx(0.0, abs=5e-4), "with the preload at its own angle"


def test_search_of_a_known_law() -> None:
    """A peak that grows as the diameter to the power 1.5: the fixed point is known."""
    one = required.Search(TECHNORA, [{}], 1e-4)
    assert TECHNORA.strength is not None
    expected = (4.0 * SAFETY * 1e8 / (math.pi * TECHNORA.strength)) ** 2
    while not one.done:
        diameter = one.next()
        one.take(diameter, 1e8 * diameter**1.5, SAFETY)
        assert len(one.tried) < required.ROUNDS
    assert one.thick is not None
    assert expected <= one.thick[0] <= expected * (1.0 + 2.0 * required.CLOSE)


def test_search_across_a_jump() -> None:
    """A peak that doubles at a diameter: the line is the least that bears what it then gets, and the jump is told."""
    one = required.Search(TECHNORA, [{}], 1e-4)
    assert TECHNORA.strength is not None
    edge = 1.7e-4
    while not one.done:
        diameter = one.next()
        capacity = TECHNORA.strength * math.pi * diameter**2 / 4.0
        one.take(diameter, capacity / SAFETY * (1.3 if diameter < edge else 0.8), SAFETY)
        assert len(one.tried) <= required.ROUNDS
    found = required.result(one, None, 1e-4, 12.0, SAFETY)
    assert edge <= found.diameter <= edge * (1.0 + required.CLOSE)
    assert "jumps" in found.note
