"""One piece of a line of nodes: how hard it pulls, what it stores, and how fast a chain of them can move."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.tethered_deorbit.node_rows import AS_NODE
from orbital.kernel import kernel
from orbital.oscillators import dashpot, line_stiffness, reduced_mass


@kernel
def tune(record: Any) -> None:
    """Properties of the pieces from the parameters.

        l_p = L/(N + 1)   k_p = EA/l_p   m = rho A l_p
        tau = c/k = 2 zeta sqrt(m_r L/EA), or by a node between two pieces 2 zeta sqrt(m/(2 k_p))

    Pieces of one lag tau in series have it together, so that with `pair` the whole line has the dashpot of one piece.

    Source   springs and dashpots in series
    Checked  tests/tethered_deorbit/test_nodes.py: one massless piece
    """
    r = record[0]
    r.state_piece_length = r.tether_rest_length / (r.lumped_nodes + 1.0)
    r.state_piece_stiffness = line_stiffness(r.tether_youngs_modulus, r.tether_diameter, r.state_piece_length)
    section = 0.25 * math.pi * r.tether_diameter * r.tether_diameter
    r.state_node_mass = r.lumped_density * section * r.state_piece_length
    if r.lumped_damped_as == AS_NODE:
        mass, firm = r.state_node_mass, 2.0 * r.state_piece_stiffness
    else:
        mass, firm = reduced_mass(r.chaser_mass, r.target_mass), r.state_piece_stiffness / (r.lumped_nodes + 1.0)
    r.state_piece_lag = dashpot(r.tether_damping_ratio, firm, mass) / firm


@kernel
def unloaded(record: Any, piece: int, since: float) -> tuple[float, float]:
    """Unloaded length of a piece [m] and its rate [m/s]; line is wound out at the chaser, piece 0.

        l_0 = L/(N + 1) + offset

    since         since the offset began to move                 [s]

    Checked  tests/tethered_deorbit/test_nodes.py: line wound out
    """
    r = record[0]
    if piece > 0:
        return r.state_piece_length, 0.0
    return r.state_piece_length + r.state_command + r.state_command_rate * since, r.state_command_rate


@kernel
def whole(record: Any, piece: int) -> bool:
    """Whether a piece has neither broken nor been cut.

    Checked  tests/tethered_deorbit/test_nodes_parted.py
    """
    return bool(record[0].lumped_parted_piece != piece + 1)


@kernel
def part(record: Any, piece: int, length: float, since: float) -> None:
    """A piece of this length [m] pulls no more from now on; what it had stored is gone, and booked.

    Checked  tests/tethered_deorbit/test_nodes_parted.py: energy
    """
    r = record[0]
    r.lumped_parted_energy = stored(record, piece, length, since)
    r.lumped_parted_piece = piece + 1


@kernel
def stiffness(record: Any, piece: int, length: float) -> float:
    """Stiffness [N/m] of a piece of an unloaded length [m].

        1/k = l/EA + C at the target, C the compliance of what holds the line there

    Source   springs in series
    Checked  tests/tethered_deorbit/test_nodes.py: a closed net in series
    """
    r = record[0]
    along: float = r.state_piece_stiffness * r.state_piece_length / length
    if piece < r.lumped_nodes:
        return along
    return float(along / (1.0 + along * r.lumped_end_compliance))


@kernel
def pull(record: Any, piece: int, length: float, rate: float, since: float) -> tuple[float, float, float]:
    """Tension of a piece [N], the part of its spring [N], and the stiffness in force [N/m].

        T = max(0, f + tau f' (dl/dt - dl_0/dt))   f = k x^2/(2 t) up to a stretch of t, and from there k (x - t/2)

    x is the stretch, t its part in the toe. Zero where x is not above zero, and where the piece is not whole.

    length, rate  of the piece                                   [m], [m/s]

    Valid    small strains
    Source   a spring and a dashpot beside it that pull and never push; toe after the stress-strain curves of ropes
    Checked  tests/tethered_deorbit/test_nodes.py
    """
    rest, moving = unloaded(record, piece, since)
    stretch = length - rest
    if not (stretch > 0.0 and whole(record, piece)):
        return 0.0, 0.0, 0.0
    toe = record[0].lumped_toe_strain * rest
    slope = stiffness(record, piece, rest)
    if stretch < toe:
        slope *= stretch / toe
        spring = 0.5 * slope * stretch
    else:
        spring = slope * (stretch - 0.5 * toe)
    return max(0.0, spring + record[0].state_piece_lag * slope * (rate - moving)), spring, slope


@kernel
def slopes(record: Any, length: float, rate: float, since: float) -> tuple[float, float, float]:
    """Derivatives of the tension of the chaser's piece by its length [N/m], the rate of that [N s/m] and its unloaded
    length [N/m].

    length, rate  of the piece                                   [m], [m/s]

    Checked  tests/tethered_deorbit/test_nodes.py, against differences
    """
    r = record[0]
    force, spring, firm = pull(record, 0, length, rate, since)
    if not force > 0.0:
        return 0.0, 0.0, 0.0
    rest, moving = unloaded(record, 0, since)
    stretch, toe = length - rest, r.lumped_toe_strain * rest
    lagging = r.state_piece_lag * (rate - moving)
    if stretch < toe:
        steeper = firm / stretch
        return (
            firm + lagging * steeper,
            r.state_piece_lag * firm,
            (-firm - 2.0 * spring / rest - lagging * (steeper + 2.0 * firm / rest)),
        )
    return firm, r.state_piece_lag * firm, -firm - (spring + 0.5 * firm * toe + lagging * firm) / rest


@kernel
def stored(record: Any, piece: int, length: float, since: float) -> float:
    """Elastic energy of a piece [J].

        k x^3/(6 t) up to a stretch of t, and from there k (x - t/2)^2/2 + k t^2/24

    length        of the piece                                   [m]

    Source   integral of the spring's part in `pull`
    Checked  tests/tethered_deorbit/test_nodes.py: energy
    """
    rest, _ = unloaded(record, piece, since)
    stretch = length - rest
    if not (stretch > 0.0 and whole(record, piece)):
        return 0.0
    toe = record[0].lumped_toe_strain * rest
    firm = stiffness(record, piece, rest)
    if stretch < toe:
        return float(firm * stretch * stretch * stretch / (6.0 * toe))
    beyond = stretch - 0.5 * toe
    return float(0.5 * firm * beyond * beyond + firm * toe * toe / 24.0)


@kernel
def fastest(record: Any, shortest: float) -> tuple[float, float]:
    """Bound of the line's fastest motion [rad/s], and the share of critical damping of it [-].

        w = sqrt(k a), z = tau w/2, and w max(1, 2 z);   a = max(4/m, 2/m + 1/m_b)

    By Gershgorin's circles a is no less than the largest eigenvalue of the pieces' own matrix, in which a piece has the
    inverse masses of both its ends and hands on that of a node it shares; m_b is the least mass that a massless
    line has to move, which is below that of either body.

    shortest      length that the chaser's piece comes to        [m]

    Valid    stretches small enough for the sideways stiffness T/l to be less than k
    Source   Gershgorin; a chain of N equal nodes between walls has 2 sqrt(k/m) cos(pi/(2 (N + 1)))
    Checked  tests/tethered_deorbit/test_nodes.py: against the eigenvalues
    """
    r = record[0]
    firm = r.state_piece_stiffness * max(1.0, r.state_piece_length / shortest)
    node, body = 1.0 / r.state_node_mass, 1.0 / r.state_effective_mass
    ease = 2.0 * node + body
    if r.lumped_nodes > 1:
        ease = max(ease, 4.0 * node)
    rate = math.sqrt(firm * ease)
    share = 0.5 * r.state_piece_lag * rate
    return rate * max(1.0, 2.0 * share), share


@kernel
def stored_by_length(record: Any, length: float, since: float) -> float:
    """Derivative of the energy of the chaser's piece by its unloaded length [N].

    length        of the piece                                   [m]

    Checked  tests/tethered_deorbit/test_nodes.py, against differences
    """
    _, spring, firm = pull(record, 0, length, 0.0, since)
    if not spring > 0.0:
        return 0.0
    rest, _ = unloaded(record, 0, since)
    strain = record[0].lumped_toe_strain
    toe, energy = strain * rest, stored(record, 0, length, since)
    if length - rest < toe:
        return float(-spring - 2.0 * energy / rest)
    return float(-energy / rest - spring * (1.0 + 0.5 * strain) + firm * strain * toe / 12.0)
