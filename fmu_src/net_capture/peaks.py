"""The largest tensions so far, of the net's own threads and of each line that is rigged to it.

Whoever works out a tension notes it under its thread's number: the net's come first, then the edge rope's, then those
of the leads.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from orbital.kernel import kernel


class Peaks(NamedTuple):
    """Kernels of the peaks.

    start(p)                    nothing has borne anything yet
    renew(p)                    a macro step begins
    so_far(p, thread)           largest tension in this macro step of the line that a thread is of [N]
    note(p, thread, tension)    a tension larger than that
    kept(p), put_back(p, kept)  what has been noted, and it once more: what was noted meanwhile did not happen
    collect(p)                  the largest since the start
    """

    start: Any
    renew: Any
    so_far: Any
    note: Any
    kept: Any
    put_back: Any
    collect: Any


def make_peaks(composition: Any) -> Peaks:
    """Kernels of the composition's net and what is rigged to it; threads are counted from 1."""
    has_edge, has_leads = "edge" in composition.terms, "leads" in composition.terms

    @kernel
    def renew(p):
        """A macro step begins.

        Checked  tests/net_capture/test_rigging.py
        """
        p.thread_tension_peak = 0.0
        if has_edge:
            p.edge_tension_peak = 0.0
        if has_leads:
            p.leads_tension_peak = 0.0

    @kernel
    def start(p):
        """Nothing has borne anything yet.

        Checked  tests/net_capture/test_rigging.py
        """
        renew(p)
        p.thread_tension_max = 0.0
        p.thread_tension_max_index = 0
        p.thread_peak_index = 0
        if has_edge:
            p.edge_tension_max = 0.0
        if has_leads:
            p.leads_tension_max = 0.0

    @kernel
    def so_far(p, thread):
        """Largest tension in this macro step of the line that a thread is of [N].

        Checked  tests/net_capture/test_rigging.py
        """
        if has_leads:
            if thread > p.leads_thread:
                return p.leads_tension_peak
        if has_edge:
            if thread > p.edge_thread:
                return p.edge_tension_peak
        return p.thread_tension_peak

    @kernel
    def note(p, thread, tension):
        """A tension [N] larger than that.

        Checked  tests/net_capture/test_rigging.py
        """
        if has_leads:
            if thread > p.leads_thread:
                p.leads_tension_peak = tension
                return
        if has_edge:
            if thread > p.edge_thread:
                p.edge_tension_peak = tension
                return
        p.thread_tension_peak = tension
        p.thread_peak_index = thread

    @kernel
    def kept(p):
        """What has been noted.

        Checked  tests/net_capture/test_schemes.py
        """
        edge = p.edge_tension_peak if has_edge else 0.0
        leads = p.leads_tension_peak if has_leads else 0.0
        return p.thread_tension_peak, p.thread_peak_index, edge, leads

    @kernel
    def put_back(p, noted):
        """What was noted once more.

        Checked  tests/net_capture/test_schemes.py
        """
        p.thread_tension_peak, p.thread_peak_index, edge, leads = noted
        if has_edge:
            p.edge_tension_peak = edge
        if has_leads:
            p.leads_tension_peak = leads

    @kernel
    def collect(p):
        """The largest tension since the start, and of which of the net's threads.

        Checked  tests/net_capture/test_quality.py
        """
        if p.thread_tension_peak > p.thread_tension_max:
            p.thread_tension_max = p.thread_tension_peak
            p.thread_tension_max_index = p.thread_peak_index
        if has_edge:
            p.edge_tension_max = max(p.edge_tension_max, p.edge_tension_peak)
        if has_leads:
            p.leads_tension_max = max(p.leads_tension_max, p.leads_tension_peak)

    return Peaks(start, renew, so_far, note, kept, put_back, collect)
