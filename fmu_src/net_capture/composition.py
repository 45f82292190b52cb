"""The parts of one model as they come together: each is made with what was made before it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Any

from fmu_src import tables
from fmu_src.interface import Model, Term
from fmu_src.net_capture.capture_index import SCRATCH_PLANES
from fmu_src.net_capture.cord_bends import make_cord_bends
from fmu_src.net_capture.graph import make_graph
from fmu_src.net_capture.numbering import make_numbering
from fmu_src.net_capture.peaks import make_peaks
from fmu_src.net_capture.planes import NODE_PLANES, make_memory
from fmu_src.net_capture.release import BOOKED
from fmu_src.net_capture.rigging import riggings
from fmu_src.net_capture.self_contact.reaches import PLANES as SELF_PLANES
from fmu_src.net_capture.self_contact.segments import stiffening
from orbital.kernel import kernel


@dataclass(frozen=True)
class Pulls:
    """Kernels of all that pulls single nodes.

    pull(p, work)         add its forces, for a substep
    pull_shown(p, work)   the same for the positions and velocities shown
    book(p, duration)     what it gave and took in a time at its present forces [s]: dashpots, the tether's impulse
    """

    pull: Any
    pull_shown: Any
    book: Any


class Composition:
    """What the kernels of a part are made from.

    terms        of the model, by group
    lanes        vectors of its precision (`fmu_src.lanes`)
    memory       kernels that find what lies in the work memory
    bullets      how many there are
    rouse, rouse_all    of the scheme, see `schemes.Needs`
    everywhere(p)    half the stiffness over mass [1/s2], and dashpots over mass [1/s], that contact and bending may add
                     at any node
    scratch_plane            the first of the node planes that the convex hull may scribble on, where there are any
    wall_plane       the node plane of what lies in the canister, where its wall holds on to it
    self_contact_plane       the first of those of threads that touch each other
    density_of(p, strip)     of the material of a strip [kg/m3]
    books_turn       whether what the release gives the chaser of angular momentum is booked, see `release.BOOKED`
    traits, clock, meeting   of the pace, see `pace.Traits`
    presses          whether the contact adds to the stiffness at a node, and stores energy
    contact_planes   the first node plane that is the contact's own
    gravity, net, numbering, rigging, graph, peaks, folding, target, gradient, force_map, contact, cord_bends, jam,
    closing, tether, air, wrap, spin, ejection, volume, index, pull_off, hardest, bending, wall, sliding, self_contact,
    pulls, pace, breaking, scheme
                 kernels of these parts; None for what the scene leaves out
    """

    def __init__(self, model: Model, terms: Mapping[str, str]) -> None:
        from fmu_src.lanes import of

        self.model, self.terms = model, terms
        self._tables = model.interface(terms).tables
        self.books_turn = BOOKED[0] in model.interface(terms).variables
        self._codes = {fault.name: fault.code for fault in model.faults}
        self.needs = needs = self._term("solver").checks
        self.traits = traits = self._term("substeps").checks
        self.clock = traits.clock
        law = self._term("contact").checks if "contact" in terms else None
        self.presses = law is not None and law.stiffening is not None
        self.everywhere = _make_everywhere(self.presses, "bending" in terms, "self_contact" in terms)
        self.density_of = _make_density_of("edge" in terms, "leads" in terms)
        self.contact_planes = NODE_PLANES + needs.planes + traits.planes
        self.scratch_plane = self.contact_planes + (law.planes if law is not None else 0)
        self.lanes = of(terms["precision"])
        self.per_double = self.lanes.width // 4
        scratch = SCRATCH_PLANES * self.per_double if "quality" in terms else 0
        self.wall_plane = self.scratch_plane + scratch
        self.self_contact_plane = self.wall_plane + (1 if "wall" in terms else 0)
        self.planes = self.self_contact_plane + (SELF_PLANES if "self_contact" in terms else 0)
        self.memory = make_memory(terms["precision"])
        self.bullets = int(terms["bullets"])
        self.gravity = self._make("gravity")
        self.rouse, self.rouse_all = needs.make_rouse(self), needs.make_rouse_all(self)
        self.meeting = traits.make_meeting(self)
        self.net, self.folding = self._make("net"), self._make("folding")
        self.numbering = make_numbering(self)
        self.rigging = [self._make(group) for group in riggings() if group in terms]
        self.graph, self.peaks = make_graph(self), make_peaks(self)
        self.target = self._make("target")
        self.gradient = self._make("gravity_gradient")
        self.force_map = self._make("force_map")
        self.contact = self._make("contact")
        self.cord_bends = make_cord_bends(self)
        self.jam = self._make("jam")
        self.closing, self.tether = self._make("closing"), self._make("tether")
        self.volume, self.air = self._make("volume"), self._make("air")
        self.index, self.pull_off = self._make("quality"), self._make("pull_off")
        self.hardest = self._make("tensions")
        self.spin = self._make("spin")
        self.ejection = self._make("ejection")
        self.wrap, self.bending = self._make("wrap"), self._make("bending")
        self.wall, self.sliding = self._make("wall"), self._make("table")
        self.self_contact = self._make("self_contact")
        self.pulls = _make_pulls(
            (self.ejection, self.wall, self.sliding),
            self.closing,
            self.tether,
            self.air,
            self.bending,
            self.pull_off,
            self.wrap,
            self.self_contact,
        )
        self.pace, self.breaking = self._make("substeps"), self._make("break")
        self.scheme = self._make("solver")

    def _term(self, group: str) -> Term:
        return self.model.groups[group].terms[self.terms[group]]

    def _make(self, group: str) -> Any:
        if group not in self.terms:
            return None
        term = self._term(group)
        if term.make is None:
            raise ValueError(f"{self.model.name}: no kernel implements {group} = {self.terms[group]!r}")
        return term.make(self)

    def code(self, name: str) -> int:
        """Code of a fault, by its name."""
        return self._codes[name]

    def table(self, name: str) -> Any:
        """Kernel `table(p) -> array`: a table that a part of this model brings, to be read only."""
        return tables.make_reader(self._tables, name)


@kernel
def _nothing(p, work):
    """Pull nothing.

    Checked  tests/net_capture/test_closing.py
    """


def _make_density_of(has_edge: bool, has_leads: bool) -> Any:
    """Kernel `density_of` of a net with a rope along its edge or leads, or without."""

    @kernel
    def density_of(p, strip):
        """Of the material of a strip [kg/m3].

        Checked  tests/net_capture/test_air.py
        """
        if has_leads:
            if strip >= p.leads_strip:
                return p.leads_density
        if has_edge:
            if strip >= p.edge_strip:
                return p.edge_density
        return p.net_density

    return density_of


def _make_everywhere(presses: bool, resists: bool, touches: bool) -> Any:
    """Kernel `everywhere`, of contact that presses, threads that resist bending, and threads that touch each other."""

    @kernel
    def everywhere(p):
        """What may be added at any node: half the stiffness over mass [1/s2], dashpots over mass [1/s].

        Checked  tests/net_capture/test_bending.py
        """
        stiffness = p.contact_stiffening if presses else 0.0
        damping = 0.0
        if resists:
            stiffness += p.bending_stiffening
            damping = p.bending_damping_time * p.bending_stiffening
        if touches:
            stiffness += stiffening(p.self_contact_duration)
        return stiffness, damping

    return everywhere


def _both(first: Any, second: Any) -> Any:
    """Kernel that calls two, one after the other."""

    @kernel
    def both(p, work):
        """Call two kernels, one after the other.

        Checked  tests/net_capture/test_closing.py
        """
        first(p, work)
        second(p, work)

    return both


def _make_pulls(holding: tuple[Any, ...], closing: Any, tether: Any, air: Any, bending: Any, *others: Any) -> Pulls:
    """Pulls of cord, tether, air, bending and others together, and what is held; None for those left out."""
    has_closing, has_tether, has_air = closing is not None, tether is not None, air is not None
    has_bending = bending is not None
    book_impulse = tether.book if has_tether else None
    parts = [part for part in (closing, tether, air, bending, *others) if part is not None]
    pulls = [part.pull for part in parts]
    pulls = [part.wake for part in holding if part is not None] + pulls

    @kernel
    def book(p, duration):
        """What the cord's dashpots, air and bending took in a time at their present power [J]; the tether's impulse.

        Checked  tests/net_capture/test_closing.py
        """
        if has_closing:
            p.cord_loss += duration * p.cord_power
        if has_tether:
            book_impulse(p, duration)
        if has_air:
            p.air_loss += duration * p.air_power
        if has_bending:
            p.bending_loss += duration * p.bending_power

    return Pulls(reduce(_both, pulls, _nothing), reduce(_both, (part.pull_shown for part in parts), _nothing), book)
