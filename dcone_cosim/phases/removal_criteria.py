"""What must hold of a tow: a line that only pulls, snaps of their size, an orbit and an integral that are kept."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from dcone_cosim.criteria import Criterion, Evidence, finite, rise
from dcone_cosim.fmu.steppable import Row
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU, STANDARD_GRAVITY
from orbital.oscillators import damped_snap_peak, line_stiffness, reduced_mass

ACCURATE, STABLE = 0.01, 0.05
SNAP = 0.005
"""Share by which a snap may miss its closed form, beside what the forces that act meanwhile may add to it: what the
turning of the frame takes of it, 1 - cos(phi) < phi^2/2, where it is as slow as FAST allows."""
TUGS = 5
"""Tugs from the first on that are compared."""
FAST = math.pi / math.sqrt(2.0 * SNAP)
"""Radians of a line's motion in a radian of the orbit, or of a body that turns, from which on its snaps are quick
enough for the closed form: one lasts half a period, pi/omega, in which the frame turns by phi = pi n/omega."""
SLOW = 1e-3
"""Thrust over weight up to which an orbit falls as a spiral does, and share by which the axis may change while the
orbit counts as one circle."""


COARSE = 0.25
"""Radians from row to row up to which trapezoids tell a work [1]: of what goes round once they leave h^2/12, half a
percent, of what goes round twice two percent; over whole turns nothing."""
FREE = "none"
"""The environment without a field."""
OTHER_WORK = frozenset({"thrust", "air", "third_bodies", "sunlight", "release", "break"})
"""Groups that do work on an orbit, or leave two of one."""


def criteria(evidence: Evidence) -> Iterator[Criterion]:
    """All that can be asked of these outputs."""
    yield finite(evidence)
    if len(evidence.columns["time"]) < 2:
        return
    yield from _line(evidence)
    yield from _takes(evidence)
    yield from _orbit(evidence)
    yield from _conducts(evidence)
    if evidence.terms.get("reel") == "locked":
        if "lumped" not in evidence.terms:  # a line with mass, toe or compliance has no such closed forms
            yield from _longer(evidence)
            yield from _snaps(evidence)
        yield from _jacobi(evidence)
        yield from _work(evidence)
    elif evidence.has("reel.paid_out", "tether.length", "tether.tension_peak"):
        yield from _longer_than_wound(evidence)


def force(evidence: Evidence) -> float:
    """Thrust [N] along its direction; 0 without a thruster."""
    if "thrust" not in evidence.terms:
        return 0.0
    return evidence.values["thrust.level"] + evidence.values["thrust.offset"]


def changes(evidence: Evidence) -> bool:
    """Whether thrust or masses are others than the scene's level and masses say, on the way."""
    return bool({"burn", "engine", "plume"} & evidence.terms.keys())


def pushed(evidence: Evidence) -> Row:
    """Change of the velocity of the pair's centre of mass by thrust along its direction, over every step [m/s]: what of
    its impulse does not meet the target, over the mass that is left.

    The impulse is that of the propellant used: a pulse between two rows counts as well.
    """
    columns, (chaser, target, _) = evidence.columns, _masses(evidence)
    thrust = force(evidence)
    if not changes(evidence):
        return np.asarray(thrust / (chaser + target) * np.diff(columns["time"]))
    used = columns["chaser.propellant"]
    impulse = math.copysign(evidence.values["thrust.specific_impulse"] * STANDARD_GRAVITY, thrust) * np.diff(used)
    if "plume" in evidence.terms and evidence.values["plume.pushes"]:
        share = columns["plume.share"]
        impulse = impulse * (1.0 - 0.5 * (share[1:] + share[:-1]))
    lost = 0.5 * (used[1:] + used[:-1]) if "engine" in evidence.terms else 0.0
    return np.asarray(impulse / (chaser + target - lost))


def _masses(evidence: Evidence) -> tuple[float, float, float]:
    """Of the pair: chaser, target, reduced [kg]."""
    chaser, target = evidence.values["chaser.mass"], evidence.values["target.mass"]
    return chaser, target, reduced_mass(chaser, target)


