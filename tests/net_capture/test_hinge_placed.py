"""What is said of a hinge that lies off both bodies, swings into one, or turns too fast: each with its twin."""

import math

import numpy as np
import pytest

from dcone_cosim.loading import load
from dcone_cosim.scene.mistakes import SceneError
from fmu_src.implied import formula
from fmu_src.net_capture.appendage.placed import AT_ONCE, FAR, ROUNDED, Sunk, _within, cautions, off_axis, swing_of
from fmu_src.net_capture.cautions import before
from fmu_src.net_capture.hinge import numbers as at
from fmu_src.net_capture.shapes import pieces, solids
from fmu_src.net_capture.shapes.union import (
    PIECES,
    body_of,
    in_body_axes,
    piece_distance,
    pieces_table,
    swinging,
)
from tests.net_capture.two_bodies import EDGE, FLAT

ACROSS = np.array([1.0, 0.0, 0.0])
WALL = EDGE - [0.0, 0.0, 0.1]
"""On the body's wall; the wing begins 10 cm above it."""
STEP = 1e-4


def values_of(entries=FLAT, point=WALL, limit=1.5, axis=ACROSS, **hinge):
    """Values of a scene as far as they are asked for, without its girth, which takes seconds; a point of the wing goes
    2 m per radian at most."""
    rows = entries if isinstance(entries, np.ndarray) else np.array(pieces.gather(entries))
    plain, swings = rows[:, : pieces.ROW], swinging(rows)
    whole, found = body_of(plain), pieces.pieces(plain)
    table, solid = np.zeros(at.SAMPLES), np.zeros(solids.SOLID)
    table[at.SHARE] = body_of(plain[swings]).mass / whole.mass
    centre = whole.to_body(body_of(plain[swings]).center[None, :])[0]
    table[at.HINGE : at.AXIS], table[at.AXIS : at.ARM] = whole.to_body(point[None, :])[0], axis
    table[at.ARM : at.REST] = centre - table[at.HINGE : at.AXIS]
    table[at.LIMIT], table[at.REACH], table[at.PIECES : at.PIECES + len(rows)] = limit, 2.0, swings
    corners = np.vstack([pieces.spanning(piece, True) for piece in found])
    solid[solids.RADIUS] = np.linalg.norm(whole.to_body(corners), axis=1).max()
    values = {at.BODY: table, PIECES: pieces_table(found, whole), "target.solid": solid}
    at_rest = {"start_angle": 0.0, "start_rate": 0.0}
    return {**values, **{f"hinge.{key}": value for key, value in {**at_rest, **hinge}.items()}}


def test_the_values_are_those_that_a_scene_has():
    main = load("hinged-panel").phases[0].main
    made = values_of(main.sources["target.parts"], np.array([0.0, 0.0, 1.0]), math.radians(90.0))
    assert set(made) <= set(main.values)
    for name, count in ((PIECES, None), (at.BODY, at.REST)):
        np.testing.assert_allclose(made[name][:count], main.values[name][:count], atol=1e-12)
    flags = [at.LIMIT, *range(at.PIECES, at.PIECES + 3)]
    np.testing.assert_array_equal(made[at.BODY][flags], main.values[at.BODY][flags])
    assert made["target.solid"][solids.RADIUS] == main.values["target.solid"][solids.RADIUS]


def about(values, substep=STEP):
    return [caution.about for caution in cautions(values, substep)]


def placed(kind, sizes):
    return pieces.Piece(kind, [*sizes, *([0.0] * (4 - len(sizes)))], 1.0, np.zeros(3), np.eye(3))


def test_a_sound_hinge_gives_no_cause():
    assert about(values_of(start_angle=0.3, start_rate=0.5)) == []


@pytest.mark.parametrize("along", [0.0, 50.0])
def test_an_axis_off_both_bodies(along):
    """By its distance as a line from each: 3 m from the wall of the body, 2.475 m from that of the wing; along itself
    a position means the same."""
    off = off_axis(values_of(point=np.array([along, 3.5, 1.1])))
    assert off == pytest.approx((math.hypot(3.0, 0.1), 3.475, 0.1), abs=2e-4)
    assert about(values_of(point=np.array([along, 3.5, 1.1])))[0] == "hinge.position"
    assert off_axis(values_of(point=np.array([along, 0.0, 1.1]))) is None


