"""What counts as an error across a taut line: not the line's own vibration, which moves its ends aside too."""

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmu_src.tethered_deorbit.bodies import make_bodies
from fmu_src.tethered_deorbit.environment import make_environment
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from fmu_src.tethered_deorbit.layout import layout_of
from fmu_src.tethered_deorbit.reel import components
from tests.plain import PlainInstance, plain

__all__ = ["plain"]
TERMS = {"reel": "locked", "environment": "none", "target": "rigid", "chaser": "rigid"}
CHASER, TARGET = 2000.0, 1000.0
MOMENTS = {"chaser": (900.0, 1100.0, 1500.0), "target": (1800.0, 1000.0, 2100.0)}
ARMS = {"chaser": (0.6, 1.0, -0.3), "target": (1.2, -1.9, 0.7)}
TURNS = {"chaser": Rotation.from_euler("xyz", (0.3, 0.2, -0.4)), "target": Rotation.from_euler("xyz", (-0.7, 0.5, 1.1))}


def end_speed(role: str, impulse: np.ndarray) -> np.ndarray:
    """Change of velocity of the body's attachment by an impulse [N s] there, of a free rigid body."""
    turn, mass = TURNS[role].as_matrix(), {"chaser": CHASER, "target": TARGET}[role]
    arm = turn @ np.array(ARMS[role])
    inertia = turn @ np.diag(MOMENTS[role]) @ turn.T
    spin = np.linalg.solve(inertia, np.cross(arm, impulse))
    return impulse / mass + np.cross(spin, arm)


@pytest.mark.parametrize(("ratio", "counts"), [(0.05, False), (0.0, True)])
def test_a_pull_moves_the_line_s_end_aside(plain: None, ratio: float, counts: bool) -> None:
    """The change that a pull along the line makes has nothing across it, but for a line without damping; what is added
    across it counts whole."""
    given: dict[str, Any] = {"start.condition": HANDED_OVER, "start_relative_position": (3.0, 12.5, -1.0)}
    for role in MOMENTS:
        quaternion = TURNS[role].as_quat(scalar_first=True)
        given |= {f"{role}_inertia": (*MOMENTS[role], 0.0, 0.0, 0.0), f"{role}_attachment": ARMS[role],
                  f"{role}_start_attitude": tuple(float(x) for x in quaternion)}  # fmt: skip
    i = PlainInstance(MODEL, TERMS, {**given, "tether.damping_ratio": ratio})
    interface, layout = MODEL.interface(TERMS), layout_of(i.interface.terms, *components("locked"))
    environment = make_environment("none", interface)
    bodies = make_bodies(interface.terms, environment.place, environment.gradient, layout.size, interface)
    state = i.work[layout.size : 2 * layout.size].copy()
    bodies.stand(i.record, state)
    state[6:9] = i.record[0].state_line[0]
    along = state[6:9] / np.linalg.norm(state[6:9])
    error = np.zeros(layout.size)
    error[9:12] = end_speed("target", -along) - end_speed("chaser", along)
    longer = float(error[9:12] @ along)
    aside = error[9:12] - longer * along
    assert np.linalg.norm(aside) > 0.2 * abs(longer)
    found = bodies.square_across(i.record, state, error, longer)
    assert found == pytest.approx(float(aside @ aside) if counts else 0.0, rel=1e-12, abs=1e-28)
    more = 1e-3 * np.cross(along, (0.3, -0.5, 0.8))
    error[9:12] += more
    found = bodies.square_across(i.record, state, error, longer)
    whole = aside + more if counts else more
    assert found == pytest.approx(float(whole @ whole), rel=1e-9)