def _stiffness(evidence: Evidence) -> float:
    values = evidence.values
    line = line_stiffness(values["tether.youngs_modulus"], values["tether.diameter"], _rest(evidence))
    return line / (1.0 + line * values.get("net.compliance", 0.0))


def _rest(evidence: Evidence) -> float:
    return evidence.values["tether.rest_length"] + evidence.values["reel.length_offset"]


def _line(evidence: Evidence) -> Iterator[Criterion]:
    """A line never pushes, and its impulse only grows."""
    columns = evidence.columns
    if not evidence.has("tether.tension", "tether.tension_peak", "tether.tension_least", "tether.impulse"):
        return
    size = max(float(columns["tether.tension_peak"].max()), 1e-300)
    pushed = max(0.0, -float(min(columns["tether.tension"].min(), columns["tether.tension_least"].min()))) / size
    yield Criterion("pushes", "tension below zero", pushed, "1", 0.0, 0.0)
    outside = np.maximum(columns["tether.tension"] - columns["tether.tension_peak"], 0.0).max() / size
    yield Criterion("peaks", "tension above its own peak", float(outside), "1", 1e-9, 1e-6)
    impulse = columns["tether.impulse"]
    back = rise(-impulse) / max(float(impulse.max()), 1e-300)
    yield Criterion("impulse", "impulse of the line given back", back, "1", 1e-9, 1e-6)


def _takes(evidence: Evidence) -> Iterator[Criterion]:
    """Dashpots of a line of nodes and friction on a table give nothing back."""
    for name, label in (("lumped.heat", "the line's dashpots"), ("friction.loss", "friction")):
        if evidence.has(name):
            taken = evidence.columns[name]
            back = rise(-taken) / max(float(np.abs(taken).max()), 1e-300)
            yield Criterion(f"{name.partition('.')[0]}_takes", f"energy given by {label}", back, "1", 1e-6, 1e-3)


def _longer(evidence: Evidence) -> Iterator[Criterion]:
    """No longer than its largest tension stretches it, beside what rounding makes of a length."""
    columns = evidence.columns
    if not evidence.has("tether.length", "tether.tension_peak"):
        return
    rest, stiffness = _rest(evidence), _stiffness(evidence)
    allowed = float(columns["tether.tension_peak"].max()) / stiffness
    beyond = float(columns["tether.length"].max()) - rest - allowed
    share = max(beyond, 0.0) / (allowed + 1e-12 * rest)
    yield Criterion("longer", "stretch beyond peak tension over stiffness", share, "1", 1e-3, ACCURATE)


def _longer_than_wound(evidence: Evidence) -> Iterator[Criterion]:
    """The same of a line that is wound: beyond what is wound out at that instant."""
    columns, values = evidence.columns, evidence.values
    longest = float(columns["reel.paid_out"].max())
    stiffness = line_stiffness(values["tether.youngs_modulus"], values["tether.diameter"], longest)
    allowed = float(columns["tether.tension_peak"].max()) / stiffness
    beyond = float((columns["tether.length"] - columns["reel.paid_out"]).max()) - allowed
    share = max(beyond, 0.0) / (allowed + 1e-12 * longest)
    yield Criterion("longer", "stretch beyond peak tension over stiffness", share, "1", 1e-3, ACCURATE)


