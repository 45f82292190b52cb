"""A line of lumped nodes without a field: what is conserved, the massless limit, its spectrum, how it starts."""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest

from fmu_src.tethered_deorbit import implied
from fmu_src.tethered_deorbit.interface import MODEL
from fmu_src.tethered_deorbit.layout import WIDTH
from fmu_src.tethered_deorbit.model import make_entry
from fmu_src.tethered_deorbit.node_rows import AS_NODE, AS_PAIR, NOT_WITH
from fmu_src.tethered_deorbit.nodes import pieces
from fmu_src.tethered_deorbit.nodes.cost import NAMES, cost
from tests.plain import PlainInstance, plain
from tests.tethered_deorbit import lumped as pair
from tests.tethered_deorbit.lumped import Floats, apart, lumped
from tests.validation import Validated, closed_form

__all__ = ["plain"]

pytestmark = pytest.mark.usefixtures("plain")
HEAVY = 60e3
"""Density [kg/m3] of a line that weighs 0.57 kg: soft, heavy pieces need few steps."""
FIRM = pair.AXIAL / pair.LENGTH
"""Stiffness of the whole line [N/m]."""


def test_momentum_and_energy() -> None:
    """A slack line that tumbles goes taut: both momenta stay to 1e-12, energy and heat make what there was to 2e-7."""
    values = {"tether.damping_ratio": 0.2, "lumped.damped_as": AS_NODE, "start_center_velocity": (0.1, 0.0, 0.0)}
    i = lumped(2, HEAVY, values | apart(11.8, 0.3, 0.6, 0.1))
    linear, angular = pair.momenta(i)
    energy = i["energy.relative"]
    i.step(1.5)
    assert i["tether.tug_count"] == 1
    assert i["tug[1].peak"] > 2.0
    after, turned = pair.momenta(i)
    assert np.abs(after - linear).max() <= 1e-12 * np.abs(linear).max()
    assert np.abs(turned - angular).max() <= 1e-12 * np.abs(angular).max()
    assert i["lumped.heat"] > 1e-3 * energy
    assert i["energy.relative"] + i["lumped.heat"] == pytest.approx(energy, rel=2e-7)


def test_a_light_node_is_the_massless_line(validated: Validated) -> None:
    """A snap from a line just taut: what the peak is off goes as the mass of the node, and is nothing without it."""
    expected = 0.1 * math.sqrt(FIRM * pair.REDUCED)
    heavy, light = (snap(density) / expected - 1.0 for density in (0.5 * HEAVY, 0.1 * HEAVY))
    assert heavy == pytest.approx(5.0 * light, rel=0.05)
    assert light > 2e-4
    what = "one light node: peak of a snap, extrapolated to no mass"
    limit = (1.0 + light - (heavy - light) / 4.0) * expected
    validated(closed_form("v sqrt(k m_r)"), what, limit, expected, "N", rel=1e-4)


def snap(density: float) -> float:
    """Peak of a pair that parts at 0.1 m/s on a line just taut, undamped [N]."""
    i = lumped(1, density, apart(pair.LENGTH, 0.0, 0.1, 0.0))
    i.step(2.5)
    assert i["tether.tug_count"] == 1
    return i["tug[1].peak"]


def test_macro_steps_change_nothing() -> None:
    values = {"tether.damping_ratio": 0.1, "lumped.damped_as": AS_NODE} | apart(11.9, 0.2, 0.5, 0.0)
    one, many = lumped(2, HEAVY, values), lumped(2, HEAVY, values)
    one.step(0.375)
    for _ in range(3):
        many.step(0.125)
    assert one["tether.taut"]
    assert np.array_equal(pair.state_of(one), pair.state_of(many))


def accelerations(i: PlainInstance, places: Floats) -> Floats:
    """Of nodes [m/s2] at places from the target [m] (N, 3), all at rest, by the model's own kernels."""
    where, kernels = pair.layout(), pair.kernels()
    state, rate = np.array(pair.state_of(i)), np.zeros(pair.layout().size)
    rows = state[where.reel : where.reel + WIDTH * len(places)].reshape(-1, WIDTH)
    rows[:, :3], rows[:, 3:] = places, 0.0
    state[9:12] = 0.0
    kernels.reel.see(i.record, state)
    kernels.reel.drive(i.record, state, rate, 0.0, 0.0, 0.0, 0.0)
    found: Floats = rate[where.reel : where.reel + WIDTH * len(places)].reshape(-1, WIDTH)[:, 3:].copy()
    return found


