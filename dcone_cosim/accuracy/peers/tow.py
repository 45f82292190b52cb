"""A tow by scipy, CVODE and heyoka: centre of mass and relative vector along inertial axes, events at slack and taut.

    M R'' = m_c g(R_c) + m_t g(R_t) + F e,   r'' = g(R_t) - g(R_c) - T r/(m_r |r|) - F e/m_c,   g(x) = -mu x/|x|^3
    T = k (l - l0) + c l' while l > l0 and T > 0, otherwise 0,   l = |r| - b,   e = h x R_c/|h x R_c|,   h = R_c x V_c

b is the distance from the target's centre of mass to the line's end on it.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dcone_cosim.accuracy.peers.peer import Found, Peer
from dcone_cosim.phases import removal_quantities
from dcone_cosim.quantities import Quantity
from dcone_cosim.scene.data import PhaseScene
from orbital.constants import EARTH_MU

Array = npt.NDArray[np.float64]
MU, MC, MT, THRUST, STIFFNESS, DAMPING, LENGTH, END = range(8)
"""Places of the numbers that the right-hand side takes."""
SCALES = np.array([1e3] * 3 + [1.0] * 3 + [1.0] * 3 + [1e-2] * 3 + [1.0])
"""Sizes that absolute tolerances are relative to, of R, V, r, r' and the impulse [m], [m/s], [N s]."""


class Tug(NamedTuple):
    """When it began [s], and its largest tension [N]."""

    time: float
    peak: float


class Problem(NamedTuple):
    """Numbers of the right-hand side, the state at the start, and the instants."""

    numbers: Array
    start: Array
    instants: Array


KNOWN = frozenset({"reel", "thrust", "environment", "target", "chaser", "ends", "level", "solver"})
"""Groups that a peer may leave out, or that change no motion until the tow ends: engine, air and all else it lacks."""


def able(phase: PhaseScene) -> bool:
    """A locked reel, thrust along the track or none, a central field and nothing else, two points; a line that is slack
    at the start."""
    terms = phase.main.terms
    return (
        terms.get("reel") == "locked"
        and terms.get("thrust", "along_track") == "along_track"
        and terms.get("environment", "central") == "central"
        and terms.get("target", "point") == terms.get("chaser", "point") == "point"
        and terms.keys() <= KNOWN
        and not phase.connections
    )


def problem(values: Mapping[str, float], instants: Sequence[float]) -> Problem:
    """From parameters, and outputs at the start, of our FMU."""
    chaser, target = values["chaser.mass"], values["target.mass"]
    length = values["tether.rest_length"] + values["reel.length_offset"]
    stiffness = values["tether.youngs_modulus"] * math.pi * values["tether.diameter"] ** 2 / 4.0 / length
    reduced = chaser * target / (chaser + target)
    damping = 2.0 * values["tether.damping_ratio"] * math.sqrt(stiffness * reduced)
    thrust = values.get("thrust.level", 0.0) + values.get("thrust.offset", 0.0)
    end = values["target.attachment_distance"]
    numbers = np.array([EARTH_MU, chaser, target, thrust, stiffness, damping, length, end])

    def vector(name: str) -> Array:
        return np.array([values[f"{name}[{i}]"] for i in (1, 2, 3)])

    position, velocity = vector("center.position"), vector("center.velocity")
    momentum = np.cross(position, velocity)
    radial, normal = position / np.linalg.norm(position), momentum / np.linalg.norm(momentum)
    axes = np.column_stack([radial, np.cross(normal, radial), normal])
    relative = axes @ vector("relative.position")
    turning = momentum / (position @ position)
    speed = axes @ vector("relative.velocity") + np.cross(turning, relative)
    return Problem(numbers, np.concatenate([position, velocity, relative, speed, [0.0]]), np.asarray(instants))