def _snaps(evidence: Evidence) -> Iterator[Criterion]:
    """The first tugs that are over, against the closed form of a snap, with what other forces add at most.

        |T - T_snap| <= 2 P,   P = m_r (3 (1 + e) mu/r_p^3 l + 2 n_p w + w^2/l + 2 mu_f g) + F m_t/M

    r_p, n_p   least radius of the orbit, its rate there; without a field n_p is zero and the tide too  [m], [rad/s]
    w          speed of the bodies across the line, at most                                             [m/s]
    mu_f g     what friction slows each body by, at most; zero without a table                          [m/s2]

    The motion is linear while the line is taut, so the tension is that of the snap and that of a force P put on a line
    at rest, m x'' = P - T, which starts at 0 and stays between 0 and 2 P at any damping ratio.

    A body that turns gives way: off its centre the line moves less mass, and the snap is no harder than on points,

        T <= max(v sqrt(k m_r), c v) + 2 P

    Source   `orbital.oscillators.damped_snap_peak`; tide 2 mu/r^3 and n^2 along the line, Coriolis, centrifugal
    Checked  tests/stability/test_judge.py
    """
    values = evidence.values
    chaser, target, reduced = _masses(evidence)
    stiffness, zeta = _stiffness(evidence), values["tether.damping_ratio"]
    rate, across, rest = _quickest(evidence), _across(evidence), _rest(evidence)
    slowed = 2.0 * values["friction.coefficient"] * values["friction.gravity"] if "friction" in evidence.terms else 0.0
    steady = reduced * (3.0 * rate**2 * rest + 2.0 * rate * across + across**2 / rest + slowed)
    steady += abs(force(evidence)) * target / (chaser + target)
    quickness = math.sqrt(stiffness / reduced)
    if quickness < FAST * max(rate, _spin(evidence)):
        return  # so long a snap is part of the motion of orbit and bodies
    points = evidence.terms.get("target", "point") == evidence.terms.get("chaser", "point") == "point"
    begin, end = evidence.columns["time"][0], evidence.columns["time"][-1]
    # one at the start has no speed of its own, and one that is younger than half a vibration may still grow
    worst, compared = 0.0, 0
    for _, peak, speed in [tug for tug in evidence.tugs if begin < tug[0] <= end - math.pi / quickness][:TUGS]:
        if not speed > 0.0:
            continue
        expected = damped_snap_peak(speed, stiffness, reduced, zeta)
        miss = abs(peak - expected)
        if not points:
            expected = speed * math.sqrt(stiffness * reduced) * max(1.0, 2.0 * zeta)
            miss = peak - expected
        off = max(0.0, miss - 2.0 * steady) / max(expected, 2.0 * steady)
        worst, compared = max(worst, off), compared + 1
    if compared:
        yield Criterion("snap", "peaks of the first tugs from the closed form", worst, "1", SNAP, SNAP)


def _quickest(evidence: Evidence) -> float:
    """Rate of the orbit at its perigee [rad/s]; 0 without a field."""
    if evidence.terms.get("environment") == FREE:
        return 0.0
    eccentricity = evidence.values["orbit.eccentricity"]
    perigee = (EARTH_EQUATORIAL_RADIUS + evidence.values["orbit.altitude"]) * (1.0 - eccentricity)
    return math.sqrt((1.0 + eccentricity) * EARTH_MU / perigee**3)


def _spin(evidence: Evidence) -> float:
    """Rate of the body that turns fastest at the start [rad/s]; 0 of points."""
    rates = [
        math.hypot(*(evidence.values[f"{role}.start_rate[{axis}]"] for axis in (1, 2, 3)))
        for role in ("target", "chaser")
        if f"{role}.start_rate[1]" in evidence.values
    ]
    return max(rates, default=0.0)


def _across(evidence: Evidence) -> float:
    """Largest speed of the bodies across the line between them [m/s]; 0 where it is not told."""
    if not evidence.has("relative.position", "relative.velocity"):
        return 0.0
    place, velocity = evidence.vector("relative.position"), evidence.vector("relative.velocity")
    lengths = np.maximum(np.linalg.norm(place, axis=1), 1e-300)
    return float((np.linalg.norm(np.cross(place, velocity), axis=1) / lengths).max())