def test_an_axis_may_lie_between_bodies_far_apart():
    """0.8 m from each of two that are 1.6 m apart, and not 1.7 m from both."""
    apart = [FLAT[0], {**FLAT[1], "position": [0.0, 0.0, 3.6]}]
    assert off_axis(values_of(apart, np.array([0.0, 0.0, 1.8]))) is None
    far = off_axis(values_of(apart, np.array([0.0, 0.0, -4.0])))
    assert far == pytest.approx((3.0, 6.6, 1.6), abs=2e-4)


@pytest.mark.parametrize("share", [0.98, 1.02])
def test_how_far_off_is_told(share):
    """Beside the body's wall, below the wing: nearer to the body, and both lie 0.1 m apart."""
    beyond = share * (FAR * values_of()["target.solid"][solids.RADIUS] + 0.1)
    found = off_axis(values_of(point=np.array([0.0, 0.5 + beyond, 0.0])))
    assert (found is not None) is (share > 1.0)


@pytest.mark.parametrize("angle", [2.0, -2.0, 1.9])
def test_how_deep_a_wing_is(angle):
    """The far corner of its middle surface, 0.1 to 2.1 m from the hinge, and half its thickness: as long as the wall
    that it went through is the nearest."""
    sunk = Sunk(values_of(limit=2.5))
    length = 0.5 / math.sin(abs(angle))  # where the middle leaves the side
    nearest = min(-length * math.cos(angle), 0.5 - 0.1)
    assert sunk.at(angle) > 0.0
    grid = np.linspace(0.1 + 0.025, 2.1 - 0.025, 9)
    depths = [min(-x * math.cos(angle), 0.5 - x * math.sin(abs(angle))) for x in grid]
    assert sunk.at(angle) == pytest.approx(max(depths) + 0.025, abs=1e-9)
    assert max(depths) <= nearest + 1e-9


@pytest.mark.parametrize(("off", "said"), [(-0.005, False), (0.06, True)])
def test_a_wing_may_lie_against_the_wall(off, said):
    """At 90 deg its middle lies in the wall, or below it where the axis does; a little of it is not told."""
    entries, quarter = [FLAT[0], {**FLAT[1], "position": [0.0, 0.0, 2.1]}], 0.5 * math.pi
    values = values_of(entries, WALL - [0.0, 0.0, off], limit=quarter)
    radius = values["target.solid"][solids.RADIUS]
    assert said == (off > ROUNDED * radius)
    assert said == (Sunk(values).at(quarter) > 0.0)
    assert ("hinge.limit" in about(values)) is said


def test_what_is_drawn_within_the_other_is_meant():
    """A boom that stands 0.3 m in the body, straight and turned by a little; not the same one deeper in."""
    boom = {"shape": pieces.CYLINDER, "radius": 0.05, "length": 1.0, "mass": 3.0, "hinged": True}
    entries = [FLAT[0], {**boom, "position": [0.0, 0.0, 1.2]}]
    assert Sunk(values_of(entries)).at(0.3) == 0.0
    # its far end about a point of the wall 0.35 m beside it
    depth = Sunk(values_of(entries, np.array([0.0, 0.35, 1.0]))).at(0.3)
    assert depth == pytest.approx(0.25 * math.cos(0.3) + 0.35 * math.sin(0.3) + 0.05, abs=1e-9)


def test_a_limit_is_told_with_one_that_keeps_it_out():
    swing = swing_of(values_of(limit=2.5))
    assert 1.57 < swing.free < 1.66
    assert abs(swing.worst) > swing.free
    assert swing.deepest == max(Sunk(values_of(limit=2.5)).at(side * swing.worst) for side in (1.0, -1.0))
    assert about(values_of(limit=2.5)) == ["hinge.limit"]
    assert about(values_of(limit=swing.free)) == []


@pytest.mark.parametrize(("angle", "said"), [(1.5, False), (2.1, True), (-2.1, True)])
def test_a_start_within_the_body(angle, said):
    assert ("hinge.start_angle" in about(values_of(limit=2.5, start_angle=angle))) is said


