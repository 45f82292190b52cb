"""How many digits of a figure hold: the net is chaotic, and what hangs on its folds is one sample of many.

Node trajectories part company after seconds whatever the step. The spread of a figure is the standard deviation over
its mean of eight runs whose folded nodes differ by 1e-6 m (`solver.jitter`, seeds 0 to 7), the larger of
`table1-capture` and `mission`, with 5 s after the capture; kept true by tests/cosim/test_digits.py. A figure that is
not here holds to six digits.
"""

from __future__ import annotations

from collections.abc import Mapping

from dcone_cosim.results import PhaseResult

CAPTURE: Mapping[str, float] = {
    "handed_over_at": 0.05,
    "t_capture": 0.05,
    "contact.first_time": 2e-3,
    "mouth.t80": 8e-4,
    "mouth.t_max": 1e-3,
    "mouth.area_max": 2e-3,
    "mouth.area_at_touch": 2e-3,
    "thread.tension_max": 0.31,
    "cord.tension_max": 0.17,
    "mouth.cord_length": 0.07,
    "contact.loss": 0.1,
    "contact.friction_loss": 0.2,
    "contact.depth": 0.3,
    "closing.work": 0.13,
    "thread.dissipated": 0.1,
    "cord.dissipated": 0.46,
    "energy.remainder": 0.1,
    "tether.paid_out": 5e-4,
    "enclosure.at_capture": 0.03,
    "enclosure.least": 0.09,
    "mouth.margin_at_capture": 1.4,
    # of four runs of `pull-off`
    "closing.braked": 3e-3,
    "quality.at_capture": 0.04,
    "quality.index": 0.04,
    "quality.hull_volume": 0.06,
    "quality.hull_surface": 0.04,
    "quality.offset": 0.02,
    "pull_off.t_start": 5e-3,
    "pull_off.drawn_max": 0.17,
    "pull_off.tension_max": 0.38,
    "pull_off.work": 0.1,
    # of four runs of `hinged-panel` on meshes of 1 m
    "hinge.loss": 0.03,
    "hinge.angle": 0.08,
    "hinge.angle_max": 4e-3,
    "hinge.angle_min": 4e-3,
}
"""Relative spread [1] of the figures of a net, by key."""

HAND_OFF: Mapping[str, float] = {
    "time": 0.05,
    "distance": 5e-6,
    "spin_dropped": 1e-4,
    "spin_energy_dropped": 3e-4,
    "attachment_speed": 2e-4,
    "body_rate": 2e-4,
    "point_bound_time": 2e-2,
    "point_bound_peak": 2e-2,
    "tug_speed": 6e-5,
    "attachment_distance": 2e-3,
    "slack": 8e-4,
    "slack_after": 9e-4,
    "energy_lost": 1e-3,
    "ledger_closure": 0.6,
    "net_compliance": 0.17,
    "net_drawn": 0.17,
    "net_stays": 0.17,
}
"""The same of what a net hands over."""

HANDED_OVER: Mapping[str, float] = {
    "tugs": 0.02,
    "first_tug": 1e-3,
    "first_tug_speed": 9e-5,
    "first_tug_peak": 9e-5,
    "largest_tug_peak": 3e-4,
    "tugs_without_recoil": 0.02,
    "first_tug_without_recoil": 2e-4,
    "first_tug_speed_without_recoil": 2e-3,
    "first_tug_peak_without_recoil": 2e-3,
    "largest_tug_peak_without_recoil": 2e-3,
    "tension_mean": 2e-4,
    "tension_least": 4e-4,
    "tension_largest": 2e-4,
    "separation": 2e-4,
    "approach": 5e-4,
    "approach_time": 6e-4,
}
"""The same of a tow that begins with it, `mission`: where the vertex lies is chaotic, and with it the line's slack."""

TUGGING: Mapping[str, float] = {
    "tugs": 0.3,
    "largest_tug_peak": 0.1,
    "tension_mean": 0.8,
    "tension_least": 0.8,
    "tension_largest": 0.3,
    "separation": 0.2,
    "approach": 0.1,
    "approach_time": 0.6,
}
"""The same of a tow that still tugs after `PREDICTABLE`: Table 2's over a day with damping ratios of 0 and 0.001, eight
runs whose separations at the start differ by 1e-6 m. At a ratio of 0.01 and more the tugs end before, and with them the
chaos."""
PREDICTABLE = 43200.0
"""How long the timing of tugs can be told [s]."""


def of_tow(result: PhaseResult, begun_by_a_net: bool) -> dict[str, float]:
    """Relative spread [1] of the figures of a tow that are samples, by key."""
    return {**(HANDED_OVER if begun_by_a_net else {}), **(TUGGING if _still_tugs(result) else {})}


def _still_tugs(removal: PhaseResult) -> bool:
    if removal.tugs is None or not removal.tugs.rows or not len(removal.recorder):
        return False
    latest = max(time for time, _, _ in removal.tugs.rows.values())
    return bool(latest - removal.recorder["time"][0] > PREDICTABLE)
