"""Substeps that follow the net: held against the spectrum of what is taut, put together anew at many instants.

K = sum over taut threads of  (k n n^T + T/r (1 - n n^T)) x (e_a - e_b)(e_a - e_b)^T
  + sum over pulling cords of  k g g^T + T ds/dx dx,   g = ds/dx,   s the way through the rings,   K v = omega^2 M v
"""

import numpy as np
import pytest

from dcone_cosim.build import defaults
from fmu_src.instance import Instance
from fmu_src.net_capture.cautions import after
from fmu_src.net_capture.composition import Composition
from fmu_src.net_capture.formulas import ring_radius
from fmu_src.net_capture.interface import MODEL, refusals
from fmu_src.net_capture.planes import MASS, SHOWN, SHOWN_BACK, SHOWN_RATE
from fmu_src.net_capture.stepping import WAY_SHARE
from orbital.oscillators import explicit_step_limit
from tests.conftest import CAPTURE, FREE
from tests.net_capture.memory import graph, planes, shown
from tests.plain import plainly, seen

FOLLOWING = CAPTURE | {"substeps": "following"}
OPENING = FREE | {"substeps": "following"}
OPEN = {"closing.time": 100.0}
"""Of a net that flies alone, for 8 s far from the target."""
UNDAMPED = {"net.damping_ratio": 0.0, "closing.damping_ratio": 0.0}


def cords(net):
    """Of each cord that pulls: its stops (slots), stiffness [N/m] and tension [N]."""
    if net["closing.t_start"] < 0.0:
        return []
    parts, rings, found = graph(net), int(net["closing.rings"]), []
    place, lengths = planes(net)[SHOWN : SHOWN + 3], net.array("cord_length")
    radius = ring_radius.py_func(net["closing.lock_length"], rings)
    first = parts.corners.tolist()
    for i, (a, b) in enumerate(zip(first, [*first[1:], parts.rim.size], strict=True)):
        # rings nearest to an even spacing, halves upward
        at = [a + int(np.floor(n * (b - a) / (rings + 1) + 0.5)) for n in range(rings + 2)]
        stops = parts.rim[np.array(at) % parts.rim.size]
        way = np.sqrt(np.sum(np.diff(place[:, stops]) ** 2, axis=0) + radius**2).sum()
        stiffness = net["closing.axial_stiffness"] / lengths[i]
        if way > lengths[i]:
            found.append((stops, stiffness, stiffness * (way - lengths[i]), radius))
    return found


def fastest(net, *, with_cords=True):
    """Largest omega of all that pulls in the net as shown [1/s]; 0 where nothing does."""
    kept, threads = planes(net), graph(net)
    place, mass = kept[SHOWN : SHOWN + 3], kept[MASS]
    a, b = threads.ends.T
    d = place[:, b] - place[:, a]
    r = np.linalg.norm(d, axis=0)
    taut, pulling = np.flatnonzero(r > threads.length), cords(net) if with_cords else []
    used = np.unique(np.concatenate([a[taut], b[taut], *(stops for stops, *_ in pulling)]).astype(int))
    if not used.size:
        return 0.0
    number, matrix = {slot: 3 * n for n, slot in enumerate(used.tolist())}, np.zeros((3 * used.size, 3 * used.size))

    def add(one, two, block):
        for m, sign in ((one, 1.0), (two, -1.0)):
            for n, other in ((one, 1.0), (two, -1.0)):
                matrix[number[m] : number[m] + 3, number[n] : number[n] + 3] += sign * other * block

    for e in taut.tolist():
        n, k = d[:, e] / r[e], threads.stiffness[e]
        along = np.outer(n, n)
        add(int(a[e]), int(b[e]), k * along + k * (1.0 - threads.length[e] / r[e]) * (np.eye(3) - along))
    for stops, k, tension, radius in pulling:
        gradient = np.zeros(3 * used.size)
        for one, two in zip(stops[:-1].tolist(), stops[1:].tolist(), strict=True):
            way = place[:, two] - place[:, one]
            root = np.sqrt(way @ way + radius**2)
            gradient[number[two] : number[two] + 3] += way / root
            gradient[number[one] : number[one] + 3] -= way / root
            add(one, two, tension / root * (np.eye(3) - np.outer(way, way) / root**2))
        matrix += k * np.outer(gradient, gradient)
    light = np.repeat(1.0 / np.sqrt(mass[used]), 3)
    return float(np.sqrt(max(np.linalg.eigvalsh(light[:, None] * matrix * light)[-1], 0.0)))


def on_grid(net):
    """Go on to the next substep's end."""
    p = net.record[0]
    ahead = net.time - float(p["pace_time"]) - (int(p["grid"]) - int(p["pace_grid"])) * net["solver.substep"]
    net.step(net["solver.substep"] - max(ahead, 0.0))