@cache
def compiled() -> tuple[Any, Any]:
    """Right-hand side `(numbers, taut, y, rate)` and line `(numbers, y) -> (stretch, tension before the clamp)`."""
    from numba import njit

    @njit
    def line(numbers: Array, y: Array) -> tuple[float, float]:
        r = math.sqrt(y[6] * y[6] + y[7] * y[7] + y[8] * y[8])
        speed = (y[6] * y[9] + y[7] * y[10] + y[8] * y[11]) / r
        stretch = r - numbers[END] - numbers[LENGTH]
        return stretch, numbers[STIFFNESS] * stretch + numbers[DAMPING] * speed

    @njit
    def rhs(numbers: Array, taut: bool, y: Array, rate: Array) -> None:
        mc, mt = numbers[MC], numbers[MT]
        whole = mc + mt
        r = math.sqrt(y[6] * y[6] + y[7] * y[7] + y[8] * y[8])
        tension = line(numbers, y)[1] if taut else 0.0
        rc = np.empty(3)
        vc = np.empty(3)
        rt = np.empty(3)
        for i in range(3):
            rc[i] = y[i] - mt / whole * y[6 + i]
            rt[i] = y[i] + mc / whole * y[6 + i]
            vc[i] = y[3 + i] - mt / whole * y[9 + i]
        dc = (rc[0] * rc[0] + rc[1] * rc[1] + rc[2] * rc[2]) ** 1.5
        dt = (rt[0] * rt[0] + rt[1] * rt[1] + rt[2] * rt[2]) ** 1.5
        h = np.cross(rc, vc)
        along = np.cross(h, rc)
        size = math.sqrt(along[0] * along[0] + along[1] * along[1] + along[2] * along[2])
        for i in range(3):
            gc = -numbers[MU] * rc[i] / dc
            gt = -numbers[MU] * rt[i] / dt
            push = numbers[THRUST] * along[i] / size
            rate[i] = y[3 + i]
            rate[3 + i] = (mc * gc + mt * gt + push) / whole
            rate[6 + i] = y[9 + i]
            rate[9 + i] = gt - gc - push / mc - tension * y[6 + i] / r * (1.0 / mc + 1.0 / mt)
        rate[12] = tension

    numbers = np.ones(8)
    y, rate = np.ones(13) + np.arange(13) * 0.1, np.zeros(13)
    rhs(numbers, True, y, rate)
    return rhs, line


def told(given: Problem, tugs: Sequence[Tug], states: Array) -> list[Quantity]:
    """The quantities of a tow, from its tugs and the states at the instants, shape (instants, 13)."""
    position, velocity = states[:, :3], states[:, 3:6]
    radius, speed = np.linalg.norm(position, axis=1), np.linalg.norm(velocity, axis=1)
    axis = 1.0 / (2.0 / radius - speed**2 / EARTH_MU)
    share = given.numbers[MT] / (given.numbers[MC] + given.numbers[MT])
    chaser = np.linalg.norm(position - share * states[:, 6:9], axis=1)
    found = []
    first = tugs[: removal_quantities.TUGS]
    if first:
        found.append(Quantity("tug_times", "", [tug.time for tug in first], "s"))
        found.append(Quantity("tug_peaks", "", [tug.peak for tug in first], "N"))
        found.append(Quantity("largest_tug", "", [max(tug.peak for tug in tugs)], "N"))
    found.append(Quantity("mean_tension", "", [float(states[-1, 12] / given.instants[-1])], "N"))
    found.append(Quantity("semi_major_axis", "", axis.tolist(), "m", 1.0))
    found.append(Quantity("radius", "", chaser.tolist(), "m", 1.0))
    found.append(Quantity("separation", "", np.linalg.norm(states[:, 6:9], axis=1).tolist(), "m", 1.0))
    return found


