"""The terms of the net capture model: what each adds, and the variables it brings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from fmu_src.interface import Term, Variable

TRIGGERS = ("time", "first_contact", "distance", "command")
LARGEST_MESH = 400
"""Meshes times segments per side: an instance then takes 30 MB."""
MOST_NODES = (LARGEST_MESH + 1) ** 2
"""Nodes of the largest net there is, one of uncut threads: each brings three outputs, so more would be of no use."""


def vector(
    name: str, unit: str, description: str, causality: str = "output", start: object = 0.0, **more: object
) -> Variable:
    """Three components of one quantity."""
    return Variable(f"{name}[#]", unit, causality, description, start, shape=(3,), **more)  # type: ignore[arg-type]


def moving(name: str, description: str, velocity: str, nominal: float = 10.0) -> tuple[Variable, Variable]:
    """A position and its velocity, three components each."""
    return (
        vector(f"{name}.position", "m", description, nominal=nominal, rate=f"{name}.velocity[#]"),
        vector(f"{name}.velocity", "m/s", velocity, nominal=1.0),
    )


def peak(name: str, unit: str, description: str, **more: object) -> Variable:
    """A Real output that remembers: it stands still but for jumps."""
    return output(name, unit, description, discrete=True, **more)


def output(name: str, unit: str, description: str, **more: object) -> Variable:
    """A Real output."""
    return Variable(name, unit, "output", description, **more)  # type: ignore[arg-type]


def state(name: str, unit: str, description: str, **more: object) -> Variable:
    """A Real that only the kernels see."""
    return Variable(name, unit, "state", description, **more)  # type: ignore[arg-type]


def positive(name: str, unit: str, description: str, start: float, **more: object) -> Variable:
    """A Real parameter greater than zero."""
    return Variable(name, unit, "parameter", description, start, minimum=0.0, open_minimum=True, **more)  # type: ignore[arg-type]


def at_least_zero(name: str, unit: str, description: str, start: float, **more: object) -> Variable:
    """A Real parameter that may be zero but not less."""
    return Variable(name, unit, "parameter", description, start, minimum=0.0, **more)  # type: ignore[arg-type]


def flag(name: str, description: str) -> Variable:
    """A Boolean output."""
    return Variable(name, "1", "output", description, False, kind="Boolean")


def count(name: str, description: str, causality: str = "output") -> Variable:
    """An Integer that counts."""
    return Variable(name, "1", causality, description, 0, kind="Integer", minimum=0)  # type: ignore[arg-type]


NET = {
    "square": Term(
        "planar square net of square meshes",
        (
            positive("net.side", "m", "side of the flat net", 24.0),
            positive("net.mesh", "m", "knot spacing: a design choice; the net keeps its mass", 1.0),
            Variable(
                "net.segments",
                "1",
                "parameter",
                "pieces each thread is cut into: a numerical choice",
                1,
                kind="Integer",
                minimum=1,
                maximum=64,
            ),
            positive("net.mass", "kg", "mass of all threads", 0.33),
            positive("net.youngs_modulus", "Pa", "of the thread", 70e9, display_unit="GPa"),
            positive("net.density", "kg/m3", "of the thread", 1440.0),
            at_least_zero("net.damping_ratio", "1", "xi in d = 2 xi sqrt(k m) of a thread and an inner node", 0.106),
            positive("net.fold_side", "m", "side of the flat square the net is folded into", 0.5),
        ),
    )
}

GRAVITY = {
    "none": Term("inertial drift"),
    "hill": Term(
        "relative motion about the target's circular orbit",
        (
            Variable(
                "orbit.altitude",
                "m",
                "parameter",
                "of the circular orbit, over the equatorial radius",
                800e3,
                minimum=100e3,
                maximum=1e8,
                display_unit="km",
            ),
            output(
                "energy.potential",
                "J",
                "of all bodies in the orbital frame: m n2 (z2 - 3 x2) / 2, less n times the target's spin about the "
                "orbit normal; with the kinetic energies it makes the Jacobi integral",
            ),
            state("mean_motion", "rad/s", "of the orbital frame"),
        ),
    ),
}

TARGET = {
    "box": Term(
        "free box that takes the reaction of every contact",
        (
            Variable(
                "target.size[#]",
                "m",
                "parameter",
                "edges along the body axes",
                (4.0, 8.0, 4.0),
                shape=(3,),
                minimum=0.0,
                open_minimum=True,
            ),
            positive("target.mass", "kg", "mass of the target", 1000.0),
            Variable(
                "target.principal_inertia[#]",
                "kg.m2",
                "parameter",
                "about the body axes; zero: uniform box",
                0.0,
                shape=(3,),
                minimum=0.0,
            ),
            Variable(
                "target.start_attitude[#]",
                "1",
                "parameter",
                "quaternion from body to orbital frame, scalar first; zero: aligned",
                0.0,
                shape=(4,),
            ),
            Variable(
                "target.start_rate[#]",
                "rad/s",
                "parameter",
                "body rate in body axes, relative to inertial space",
                0.0,
                shape=(3,),
                display_unit="deg/s",
            ),
            *moving("target", "centre of mass, orbital frame", "of the centre of mass, orbital frame"),
            Variable(
                "target.attitude[#]", "1", "output", "quaternion from body to orbital frame, scalar first", shape=(4,)
            ),
            Variable(
                "target.rate[#]",
                "rad/s",
                "output",
                "body rate in body axes, relative to inertial space",
                shape=(3,),
                display_unit="deg/s",
            ),
            Variable("target.inertia[#]", "kg.m2", "output", "about the body axes", shape=(3,)),
            vector("target.spin", "N.m.s", "angular momentum about the target's centre of mass, orbital axes"),
            state("target_place[#]", "m", "centre of mass at the last substep", shape=(3,)),
            state("target_drift[#]", "m/s", "velocity of the centre of mass half a substep back", shape=(3,)),
            state("target_pose[#]", "1", "attitude at the last substep", shape=(4,)),
            state("girth", "m", "smallest girth"),
            output("target.energy", "J", "kinetic energy of translation and spin of the target"),
        ),
    )
}

CONTACT = {
    "inelastic": Term(
        "impact that takes the normal velocity relative to the surface",
        (
            Variable(
                "contact.restitution",
                "1",
                "parameter",
                "share of the normal speed that comes back",
                0.0,
                minimum=0.0,
                maximum=1.0,
            ),
            count("contact.nodes", "nodes now on the surface"),
            peak("contact.first_time", "s", "first touch, since the shot; -1 before"),
            peak("contact.impulse", "N.s", "sum of the sizes of all impulses so far"),
            state("half_size[#]", "m", "half the edges of the target", shape=(3,)),
            Variable("target_turn[#][#]", "1", "state", "rotation matrix from body to frame", shape=(3, 3)),
            state("target_omega[#]", "rad/s", "rate of the target relative to the frame, frame axes", shape=(3,)),
            state("envelope_radius", "m", "of the sphere around the target"),
            peak("contact.loss", "J", "kinetic energy lost in contact so far"),
        ),
        needs=("target",),
    )
}

CLOSING = {
    "winches": Term(
        "cord between neighbouring bullets, drawn by winches that stall and never pay out",
        (
            Variable(
                "closing.trigger",
                "1",
                "parameter",
                "what starts the winches; close.command always does",
                0,
                kind="Integer",
                minimum=0,
                maximum=len(TRIGGERS) - 1,
                choices=TRIGGERS,
            ),
            at_least_zero("closing.time", "s", "when the winches start, since the shot, for trigger time", 11.2),
            Variable(
                "closing.distance",
                "m",
                "parameter",
                "bullets this far beyond the target's centre of mass, along "
                "the shot axis, start the winches, for trigger distance",
                0.0,
            ),
            at_least_zero("closing.delay", "s", "from the trigger to the start of the winches", 0.0),
            positive("closing.speed", "m/s", "no-load speed of each winch: a 24 m side in 5 s", 5.0),
            positive("closing.stall_force", "N", "tension at which a winch stands still", 5.0),
            Variable(
                "closing.rings",
                "1",
                "parameter",
                "on each side of the mouth, evenly spaced, through which the cord between two bullets runs without "
                "friction; without any the sides stay open loops",
                1,
                kind="Integer",
                minimum=0,
                maximum=64,
            ),
            positive("closing.axial_stiffness", "N", "EA of the cord: 0.5 mm nylon", 903.0),
            at_least_zero("closing.damping_ratio", "1", "of the cord between two bullets", 0.106),
            positive("closing.lock_length", "m", "a pair is locked when its cord is shorter than this", 0.25),
            positive(
                "closing.timeout",
                "s",
                "after this long since the trigger a mouth that is not closed behind the target counts as not closed",
                20.0,
            ),
            Variable("close.command", "1", "input", "start the winches", False, kind="Boolean"),
            output(
                "mouth.cord_length",
                "m",
                "length of cord still out: the way round the bullets can not be longer, the net's slack sides can",
            ),
            output("mouth.girth", "m", "smallest girth of the target, which the mouth would have to pass"),
            peak(
                "mouth.margin_at_capture",
                "m",
                "girth of the target less cord out, at the instant of capture; -1 before",
            ),
            peak(
                "enclosure.share",
                "1",
                "share of the target's sample points that net and mouth go round, at the last look; "
                "-1 until the cord is shorter than the girth",
            ),
            peak("enclosure.at_capture", "1", "that share at the instant of capture; -1 before"),
            peak("enclosure.least", "1", "least share since the capture; -1 before"),
            peak("t_lost", "s", "instant at which the target was out of the net again after a capture; -1 before"),
            state("enclosure_since", "s", "since when enough of the target to count as caught has been inside"),
            state("enclosure_last_in", "s", "when enough of the target was last inside"),
            count("mouth.locked_pairs", "pairs of bullets whose cord is shorter than the lock length"),
            peak("cord.tension_max", "N", "largest tension of the cord since the start"),
            peak("cord.tension_peak", "N", "largest tension of the cord over the last macro step"),
            output("closing.work", "J", "work done by the winches so far"),
            output("cord.dissipated", "J", "taken by the cord's dashpots so far"),
            peak("closing.t_start", "s", "when the winches started, since the shot; -1 before"),
            state("cord_length[#]", "m", "cord out between neighbouring bullets", shape=(4,)),
            state("cord_rate[#]", "m/s", "rate of that length", shape=(4,)),
            state("cord_force[#]", "N", "what each winch works against per length wound", shape=(4,)),
            state("cord_mass", "kg", "that a pair's cord moves as it lengthens"),
            state("cord_power", "W", "what the cord's dashpots take now"),
            state("cord_loss", "J", "taken by the cord's dashpots up to half a substep back"),
            state("trigger_time", "s", "when the trigger fell, since the shot; -1 before"),
        ),
    )
}

TETHER = {
    "slack": Term(
        "tether that pays out freely; a tension signal may be injected where it is made fast",
        (
            positive("tether.length", "m", "length that can be paid out", 100.0),
            Variable("tether.vertex_tension", "N", "input", "tension at the vertex, towards the chaser", nominal=1.0),
            output("tether.paid_out", "m", "distance from the chaser to the vertex"),
            output("tether.work", "J", "work done by the tension signal so far"),
            state("tether_reach", "m", "distance from the chaser to the vertex at the last substep"),
        ),
    )
}

SETTLING = {
    "speed": Term(
        "when the net counts as settled",
        (
            positive("settling.speed", "m/s", "speed of the net's centre of mass relative to the target", 0.1),
            positive("settling.time", "s", "how long it must stay below", 2.0),
            state("calm_since", "s", "since when the net has been slow, from the shot"),
        ),
    )
}


class NodeTerms(Mapping[str, Term]):
    """A term for any number of nodes: `{"nodes": "625"}` gives an FMU with outputs for up to 625 nodes."""

    def __getitem__(self, capacity: str) -> Term:
        if capacity not in self:
            raise KeyError(capacity)
        position = Variable(
            "node[#].position[#]",
            "m",
            "output",
            "node of the net, orbital frame, row by row of the "
            "flat net (knots first, then the inner nodes of the threads)",
            shape=(int(capacity), 3),
        )
        return Term(f"position of every node, up to {capacity} nodes", (position,))

    def __contains__(self, capacity: object) -> bool:
        return (
            isinstance(capacity, str)
            and capacity.isascii()
            and capacity.isdecimal()
            and len(capacity) <= len(str(MOST_NODES))
            and 1 <= int(capacity) <= MOST_NODES
        )

    def __iter__(self) -> Iterator[str]:
        return iter((f"a whole number of nodes, from 1 to {MOST_NODES}",))

    def __len__(self) -> int:
        return 1
