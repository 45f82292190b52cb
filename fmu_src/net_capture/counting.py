"""What a net comes to before it is laid out: its nodes and threads, whether these fit the outputs that list them, and
the size of the work memory."""

from __future__ import annotations

from typing import Any

from fmu_src.net_capture.composition import Composition
from fmu_src.net_capture.interface import TOO_MANY_NODES, TOO_MANY_THREADS
from fmu_src.net_capture.planes import work_size
from orbital.kernel import kernel


def make_check(parts: Composition) -> Any:
    """The kernel `check(p, work) -> fault code or 0`, which sets the counts and the size of a model's memory."""
    terms, graph, folding, scheme = parts.terms, parts.graph, parts.folding, parts.scheme
    has_ejection, ejection = parts.ejection is not None, parts.ejection
    has_nodes, has_threads = "nodes" in terms, "threads" in terms
    capacity = int(terms["nodes"]) if has_nodes else 0
    thread_capacity = int(terms["threads"]) if has_threads else 0
    has_wrap, wrap, has_bending, bending = parts.wrap is not None, parts.wrap, parts.bending is not None, parts.bending
    masks, per_double = parts.traits.masks, parts.per_double
    too_many_nodes, too_many_threads = (parts.code(fault.name) for fault in (TOO_MANY_NODES, TOO_MANY_THREADS))

    @kernel
    def check(p, work):
        """Fault code of a parameter combination that makes no net, or 0; sets the counts.

        Checked  tests/net_capture/test_free_flight.py
        """
        fault = graph.count(p, work)
        if fault == 0:
            fault = folding.check(p)
        if has_ejection and fault == 0:
            fault = ejection.check(p)
        if fault != 0:
            return fault
        if has_nodes:
            if p.net_nodes > capacity:
                p.fault_value = p.net_nodes
                return too_many_nodes
        if has_threads:
            if p.net_threads > thread_capacity:
                p.fault_value = p.net_threads
                return too_many_threads
        words = scheme.own_words(p) + masks * p.strips
        if has_wrap:
            words += wrap.words(p)
        if has_bending:
            words += bending.words(p)
        p.work_size = work_size(p, per_double, words)
        return 0

    return check
