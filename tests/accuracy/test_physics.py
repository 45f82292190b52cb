"""`dcone inspect --measure`: what a term changes and costs, where both are known."""

from __future__ import annotations

import dataclasses

import pytest

from dcone_cosim import build
from dcone_cosim.accuracy import physics
from dcone_cosim.accuracy.physics import Effect, Found, Variant, variants_of
from dcone_cosim.accuracy.plan import Planned, Planner
from dcone_cosim.cases.alone import Alone
from dcone_cosim.loading import load
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.scene_fmus import SceneFmus


@pytest.fixture(scope="module")
def tow() -> Found:
    (found,) = physics.measured("table2-deorbit", ["removal.duration=3 h"], Progress())
    return found


def _effects(tow: Found) -> tuple[Effect, Effect]:
    """As it is, and without thrust."""
    here, without = tow.effects[:2]
    assert (here.label, without.label) == ("as it is", "without thrust")
    return here, without


@pytest.mark.evidence
def test_thrust_lowers_the_orbit_and_nothing_else_does(tow: Found) -> None:
    """Without it the semi-major axis keeps all of the change that it has with it, but for the pair's own motion."""
    here, without = _effects(tow)
    assert {"with burn: timed", "with engine: electric", "with air", "with electrodynamic", "with level"} <= {
        effect.label for effect in tow.effects
    }
    assert here.change == 0.0
    assert without.quantity
    assert without.change > 0.9


@pytest.mark.evidence
def test_what_is_left_out_is_not_there(tow: Found) -> None:
    here, without = _effects(tow)
    assert without.bytes < here.bytes - 1000
    # its two parameters, the input and its output of propellant
    assert here.variables - without.variables == 4
    assert without.memory < here.memory
    # what a substep takes, by the steps that the solver counts itself
    for effect, settings in ((here, ()), (without, ("thrust",))):
        scene = Alone("table2-deorbit", ["removal.duration=3 h"], None).scene_of("removal", (), settings)
        with SceneFmus(scene, Progress()) as fmus:
            last = run_scene(scene, fmus.instantiate, Progress()).phases["removal"].recorder.last()
        assert effect.per_step * last["solver.steps"] == pytest.approx(effect.cpu, rel=1e-3)
    assert without.cpu < 1.1 * here.cpu


def test_every_term_of_a_scene_is_tried() -> None:
    found = {v.label: v for v in variants_of(load("mission").phases[0])}
    assert found["without target, and so without contact"].without == ("target", "contact")
    assert found["gravity = none"].changes == ('capture.gravity.law="none"',)
    assert {"without contact", "without closing", "without tether", "without nodes"} <= found.keys()
    assert found["with settling: speed"] == Variant("with settling: speed", ('capture.settling.by="speed"',))
    assert not any("solver" in label or "precision" in label for label in found)  # they change no physics


@pytest.mark.parametrize("scene", ["mission", "edt", "pull-off"])
def test_no_part_is_forgotten(scene: str) -> None:
    """Each group that may be left out is there once, with or without; what only adds to the results is not added."""
    phase = load(scene).phases[0]
    groups = build.CATALOGUE[phase.main.model].groups
    optional = {name for name, group in groups.items() if group.optional and not group.early}
    recorded = {name for name in build.FAMILIES if name not in phase.main.terms}
    tried = [v.label.replace(",", "").replace(":", "").split()[1] for v in variants_of(phase) if "=" not in v.label]
    assert sorted(tried) == sorted(optional - recorded)


def test_a_phase_goes_without_what_the_one_after_it_needs() -> None:
    """And keeps what that one tells of it: the length of their one line."""
    alone = Alone("mission", ['capture.closing.drive="winches"'], None)
    own = alone.scene_of("capture", (), ("target", "contact")).phases[0]
    assert "target" not in own.main.terms
    assert own.main.parameters["tether.length"] == 14.0
    assert own.options.after_capture == 0.0


def test_a_variant_that_would_take_too_long_is_left_out_with_its_estimate() -> None:
    """Ten hours of Table 2 against a bound of a millisecond, and against one of a minute."""
    alone = Alone("table2-deorbit", ["removal.duration=10 h"], None)
    alone.begin(Progress())
    planned = Planned(physics.AS_IT_IS)
    (case,) = Planner(alone, "removal", Progress()).cases(planned, 1).values()
    told = {field.name: getattr(case, field.name) for field in dataclasses.fields(case)}
    row = physics.measure_within(physics.Bounded(**told, most=1e-3))
    assert not row.succeeded
    assert row.message.startswith("left out: it would take about ")
    row = physics.measure_within(physics.Bounded(**told, most=60.0))
    assert row.succeeded
    assert row.samples