def watch(net, end, span):
    """At an instant in every `span` until `end` [s]: limit of the true spectrum, substep, bound in force after it, and
    how much faster the cords make the net [1]."""
    rows = []
    while net.time < end:
        net.step(span)
        on_grid(net)
        omega, substep = fastest(net), net["solver.substep"]
        bare = fastest(net, with_cords=False) if cords(net) else omega
        left = int(net.record["pace_next"][0] - net.record["grid"][0])
        on_grid(net)
        if omega > 0.0 and left > 1:  # at a look the bound is that of the next interval
            faster = omega / bare if bare > 0.0 else np.inf
            rows.append((explicit_step_limit(omega**2, 0.0), substep, net["solver.bound_now"], faster))
    return np.array(rows)


@pytest.fixture(scope="module")
def captured():
    """Table 1's capture, undamped, from the first contact to the closed mouth."""
    net = Instance(MODEL, FOLLOWING, UNDAMPED).initialise()
    rows = watch(net, 16.0, 0.0237)
    return net, rows


def test_no_instant_of_a_capture_is_faster_than_the_bound_in_force(captured):
    net, rows = captured
    assert net["closing.t_start"] > 0.0
    assert net["cord.tension_max"] > 1.0
    assert len(rows) > 200
    limit, _, bound, _ = rows.T
    assert np.all(limit >= bound * (1.0 - 1e-9))
    # and it is no idle one
    assert np.min(limit / bound) < 1.3


def test_the_margin_told_holds_at_every_instant(captured):
    net, (limit, substep, _, _) = captured[0], captured[1].T
    assert net["solver.margin_least"] > 1.0
    assert np.all(limit / substep >= net["solver.margin_least"])


def test_the_cord_is_in_the_spectrum(captured):
    """The twin of the first: without cords the spectrum would be another while they pull."""
    cords_count = captured[1][:, 3]
    assert np.sum(cords_count > 1.0) > 20


@pytest.mark.evidence
def test_between_one_thread_and_all(shoot):
    """Never longer than a thread by itself allows, never shorter than all of them need, but for whole numbers."""
    free = shoot({"net.mesh": 2.0})
    net = shoot({"net.mesh": 2.0}, OPENING)
    net.step(8.0)
    assert 0.45 * free["solver.substep"] < net["solver.substep_least"]
    assert free["solver.substep"] < net["solver.substep_mean"] < net["solver.substep_most"]
    assert net["solver.steps"] * net["solver.substep_mean"] == pytest.approx(8.0)
    parts, mass = graph(net), planes(net)[MASS]
    light = 0.5 * (1.0 / mass[parts.ends[:, 0]] + 1.0 / mass[parts.ends[:, 1]])
    alone = [
        explicit_step_limit(2.0 * k * m, 2.0 * d * m)
        for k, d, m in zip(parts.stiffness, parts.damping, light, strict=True)
    ]
    assert net["solver.substep_most"] < min(alone)


@pytest.mark.parametrize(
    "terms",
    [
        pytest.param(FOLLOWING, id="leapfrog"),
        pytest.param(OPENING | {"solver": "rk4"}, id="rk4", marks=pytest.mark.evidence),
    ],
)
def test_bits_do_not_depend_on_the_macro_step(shoot, terms):
    values = {"net.mesh": 3.0, "chaser.start_position[2]": -12.0}
    once, often = shoot(values, terms), shoot(values, terms)
    once.step(3.0)
    for size in (0.5, 0.0001, 0.0123, 1.0 - 0.0124, 0.25, 1.25):
        often.step(size)
    assert once["solver.steps"] == often["solver.steps"]
    assert np.array_equal(shown(once), shown(often))
    assert np.array_equal(shown(once, SHOWN_RATE), shown(often, SHOWN_RATE))
    for name in ("energy.remainder", "solver.margin_least", "solver.unexpected", "solver.substep_mean"):
        assert once[name] == often[name]


def test_a_state_that_is_restored_goes_on_with_the_same_bits(shoot):
    values = {"net.mesh": 3.0, "chaser.start_position[2]": -12.0}
    net = shoot(values, FOLLOWING)
    net.step(4.0037)
    kept = net.record.copy(), net.work.copy()
    net.step(4.0)
    once = net.record.tobytes(), net.work.tobytes()
    net.record[:], net.work[:] = kept
    net.time = 4.0037
    net.step(4.0)
    assert (net.record.tobytes(), net.work.tobytes()) == once
    net.initialise()
    net.step(4.0037)
    assert np.array_equal(net.work, kept[1])


