"""The variables of a line of lumped nodes, and what they do not go with."""

from __future__ import annotations

from fmu_src.interface import Group, Term, Variable
from fmu_src.rows import at_least_zero, choice, output, peak, positive, rate, state
from fmu_src.tethered_deorbit import stress
from fmu_src.tethered_deorbit.body_rows import LARGEST
from fmu_src.tethered_deorbit.layout import CAPACITY, GATHERED, MOVED

WIDEST = LARGEST + MOVED + GATHERED
"""Components of the largest state of two bodies that turn on a line of nodes."""
DAMPED_AS = ("pair", "node")
AS_PAIR, AS_NODE = range(2)

NOT_WITH = (
    "sunlight",
    "electrodynamic",
    "plume",
    "appendage",
    "level",
)
"""Groups that know one massless piece alone."""
CARRIED = {"reel": ("locked",), "solver": ("dop853",), "target": ("point", "rigid"), "chaser": ("point", "rigid")}
"""Terms that go with nodes, of groups of which one is always named."""

NODES = Group(
    {
        "nodes": Term(
            "the line as nodes with mass between elastic pieces that pull and never push",
            (
                Variable("lumped.nodes", "1", "parameter", "nodes of the line, between one piece more", 10,
                         kind="Integer", minimum=1, maximum=CAPACITY),
                positive("lumped.density", "kg/m3", "of the line's load-bearing section: half a piece at either end is "
                         "part of the body's mass", 1440.0, 1e5),
                choice("lumped.damped_as", "what tether.damping_ratio is a share of: the critical damping of the pair "
                       "on the whole line, as that of one massless piece is, or of a node between two pieces",
                       DAMPED_AS),
                at_least_zero("lumped.toe_strain", "1", "over which the line's stiffness grows from nothing to its "
                              "full value", 0.0, 0.5),
                at_least_zero("lumped.end_compliance", "m/N", "in series with the piece at the target: that of a "
                              "closed net", 0.0, 1e6),
                output("lumped.mass", "kg", "of all nodes", 0.1),
                output("lumped.target_tension", "N", "of the piece at the target", 1.0),
                output("lumped.most_tension", "N", "of the piece that pulls hardest", 1.0),
                Variable("lumped.most_piece", "1", "output", "which that is, counted from the chaser; zero where none "
                         "pulls", 0, kind="Integer", minimum=0, maximum=CAPACITY + 1),
                peak("lumped.peak_tension", "N", "largest of any piece over the last macro step, where the "
                     "integrator's steps end", 1.0),
                Variable("lumped.peak_piece", "1", "output", "the piece that had it, counted from the chaser", 0,
                         kind="Integer", minimum=0, maximum=CAPACITY + 1),
                Variable("lumped.parted_piece", "1", "output", "which has broken, or was cut, counted from the chaser; "
                         "zero while the line is whole", 0, kind="Integer", minimum=0, maximum=CAPACITY + 1),
                peak("lumped.parted_energy", "J", "that it had stored, and is lost"),
                output("lumped.length", "m", "of the line along its pieces, stretched or slack", 10.0),
                output("lumped.deflection", "m", "largest distance of a node from the straight line between the "
                       "attachments", 1.0),
                output("lumped.node[#].position[#]", "m", "of each node from the target's centre of mass, inertial "
                       "axes; zero where there is none", 10.0, shape=(CAPACITY, 3)),
                output("lumped.heat", "J", "that the pieces' dashpots have taken, since the start", 0.01,
                       "rate.lumped_heat"),
                rate("lumped_heat", "W"),
                state("state.piece_length", "m", "unloaded, of every piece but the chaser's"),
                state("state.piece_stiffness", "N/m", "of such a piece"),
                state("state.piece_lag", "s", "dashpot of a piece over its stiffness"),
                state("state.node_mass", "kg", "of one"),
                state("state.nodes_fastest", "rad/s", "of the line's fastest motion"),
                state("state.nodes_reach", "s", "longest step over it"),
                state("state.shown_since", "s", "from when the inputs in force began to move to what was last shown"),
                state("state.end_length", "m", "of the piece at the chaser, as last seen"),
                state("state.end_speed", "m/s", "its rate"),
                state("state.end_acceleration", "m/s2", "and the rate of that"),
                state("state.nodes_peak", "N", "of the current macro step so far"),
                state("state.nodes_peak_piece", "1", "the piece that had it", kind="Integer"),
                state("state.ends[#][#]", "1", "attachments of the chaser and of the target, and their rates, from the "
                      "target's centre of mass", shape=(4, 3)),
                state("state.seen[#]", "1", "of a step, as it is: see `layout`", shape=(WIDEST,)),
                state("state.seen_rate[#]", "1", "and its rate", shape=(WIDEST,)),
                state("state.node_room[#][#]", "1", "room for vectors", shape=(6, 3)),
                state("state.node_motion[#][#]", "1", "room for places and velocities", shape=(5, 6)),
            ),
            excludes=NOT_WITH,
            carries=CARRIED,
            extremes=stress.NODES,
        ),
    },
    optional=True,
    follows=lambda terms, values: "nodes",
)  # fmt: skip