def _orbit(evidence: Evidence) -> Iterator[Criterion]:
    """Without thrust the orbit keeps its energy; with one, it changes by its work, and falls as a spiral does.

        a = (1/sqrt(a0) - F t/(sqrt(mu) M))^-2,   exactly as long as F a^2/(mu M) is small and the orbit circular
        d(E/M) = int F/M V.u dt                   on any other, and where F or M change on the way; u along-track or
                                                  along the velocity, E/M = -mu/(2a)

    Source   Gauss's equation for the semi-major axis, e = 0; work of a force
    """
    columns, values = evidence.columns, evidence.values
    if not evidence.has("center.semi_major_axis", "separation", "center.position", "center.velocity"):
        return
    chaser, target, _ = _masses(evidence)
    total, thrust = chaser + target, force(evidence)
    axis, time = columns["center.semi_major_axis"], columns["time"] - columns["time"][0]
    bend = 3.0 * (float(columns["separation"].max()) / float(axis.min())) ** 2
    if thrust == 0.0:
        change = float(np.abs(axis / axis[0] - 1.0).max())
        yield Criterion("orbit", "semi-major axis, which nothing changes", change, "1", bend + 1e-9, 10.0 * bend + 1e-7)
        return
    if evidence.terms["thrust"] not in ("along_track", "velocity"):
        return
    small = abs(thrust) * float(axis.max()) ** 2 / (EARTH_MU * total)
    # an osculating axis swings by 2 F a^2/(mu M) of itself beside falling, and by what the pair's own motion moves it
    swing = (4.0 * small + bend + 1e-11) * axis[0]
    if values["orbit.eccentricity"] == 0.0 and small < SLOW and not changes(evidence):
        spiral = (1.0 / math.sqrt(axis[0]) - thrust * time / (math.sqrt(EARTH_MU) * total)) ** -2
        fallen = max(abs(float(spiral[-1] - axis[0])), 1e-300)
        off = max(0.0, float(np.abs(axis - spiral).max()) - swing) / fallen
        yield Criterion("orbit", "fall of the orbit from that of a spiral", off, "1", ACCURATE, STABLE)
        return
    place, velocity = evidence.vector("center.position"), evidence.vector("center.velocity")
    along = np.linalg.norm(velocity, axis=1)
    if evidence.terms["thrust"] == "along_track":
        along = np.linalg.norm(np.cross(place, velocity), axis=1) / np.linalg.norm(place, axis=1)
    done = np.concatenate([[0.0], np.cumsum(0.5 * (along[1:] + along[:-1]) * pushed(evidence))])
    energy = -0.5 * EARTH_MU / axis
    off = float(np.abs(energy - energy[0] - done).max()) - 0.5 * EARTH_MU * (bend + 1e-11) / float(axis.min())
    share = max(0.0, off) / max(float(np.abs(done).max()), 1e-300)
    yield Criterion("orbit", "energy of the orbit from the work of the thrust", share, "1", ACCURATE, STABLE)


def _conducts(evidence: Evidence) -> Iterator[Criterion]:
    """A conducting line without a source gives nothing to the air's frame, and takes from the orbit what it says.

        E(t) - E(0) = -int P dt,   E of the orbit with its flattening, P the power that the force takes from it

    The integral is that of trapezoids through what is told, where the pair turns by less than COARSE from row to row,
    on its orbit and by itself, and nothing else does work.
    """
    columns, time = evidence.columns, evidence.columns["time"]
    if not evidence.has("electrodynamic.power", "electrodynamic.orbit_power"):
        return
    power, taken = columns["electrodynamic.power"], columns["electrodynamic.orbit_power"]
    given = max(0.0, -float(power.min())) / max(float(np.abs(power).max()), 1e-300)
    yield Criterion("generates", "power that a line without a source gives", given, "1", 1e-9, 1e-6)
    place, velocity = evidence.vector("center.position"), evidence.vector("center.velocity")
    rates = np.linalg.norm(np.cross(place, velocity), axis=1) / np.einsum("ij,ij->i", place, place)
    apart, drift = evidence.vector("relative.position"), evidence.vector("relative.velocity")
    own = np.linalg.norm(drift, axis=1) / np.maximum(np.linalg.norm(apart, axis=1), 1e-300)
    turned = float(((rates + own)[1:] * np.diff(time)).max())
    if OTHER_WORK & evidence.terms.keys() or turned > COARSE or not taken.any():
        return
    work = np.concatenate([[0.0], np.cumsum(0.5 * (taken[1:] + taken[:-1]) * np.diff(time))])
    energy = columns["energy.orbital"]
    # what the pair's own motion may hold of it, as in `_jacobi`
    held = 1.5 * float(rates.max()) ** 2 * _masses(evidence)[2] * float(columns["separation"].max()) ** 2
    off = max(0.0, float(np.abs(energy - energy[0] + work).max()) - held)
    label = "energy of the orbit from what the conducting line takes"
    yield Criterion("orbit_taken", label, off / float(np.abs(work).max()), "1", ACCURATE, STABLE)