def by_scipy(values: Mapping[str, float], size: float, instants: Sequence[float]) -> Found:
    """scipy's DOP853 from change to change of the line, its events located on its dense output."""
    from scipy.integrate import solve_ivp

    given = problem(values, instants)
    rhs, line = compiled()
    rate = np.zeros(13)
    taut = False

    def derivative(_: float, y: Array) -> Array:
        rhs(given.numbers, taut, y, rate)
        return rate.copy()

    def change(_: float, y: Array) -> float:
        stretch, tension = line(given.numbers, y)
        return float(-tension if taut else min(stretch, tension))

    def turn(t: float, y: Array) -> float:
        """Rate of the tension of a taut line."""
        if not taut:
            return -1.0
        slope = derivative(t, y)
        r = float(np.linalg.norm(y[6:9]))
        speed = float(y[6:9] @ y[9:12]) / r
        bend = float(y[9:12] @ y[9:12] + y[6:9] @ slope[9:12] - speed * speed) / r
        return float(given.numbers[STIFFNESS] * speed + given.numbers[DAMPING] * bend)

    change.terminal, change.direction = True, 1
    turn.direction = -1
    states = np.full((len(given.instants), 13), math.nan)
    tugs: list[Tug] = []
    t, y, end = 0.0, given.start.copy(), float(given.instants[-1])
    began = clock.process_time()
    while t < end:
        wanted = given.instants[(given.instants > t) & (given.instants <= end)]
        made: Any = solve_ivp(
            derivative, (t, end), y, "DOP853", t_eval=wanted, events=(change, turn), rtol=max(size, 3e-14),
            atol=size * SCALES,
        )  # fmt: skip
        if len(made.t):
            states[np.searchsorted(given.instants, made.t)] = made.y.T
        peaks = [line(given.numbers, y_turn)[1] for y_turn in made.y_events[1]]
        if taut and tugs:
            peaks.append(tugs[-1].peak)
            tugs[-1] = Tug(tugs[-1].time, max(peaks))
        if made.status != 1:
            break
        t, y = float(made.t_events[0][0]), made.y_events[0][0]
        taut = not taut
        if taut:
            tugs.append(Tug(t, max(line(given.numbers, y)[1], 0.0)))
    return Found(told(given, tugs, states), clock.process_time() - began)


def by_cvode(method: str) -> Callable[[Mapping[str, float], float, Sequence[float]], Found]:
    """CVODE of SUNDIALS from change to change of the line, by one of its families."""

    def run(values: Mapping[str, float], size: float, instants: Sequence[float]) -> Found:
        from sksundae.cvode import CVODE

        given = problem(values, instants)
        rhs, line = compiled()
        state = {"taut": False}

        def derivative(_: float, y: Array, rate: Array) -> None:
            rhs(given.numbers, state["taut"], y, rate)

        def events(_: float, y: Array, found: Array) -> None:
            stretch, tension = line(given.numbers, y)
            found[0] = -tension if state["taut"] else min(stretch, tension)

        events.terminal, events.direction = [True], [1]
        states = np.full((len(given.instants), 13), math.nan)
        tugs: list[Tug] = []
        t, y, end = 0.0, given.start.copy(), float(given.instants[-1])
        period = (
            2.0
            * math.pi
            * math.sqrt(1.0 / given.numbers[STIFFNESS] / (1.0 / values["chaser.mass"] + 1.0 / values["target.mass"]))
        )
        began = clock.process_time()
        while t < end:
            solver = CVODE(
                derivative, method=method, rtol=max(size, 1e-15), atol=size * SCALES, max_num_steps=10_000_000,
                eventsfn=events, num_events=1,
            )  # fmt: skip
            wanted = given.instants[given.instants > t]
            fine = np.arange(t, min(t + 0.75 * period, end), period / 400.0) if state["taut"] else np.array([t])
            grid = np.unique(np.concatenate([[t], fine, wanted]))
            made = solver.solve(grid, y)
            places = np.searchsorted(given.instants, made.t)
            for place, at, row in zip(places, made.t, made.y, strict=True):
                if place < len(given.instants) and given.instants[place] == at:
                    states[place] = row
            if state["taut"]:
                tensions = np.array([line(given.numbers, row)[1] for row in made.y[: len(fine)]])
                tugs[-1] = Tug(tugs[-1].time, max(tugs[-1].peak, _vertex(tensions)))
            if made.t_events is None or not len(made.t_events):
                break
            t, y = float(made.t_events[-1]), np.array(made.y_events[-1])
            state["taut"] = not state["taut"]
            if state["taut"]:
                tugs.append(Tug(t, max(line(given.numbers, y)[1], 0.0)))
        return Found(told(given, tugs, states), clock.process_time() - began)

    return run


def _vertex(values: Array) -> float:
    """The largest of samples, with the parabola through it and its neighbours."""
    top = int(np.argmax(values))
    if not 0 < top < len(values) - 1:
        return float(values[top])
    before, here, after = values[top - 1 : top + 2]
    bend = before - 2.0 * here + after
    return float(here - (after - before) ** 2 / (8.0 * bend)) if bend < 0.0 else float(here)