@pytest.mark.parametrize("share", [0.99, 1.01])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_stop_that_is_met_at_once(share, side):
    """From 0.2 rad on the way out 0.1 rad are left, on the way back 0.5 rad."""
    for start, left in ((0.2, 0.1), (-0.2, 0.5)):
        values = values_of(limit=0.3, start_angle=side * start, start_rate=side * share * left / (AT_ONCE * STEP))
        told = [one for one in cautions(values, STEP) if "the stop at" in one.sentence]
        assert len(told) == (share > 1.0)
        assert all(f"{math.degrees(left):.3g} deg on" in one.sentence for one in told)


@pytest.mark.parametrize("share", [0.99, 1.01])
def test_a_wing_that_goes_through_nodes(share):
    """Half the thickness of 5 cm in a substep, at the point that moves most."""
    values = values_of()
    rate = share * 0.025 / (2.0 * STEP)
    told = [one for one in cautions(values | {"hinge.start_rate": -rate}, STEP) if "half its thickness" in one.sentence]
    assert len(told) == (share > 1.0)
    assert all(f"at most {math.degrees(rate / share):.3g} deg/s" in one.sentence for one in told)


@pytest.mark.parametrize(
    ("piece", "deep"),
    [
        (placed(pieces.BOX, [2.0, 0.1, 1.0]), 0.05),
        (placed(pieces.CYLINDER, [0.1, 2.0]), 0.1),
        (placed(pieces.CYLINDER, [1.0, 0.2]), 0.1),
        (placed(pieces.SPHERE, [0.4]), 0.4),
        (placed(pieces.SHELL, [1.0, 2.0, 0.1, 2.0]), 0.05),
    ],
    ids=["box", "rod", "disc", "ball", "shell"],
)
def test_points_within_a_piece_are_as_deep_as_half_its_thickness(piece, deep):
    own, told = _within(piece)
    assert told == deep
    whole = solids.Solid(1.0, np.ones(3), np.eye(3), np.zeros(3))
    (row,) = pieces_table([piece], whole)
    away = formula(piece_distance)
    depths = np.array([-away(row, np.empty(3), point) for point in own])
    ends = np.isclose(np.abs(np.arctan2(own[:, 1], own[:, 0])), 1.0) & (piece.kind == pieces.SHELL)
    np.testing.assert_allclose(depths[~ends], deep, atol=1e-12)
    np.testing.assert_allclose(depths[ends], 0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (('capture.hinge.limit="0 deg"',), "must be greater than 0: a hinge that cannot turn is none"),
        (('capture.hinge.start_rate="1e8 deg/s"',), "capture.hinge.start_rate"),
        (('capture.target.start_rate=["0 deg/s", "1e8 deg/s", "0 deg/s"]',), "capture.target.start_rate"),
    ],
)
def test_what_cannot_be_meant_is_refused(settings, said):
    with pytest.raises(SceneError) as caught:
        load("hinged-panel", settings)
    assert said in str(caught.value)
    assert "1 mistake" in str(caught.value) or str(caught.value).count("must be") == 1


def test_validate_tells_it():
    main = load("hinged-panel").phases[0].main
    table = main.values[at.BODY].copy()
    table[at.LIMIT] = math.radians(140.0)
    (told,) = before(main.values | {at.BODY: table}, (), main.terms)
    assert told.about == "hinge.limit"
    assert told.sentence.startswith("140 deg let the appendage swing into the rest of the target, 0.52 m deep at 140")
    assert told.sentence.endswith("a limit of 90 deg keeps it out")
    fast = ('capture.hinge.start_rate="1e5 deg/s"', "capture.solver.step_ratio=0.1")
    (line,) = load("hinged-panel", fast[:1]).cautions
    assert line.startswith("capture.hinge.start_rate: at 1e+05 deg/s the appendage moves up to 0.056 m in a substep")
    assert load("hinged-panel", fast).cautions == (), "of a substep that the scene gives"


def test_pieces_of_the_table_are_those_drawn():
    """In body axes the wing of `FLAT` is where the scene has it, from the centre of mass."""
    values = values_of()
    wing = list(in_body_axes(values[PIECES]))[1]
    np.testing.assert_allclose(wing.place, [0.0, 0.0, 2.1 - 50.0 * 2.1 / 250.0])
