"""Other programs on the same problems, where they are installed (extra `peers`): their error against CPU time.

    tow    an elastic line between two bodies on an orbit: scipy, CVODE, heyoka
    net    a net that opens freely: scipy, CVODE, MuJoCo

Each has the equations written anew, in the form that its users would write, with compiled right-hand sides where it
takes any; what it compiles is not counted. Each begins where our FMU does, and what it finds is compared in the same
quantities. A peer is offered only for what it can compute: a phase with terms of which it knows nothing has none.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from importlib.util import find_spec

from dcone_cosim.accuracy.peers import net, tow
from dcone_cosim.accuracy.peers.peer import Found, Peer
from dcone_cosim.scene.data import PhaseScene

PEERS: Mapping[str, Sequence[Peer]] = {"tow": tow.PEERS, "net": net.PEERS}


def peers_of(phase: PhaseScene, notes: list[str]) -> Iterator[tuple[str, Peer]]:
    """Those that are installed and can compute a phase, with what they compute.

    notes      gets which could and are not installed
    """
    for what, peers in PEERS.items():
        for peer in peers:
            if not peer.able(phase):
                continue
            if find_spec(peer.package) is None:
                notes.append(f"{phase.name}: {peer.name} is not installed: pip install 'dcone-cosim[peers]'")
            else:
                yield what, peer


def run(what: str, name: str, values: Mapping[str, float], size: float, instants: Sequence[float]) -> Found:
    """What the peer of that name finds; see `Peer`."""
    peer = next(peer for peer in PEERS[what] if peer.name == name)
    return peer.run(values, size, instants)