def by_heyoka(values: Mapping[str, float], size: float, instants: Sequence[float]) -> Found:
    """heyoka's Taylor series, the line's state a parameter that its terminal events change."""
    import heyoka as hy

    given = problem(values, instants)
    names = [*(f"{n}{i}" for n in ("R", "V", "r", "v") for i in "xyz"), "J"]
    var = dict(zip(names, hy.make_vars(*names), strict=True))

    def vector(name: str) -> list[Any]:
        return [var[f"{name}{i}"] for i in "xyz"]

    def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]

    def cross(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]

    mu, mc, mt, thrust, k, c, length, end = (float(x) for x in given.numbers)
    whole = mc + mt
    big, speed, small, rate = vector("R"), vector("V"), vector("r"), vector("v")
    rc = [p - mt / whole * q for p, q in zip(big, small, strict=True)]
    rt = [p + mc / whole * q for p, q in zip(big, small, strict=True)]
    vc = [p - mt / whole * q for p, q in zip(speed, rate, strict=True)]
    gc = [-mu * p * dot(rc, rc) ** -1.5 for p in rc]
    gt = [-mu * p * dot(rt, rt) ** -1.5 for p in rt]
    along = cross(cross(rc, vc), rc)
    push = [thrust * p * dot(along, along) ** -0.5 for p in along]
    r = dot(small, small) ** 0.5
    lengthening = dot(small, rate) / r
    pull = k * (r - end - length) + c * lengthening
    tension = hy.par[0] * pull
    system = [
        *zip(big, speed, strict=True),
        *((v, (mc * a + mt * b + p) / whole) for v, a, b, p in zip(speed, gc, gt, push, strict=True)),
        *zip(small, rate, strict=True),
        *(
            (w, b - a - p / mc - tension * q / r * (1.0 / mc + 1.0 / mt))
            for w, a, b, p, q in zip(rate, gc, gt, push, small, strict=True)
        ),
        (var["J"], tension),
    ]
    _, line = compiled()
    tugs: list[Tug] = []

    def taut(ta: Any, _: int) -> bool:
        if ta.pars[0] == 0.0:
            ta.pars[0] = 1.0
            tugs.append(Tug(float(ta.time), max(line(given.numbers, ta.state)[1], 0.0)))
        return True

    def slack(ta: Any, _: int) -> bool:
        ta.pars[0] = 0.0
        return True

    def top(ta: Any, time: float, _: int) -> None:
        if ta.pars[0] == 1.0 and tugs:
            ta.update_d_output(time)
            tugs[-1] = Tug(tugs[-1].time, max(tugs[-1].peak, line(given.numbers, ta.d_output)[1]))

    up, down = hy.event_direction.positive, hy.event_direction.negative
    bend = (dot(rate, rate) + dot(small, [p for _, p in system[9:12]]) - lengthening * lengthening) / r
    ta = hy.taylor_adaptive(
        system, given.start, tol=max(size, 1e-18), pars=[0.0],
        t_events=[
            hy.t_event(r - end - length, callback=taut, direction=up),
            hy.t_event(hy.par[0] * pull - (1.0 - hy.par[0]), callback=slack, direction=down),
        ],
        nt_events=[hy.nt_event(k * lengthening + c * bend, callback=top, direction=down)],
    )  # fmt: skip
    began = clock.process_time()
    *_, states = ta.propagate_grid(np.concatenate([[0.0], given.instants]))
    return Found(told(given, tugs, states[1:]), clock.process_time() - began)


TOLERANCES = (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13)
PEERS = (
    Peer("scipy DOP853", "scipy", TOLERANCES[1:], able, by_scipy),
    Peer("CVODE Adams", "sksundae", TOLERANCES[1:-1], able, by_cvode("Adams")),
    Peer("CVODE BDF", "sksundae", TOLERANCES[1:-1], able, by_cvode("BDF")),
    Peer("heyoka Taylor", "heyoka", (1e-6, 1e-9, 1e-12, 1e-15, 1e-18), able, by_heyoka),
)