def frequencies(i: PlainInstance, axis: int) -> Floats:
    """Of the small motion of the nodes along one axis about a straight line, the bodies being heavy [rad/s]."""
    places, _ = pair.nodes_of(i)
    matrix = np.empty((len(places), len(places)))
    for k in range(len(places)):
        moved = np.zeros_like(places)
        moved[k, axis] = 1e-5
        matrix[:, k] = (accelerations(i, places + moved) - accelerations(i, places - moved))[:, axis] / 2e-5
    found: Floats = np.sort(np.sqrt(-np.linalg.eigvals(matrix).real))
    return found


STRETCH = 1.01
"""Of a line that is tight between two bodies of 1e6 kg."""


def tight(count: int, density: float = 1440.0, values: Mapping[str, Any] = MappingProxyType({})) -> PlainInstance:
    heavy = {"chaser.mass": 1e6, "target.mass": 1e6}
    return lumped(count, density, heavy | dict(values) | apart(STRETCH * pair.LENGTH, 0.0, 0.0, 0.0))


def test_first_frequencies_and_wave_speed(validated: Validated) -> None:
    """Ten nodes: the first axial and transverse frequencies, and the speed of waves that follows, to 1 %."""
    i, linear = tight(10), 1440.0 * pair.SECTION
    speed = math.sqrt(pair.AXIAL / linear)
    tension = pair.AXIAL * (STRETCH - 1.0)
    assert i["tether.tension"] == pytest.approx(tension, rel=1e-9)
    axial, across = frequencies(i, 1)[0] / math.tau, frequencies(i, 0)[0] / math.tau
    validated(
        closed_form("sqrt(EA/rho_l)/2L"),
        "ten nodes: first axial frequency",
        axial,
        speed / (2.0 * pair.LENGTH),
        "Hz",
        rel=1e-2,
    )
    string = math.sqrt(tension / (linear / STRETCH)) / (2.0 * STRETCH * pair.LENGTH)
    validated(closed_form("sqrt(T/rho_l)/2L"), "ten nodes: first transverse frequency", across, string, "Hz", rel=1e-2)
    what = "ten nodes: speed of the longest wave, 2 L f"
    validated(closed_form("sqrt(EA/rho_l)"), what, 2.0 * pair.LENGTH * axial, speed, "m/s", rel=1e-2)


@pytest.mark.parametrize("count", [1, 2, 7])
def test_the_step_is_bounded_by_the_spectrum(count: int) -> None:
    """A bound that is never below the fastest motion, and hardly above that of many nodes."""
    i = tight(count)
    fastest = frequencies(i, 1)[-1]
    bound, share = pieces.fastest(i.record, i.record[0].state_piece_length)
    assert fastest * (1.0 - 1e-6) <= bound <= 1.16 * fastest
    assert share == 0.0
    assert i.record[0].state_nodes_reach == pytest.approx(1.0 / bound)


def test_a_line_of_nodes_has_the_dashpot_of_one_piece() -> None:
    """Pieces in series: together the dashpot of the pair; by a node that of a node between two pieces."""
    i = lumped(5, HEAVY, {"tether.damping_ratio": 0.3} | apart(11.0, 0.0, 0.0, 0.0))
    r = i.record[0]
    assert r.state_piece_lag * FIRM == pytest.approx(2.0 * 0.3 * math.sqrt(FIRM * pair.REDUCED))
    own = {"tether.damping_ratio": 0.3, "lumped.damped_as": AS_NODE}
    r = lumped(5, HEAVY, own | apart(11.0, 0.0, 0.0, 0.0)).record[0]
    assert r.state_piece_lag * r.state_piece_stiffness == pytest.approx(
        0.3 * math.sqrt(2.0 * r.state_piece_stiffness * r.state_node_mass)
    )
    assert AS_PAIR == 0


def test_a_node_between_two_pieces_decays_by_the_ratio() -> None:
    """One node of a taut line between two heavy bodies, 1 cm beside its place: after a vibration it has exp(-zeta w t)
    of that left, w = sqrt(2 k/m)."""
    zeta, aside = 0.1, 0.01
    i = tight(1, HEAVY, {"tether.damping_ratio": zeta, "lumped.damped_as": AS_NODE})
    r = i.record[0]
    start, _ = pair.nodes_of(i)
    pair.put_nodes(i, start + np.array([0.0, aside, 0.0]))
    rate = math.sqrt(2.0 * r.state_piece_stiffness / r.state_node_mass)
    period = math.tau / (rate * math.sqrt(1.0 - zeta**2))
    i.step(period)
    left = (pair.nodes_of(i)[0] - start)[0, 1] / aside
    assert left == pytest.approx(math.exp(-zeta * rate * period), rel=1e-4)


