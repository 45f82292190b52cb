"""What holds a target whose appendage swings: boxes round its pieces, and its bounds at any angle."""

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmu_src.implied import formula
from fmu_src.net_capture.hinge import numbers as at
from fmu_src.net_capture.shapes import pieces, solids, union
from fmu_src.net_capture.shapes.nearest import close_round
from tests.net_capture.two_bodies import AXIS, POINT, WING, TwoBodies, body_turn, boxes, tables_of


@pytest.mark.parametrize("kind", range(5))
def test_the_box_that_holds_pieces_holds_boxes_round_them(kind):
    """Of each kind askew, and of two."""
    sizes = {
        "box": {"size": [1.0, 2.0, 0.3]},
        "cylinder": {"radius": 0.3, "length": 1.7},
        "sphere": {"radius": 0.6},
        "frustum": {"radius_bottom": 0.2, "radius_top": 0.5, "length": 1.1},
        "shell": {"radius": 0.7, "length": 1.3, "thickness": 0.1},
    }[pieces.KINDS[kind]]
    turn = Rotation.from_rotvec([0.4, -0.7, 0.3]).as_quat(scalar_first=True).tolist()
    askew = {"shape": kind, "mass": 2.0, "position": [0.3, -0.2, 0.4], "attitude": turn, **sizes}
    entries = [askew, {"shape": pieces.BOX, "size": [0.2, 0.2, 4.0], "mass": 1.0, "position": [0.1, 0.0, 0.0]}]
    whole = solids.Solid(1.0, np.ones(3), np.eye(3), np.zeros(3))
    for some in (entries, entries[:1]):
        found = pieces.pieces(np.array(pieces.gather(some)))
        half, signs = np.empty(3), np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
        formula(close_round)(half, union.pieces_table(found, whole))
        corners = [piece.place + signs * pieces.half_of(piece) @ piece.turn.T for piece in found]
        np.testing.assert_allclose(half, np.abs(np.vstack(corners)).max(axis=0), rtol=1e-14)


def test_its_bounds_hold_at_any_angle():
    """Of corners of the pieces at angles of a finer grid; and what an impulse gives at most, of two bodies."""
    tables, mass = tables_of(limit=1.2)
    table, (turn, _), two = tables[at.BODY], body_turn(tables), TwoBodies(WING, POINT, AXIS)
    corners = {False: [], True: []}
    for place, own, half, hinged in boxes([{"position": [0, 0, 0], "attitude": [1, 0, 0, 0]} | e for e in WING]):
        signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1).T
        corners[hinged].append(place + own.apply(signs * half))
    most, largest, farthest = 0.0, np.zeros(3), 0.0
    for angle in np.linspace(-1.2, 1.2, 37):
        y = two.start(Rotation.identity(), np.zeros(3), angle, 0.0)
        for k, (place, own, _, _) in enumerate(two.parts(y)):
            for corner in place + own.apply(np.vstack(corners[bool(k)]) - two.centres[k]):
                largest = np.maximum(largest, np.abs(turn.inv().apply(corner)))
                farthest = max(farthest, float(np.linalg.norm(corner)))
                given = np.zeros((3, 3))
                for i in range(3):
                    forces = np.zeros(12)
                    forces[6 * k : 6 * k + 3] = np.eye(3)[i]
                    forces[6 * k + 3 : 6 * k + 6] = np.cross(corner - place, np.eye(3)[i])
                    gained = two.solve(y, forces, two.constraints(y)[0], np.zeros(5))[6 * k : 6 * k + 6]
                    given[:, i] = gained[:3] + np.cross(gained[3:], corner - place)
                most = max(most, float(np.linalg.eigvalsh(0.5 * (given + given.T))[-1]))
    assert (largest <= table[at.HALF : at.RADIUS]).all()
    assert (largest > 0.94 * table[at.HALF : at.RADIUS]).all()
    assert 0.97 * table[at.RADIUS] < farthest <= table[at.RADIUS]
    assert 0.98 * table[at.YIELDS] < most * mass <= table[at.YIELDS] * (1.0 + 1e-9)