def test_a_change_of_the_substep_leaves_the_velocities_of_now(shoot):
    """v(t - h'/2) = v(t) - h'/2 a(t): what is shown stays, what lies ahead is half of another substep on."""
    net = shoot({"net.mesh": 2.0} | OPEN, FOLLOWING)
    net.step(8.0)
    assert net["thread.taut"] > 10
    (p,), parts = seen(net.record), Composition(MODEL, net.interface.terms)
    show, change = plainly(parts.scheme.show), plainly(parts.scheme.change)
    show(p, net.work)
    now, ahead = shown(net, SHOWN_RATE), shown(net, SHOWN_BACK)
    change(p, net.work, 0.5 * p.solver_substep)
    p.solver_substep *= 0.5
    show(p, net.work)
    assert np.allclose(shown(net, SHOWN_RATE), now, rtol=0.0, atol=1e-12)
    assert np.max(np.abs(ahead - now)) > 1e-4
    assert np.allclose(shown(net, SHOWN_BACK) - now, 0.5 * (ahead - now), rtol=0.0, atol=1e-12)


def test_energy_and_momentum_are_kept(shoot):
    net = shoot({"net.mesh": 2.0, "net.damping_ratio": 0.0} | OPEN, FOLLOWING)
    before = net.array("momentum").copy(), net.array("angular_momentum").copy()
    net.step(8.0)
    assert net["solver.substep_most"] > 1.3 * net["solver.substep_least"]
    assert abs(net["energy.remainder"]) < 0.01 * 9.0
    assert np.allclose(net.array("momentum"), before[0], atol=1e-11)
    assert np.allclose(net.array("angular_momentum"), before[1], atol=1e-9)


@pytest.mark.parametrize(("ratio", "holds"), [(0.8, True), (1.2, False)])
def test_a_step_above_the_bound_is_seen(shoot, ratio, holds):
    """A fifth above: the model's own account says so, and the run warns."""
    net = shoot({"net.mesh": 2.0, "solver.step_ratio": ratio} | OPEN, FOLLOWING)
    net.step(4.0)
    assert (net["solver.margin_least"] >= 1.0) == holds
    found = [c for c in after({}, (), {}, lambda name: Last(net[name]) if name == "solver.margin_least" else None)]
    assert bool(found) != holds


class Last:
    def __init__(self, value):
        self.first = self.least = self.largest = self.last = value


def test_a_scheme_without_a_bound_is_refused(shoot):
    terms = FREE | {"solver": "ros2", "substeps": "following"}
    with pytest.raises(ValueError, match="cannot follow the net with the scheme ros2"):
        Composition(MODEL, MODEL.interface(terms).terms)
    values = defaults(MODEL.interface(terms))
    assert [r.name for r in refusals(terms, values)] == ["solver.substeps"]
    assert not refusals(MODEL.interface(OPENING).terms, values)


THIN = {
    "net.side": 4.0,
    "net.mesh": 1.0,
    "net.mass": 1e-5,
    "net.youngs_modulus": 1e5,
    "net.damping_ratio": 0.0,
    "net.fold_side": 0.02,
    "vertex.mass": 1e-6,
    "bullets.mass": 1e-3,
    "bullets.angle": 0.0,
    "bullets.speed": 100.0,
    "chaser.start_position[2]": -5.0,
    "closing.rings": 0,
    "target.mass": 1e3,
    "target.size[1]": 0.1,
    "target.size[2]": 0.1,
    "target.size[3]": 8.0,
    # an edge points sideways: turned by 45 degrees about the third axis
    "target.start_attitude[1]": np.cos(np.pi / 8),
    "target.start_attitude[4]": np.sin(np.pi / 8),
}
"""Bullets at 100 m/s, past the edge of a bar of 10 cm."""


@pytest.mark.parametrize("terms", [CAPTURE, FOLLOWING], ids=["fixed", "following"])
@pytest.mark.parametrize("clearance", [-0.003, 0.006])
def test_a_fast_bullet_passes_an_edge_or_meets_it(shoot, terms, clearance):
    """Half a substep's way is how far an edge reaches beyond itself, and WAY_SHARE/2 of 10 cm is 5 mm."""
    edge = 0.05 * np.sqrt(2.0)
    met = []
    for shift in np.linspace(0.0, 0.01, 9):
        aside = edge + clearance + 0.01  # the nearest bullets fly a centimetre inside the muzzle's line
        start = {"chaser.start_position[1]": aside, "chaser.start_position[2]": -5.0 - shift, "shot.axis[2]": 1.0}
        net = shoot(THIN | start, terms)
        assert 100.0 * net["solver.substep"] <= WAY_SHARE * 0.1 * (1.0 + 1e-9)
        net.step(0.06)
        met.append(net["contact.first_time"] >= 0.0)
    assert all(met) if clearance < 0.0 else not any(met)