@pytest.mark.parametrize("chord", [3.0, 11.999])
def test_a_slack_start_is_an_arc_of_unloaded_pieces(chord: float) -> None:
    """All pieces as long as unloaded, equal angles between them, in the plane of axes 1 and 2."""
    i = lumped(6, HEAVY, apart(chord, 0.0, 0.0, 0.0))
    places, _ = pair.nodes_of(i)
    along = np.diff(np.vstack([[0.0, -chord, 0.0], places, np.zeros(3)]), axis=0)
    lengths = np.linalg.norm(along, axis=1)
    assert lengths == pytest.approx(np.full(7, pair.LENGTH / 7.0), rel=1e-9)
    bends = np.arccos(np.einsum("ij,ij->i", along[1:], along[:-1]) / (lengths[1:] * lengths[:-1]))
    assert bends == pytest.approx(np.full(6, bends[0]), rel=1e-5)
    assert np.all(places[:, 2] == 0.0)
    assert np.all(places[:, 0] > 0.0)
    assert i["lumped.deflection"] == pytest.approx(places[:, 0].max(), rel=1e-9)
    assert i["tether.tension"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("count", [1, 6, 10])
def test_no_piece_of_a_slack_start_pulls(count: int) -> None:
    """Not even by rounding, so that none is told as the hardest."""
    for share in (0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.9999, 1.0 - 1e-9):
        i = lumped(count, 1440.0, {"tether.youngs_modulus": 60e9} | apart(share * pair.LENGTH, 0.0, 0.0, 0.0))
        told = [i[name] for name in ("lumped.most_tension", "lumped.most_piece", "lumped.target_tension")]
        assert told == [0.0, 0, 0.0], share


def test_a_taut_start_is_straight_and_turns_with_the_line() -> None:
    i = lumped(3, HEAVY, apart(12.5, 0.4, 0.2, 0.0))
    places, rates = pair.nodes_of(i)
    shares = np.array([0.75, 0.5, 0.25])
    assert places == pytest.approx(np.outer(shares, [0.0, -12.5, 0.0]))
    assert rates == pytest.approx(np.outer(shares, [-0.4, -0.2, 0.0]))
    assert i["tether.tension"] == pytest.approx(pair.AXIAL * 0.5 / 12.0)
    assert i["lumped.target_tension"] == pytest.approx(i["tether.tension"])
    assert i["lumped.length"] == pytest.approx(12.5)


def test_what_holds_the_line_gives_way_in_series(validated: Validated) -> None:
    """A compliance C at the target: the pull that a steady stretch of the last piece makes, and the toe of its rope."""
    values = {"lumped.end_compliance": 0.2, "lumped.toe_strain": 0.02}
    i = lumped(1, HEAVY, values | apart(12.5, 0.0, 0.0, 0.0))
    expected = 0.25 / (6.0 / pair.AXIAL + 0.2) * (1.0 - 0.06 / 0.25)
    what = "last piece in series with a net of 0.2 m/N, a toe of 2 %: pull at 0.25 m"
    validated(closed_form("(x - t/2)/(l/EA + C)"), what, i["lumped.target_tension"], expected, "N", rel=1e-9)


@pytest.mark.parametrize("stretch", [0.03, 0.3])
def test_spring_and_store_belong_together(stretch: float) -> None:
    """The spring is the derivative of what is stored, within the toe and beyond it; so are the kernels' own slopes."""
    values = {"lumped.toe_strain": 0.02, "tether.damping_ratio": 0.1, "lumped.end_compliance": 0.3}
    r = lumped(1, HEAVY, values | apart(12.5, 0.0, 0.0, 0.0)).record
    length, h = 6.0 + stretch, 1e-6
    for piece in (0, 1):
        _, spring, firm = pieces.pull(r, piece, length, 0.0, 0.0)
        higher, lower = (pieces.stored(r, piece, length + d, 0.0) for d in (h, -h))
        assert spring == pytest.approx((higher - lower) / (2.0 * h), rel=1e-6)
        higher, lower = (pieces.pull(r, piece, length + d, 0.0, 0.0)[1] for d in (h, -h))
        assert firm == pytest.approx((higher - lower) / (2.0 * h), rel=1e-6)


def test_outputs_have_their_derivatives() -> None:
    """Of tension, heat and energy, while line is wound out at the chaser, within the toe of the rope."""
    values = {"lumped.toe_strain": 0.1, "tether.damping_ratio": 0.05, "lumped.damped_as": AS_NODE}
    i = lumped(2, HEAVY, values | apart(12.3, 0.1, 0.05, 0.0))
    names = ("tether.tension", "lumped.heat", "energy.relative", "tether.impulse")
    i.set_rates({"reel.length_offset": 0.02})
    i.step(0.2)
    before = {name: i[name] for name in names}
    i.set_rates({"reel.length_offset": 0.02})
    h = 1e-4
    i.step(h)
    i.set_rates({"reel.length_offset": 0.02})
    i.differentiate()
    rates = {name: i.rate(name) for name in names}
    i.set_rates({"reel.length_offset": 0.02})
    i.step(h)
    for name in names:
        assert rates[name] == pytest.approx((i[name] - before[name]) / (2.0 * h), rel=1e-4, abs=1e-7)


def test_the_partial_of_the_tension_is_its_difference() -> None:
    values = {"lumped.toe_strain": 0.1, "tether.damping_ratio": 0.05, "lumped.damped_as": AS_NODE}
    i = lumped(2, HEAVY, values | apart(12.3, 0.1, 0.05, 0.0))
    i.differentiate()
    partials = [i.partial(name, "reel.length_offset") for name in ("tether.tension", "energy.relative")]
    found = []
    for offset in (1e-5, -1e-5):
        i["reel.length_offset"] = offset
        i.refresh()
        found.append((i["tether.tension"], i["energy.relative"]))
    assert partials == pytest.approx([(a - b) / 2e-5 for a, b in zip(*found, strict=True)], rel=1e-6)


@pytest.mark.parametrize("group", NOT_WITH)
def test_what_knows_one_piece_alone_is_refused(group: str) -> None:
    needed = {"plume": {"thrust": "tether"}, "sunlight": {"shadow": "cone"}}.get(group, {})
    term = next(iter(MODEL.groups[group].terms))
    with pytest.raises(ValueError, match=f"cannot go together with {group}"):
        MODEL.interface(pair.TERMS | {"environment": "central", group: term} | needed)


@pytest.mark.parametrize(("group", "term"), [("reel", "linear"), ("solver", "gauss"), ("target", "box")])
def test_terms_that_carry_no_nodes_are_refused(group: str, term: str) -> None:
    changed: dict[str, Any] = pair.TERMS | {group: term}
    with pytest.raises(ValueError, match=f"nodes go with {group} = .*, not '{term}'"):
        make_entry(changed)


def test_the_cost_is_told_beforehand() -> None:
    """The same fastest motion as the model's, by its own formulas; steps of an hour by the reach of the scheme."""
    values = {"tether.damping_ratio": 0.3, "lumped.damped_as": AS_NODE}
    i = lumped(5, HEAVY, values | apart(11.0, 0.0, 0.0, 0.0))
    told = cost({name: i[name] for name in (*NAMES, "reel.length_offset")})
    r = i.record[0]
    assert told.fastest == pytest.approx(r.state_nodes_fastest)
    assert told.steps == pytest.approx(3600.0 / r.state_nodes_reach)
    assert told.mass == pytest.approx(i["lumped.mass"])
    assert told.dashpot == pytest.approx(r.state_piece_lag * r.state_piece_stiffness / 6.0)


def test_the_dashpot_of_the_line_is_that_of_its_pieces_in_series() -> None:
    """By the pair's ratio that of a massless line; by a node's what six pieces make of theirs."""
    values = {"tether.damping_ratio": 0.3} | apart(11.0, 0.0, 0.0, 0.0)
    named = (*NAMES, "reel.length_offset")
    found = []
    for damped_as in (AS_PAIR, AS_NODE):
        i = lumped(5, HEAVY, values | {"lumped.damped_as": damped_as})
        told = implied.rows({name: i[name] for name in named}, MODEL.interface(pair.TERMS).terms)
        found.append(next(row for row in told if row.key == "line.dashpot"))
    node = 0.3 * math.sqrt(2.0 * FIRM * 6.0 * i["lumped.mass"] / 5.0) / 6.0
    assert [row.value for row in found] == pytest.approx([2.0 * 0.3 * math.sqrt(FIRM * pair.REDUCED), node])
    assert found[1].label == "dashpot of the line, its pieces in series"