def _jacobi(evidence: Evidence) -> Iterator[Criterion]:
    """On a circle the relative motion's integral never rises, and stays where nothing damps.

        J = E + m_r F/m_c s,   E the Jacobi integral, F the thrust, s from chaser to target along-track, or along the
                               line where the thrust is

    With the heat that a line of nodes tells it stays whatever damps. In units of the energy that the tide gives a line
    of that length, 3/2 n^2 m_r l^2; while thrust changes n little.
    Source   work of F on the relative motion, whose acceleration by it is -F/m_c
    """
    columns, values = evidence.columns, evidence.values
    if (
        evidence.terms.get("environment") == FREE
        or changes(evidence)
        or values["orbit.eccentricity"] > 0.0
        or not evidence.has("energy.relative", "relative.position", "separation", "center.semi_major_axis")
    ):
        return
    axis = columns["center.semi_major_axis"]
    if float(np.abs(axis / axis[0] - 1.0).max()) > SLOW:
        return
    if float(columns["separation"].max()) > 1e-3 * EARTH_EQUATORIAL_RADIUS:
        return  # the integral holds to first order in length over radius
    chaser, _, reduced = _masses(evidence)
    rate = EARTH_MU / (EARTH_EQUATORIAL_RADIUS + values["orbit.altitude"]) ** 3
    size = 1.5 * rate * reduced * float(columns["separation"].max()) ** 2
    along = columns["separation"] if evidence.terms.get("thrust") == "tether" else columns["relative.position[2]"]
    heat = columns["lumped.heat"] + columns["lumped.parted_energy"] if "lumped" in evidence.terms else 0.0
    energy = (columns["energy.relative"] + heat + reduced / chaser * force(evidence) * along) / size
    yield Criterion("jacobi", "integral of the relative motion above what it was", rise(energy), "1", ACCURATE, STABLE)
    if values["tether.damping_ratio"] == 0.0 or "lumped" in evidence.terms:
        label = "integral of the relative motion below what it was"
        yield Criterion("jacobi_falls", label, rise(-energy), "1", ACCURATE, STABLE)


def _work(evidence: Evidence) -> Iterator[Criterion]:
    """Without a field the pair has no more energy than the work of its thrust less what friction took; and no less
    where nothing damps.

        W = M V^2/2 + E + Q - F y_c,   E of relative motion and line, Q by friction, y_c of the chaser along the thrust

    In units of all that came in: the energy at the start, and the work. With the heat that a line of nodes tells it
    stays whatever damps.
    Source   work of a constant force
    Checked  tests/stability/test_judge.py
    """
    columns, terms = evidence.columns, evidence.terms
    if terms.get("environment") != FREE or terms.get("thrust", "along_track") != "along_track" or changes(evidence):
        return
    if {"release", "break", "aocs"} & terms.keys() or not evidence.has(
        "energy.relative", "center.velocity", "chaser.position"
    ):
        return
    chaser, target, _ = _masses(evidence)
    mass = chaser + target + (float(columns["lumped.mass"][0]) if "lumped.mass" in columns else 0.0)
    energy = columns["energy.relative"] + 0.5 * mass * (evidence.vector("center.velocity") ** 2).sum(axis=1)
    if "lumped" in terms:
        energy = energy + columns["lumped.heat"] + columns["lumped.parted_energy"]
    work = force(evidence) * (columns["chaser.position[2]"] - columns["chaser.position[2]"][0])
    size = max(float(energy[0]), 0.0) + float(np.abs(work).max())
    if not size > 0.0:
        return
    kept = (energy + (columns["friction.loss"] if "friction" in terms else 0.0) - work) / size
    yield Criterion("work", "energy of the pair above the work done on it", rise(kept), "1", 1e-3, ACCURATE)
    if evidence.values["tether.damping_ratio"] == 0.0 or "lumped" in terms:
        yield Criterion("work_lost", "energy of the pair below the work done on it", rise(-kept), "1", 1e-3, ACCURATE)
