"""Where everything lies in the work memory, and which thread joins which nodes.

Node quantities are planes, one after another, each as long as there are node slots; thread quantities likewise. Threads
are ordered in *strips*: strip (a, b, count, first) holds the threads first + j between nodes a + j and b + j, j <
count, so that every loop runs over slices with unit stride and a net of any mesh, cut into any number of segments, is
data.

Square net of K knots per side, each thread cut into s segments:

    knots                   i K + j                               K^2 slots
    p-th inner node of the thread from knot (i, j) along j        K^2 slots each, p = 0 .. s-2 (column K-1 is unused)
    p-th inner node of the thread from knot (i, j) along i        K (K-1) slots each

A strip along j runs through all rows at once; its lanes from the end of a row to the start of the next join nothing:
their rest length is infinite, so they never pull.
"""

import math

from orbital.kernel import kernel, view

X, Y, Z, P, Q, R, FX, FY, FZ, U, V, W, INVERSE_MASS, MASS = range(14)
"""Node planes: position [m], velocity predicted for the same instant [m/s], force [N], velocity half a substep back
[m/s], 1/m [1/kg] (zero: unused slot), m [kg]."""
NODE_PLANES = 14

LENGTH_SQUARED, PEAK = range(2)
"""Thread planes: squared rest length [m2], infinite where nothing is joined; peak tension in this macro step [N]."""
THREAD_PLANES = 2

CHUNK = 256
"""Lanes handled at once: long enough to hide the cost of a call, short enough to stay in the first cache."""


@kernel
def node_slots(knots, segments):
    """Slots in each node plane."""
    return knots * knots + (segments - 1) * (2 * knots * knots - knots)


@kernel
def thread_slots(knots, segments):
    """Slots in each thread plane, the lanes that join nothing included."""
    return segments * (2 * knots * knots - knots) - 1


@kernel
def strip_count(segments):
    """Strips along both directions."""
    return 2 * segments


@kernel
def work_size(knots, segments):
    """Doubles of work memory: node planes, thread planes, strips, two chunks of scratch."""
    return (
        NODE_PLANES * node_slots(knots, segments)
        + THREAD_PLANES * thread_slots(knots, segments)
        + 4 * strip_count(segments)
        + 2 * CHUNK
    )


@view
def node_plane(p, work, plane):
    """One node plane as a slice."""
    n = p.node_slots
    return work[plane * n : (plane + 1) * n]


@view
def thread_plane(p, work, plane):
    """One thread plane as a slice."""
    base = NODE_PLANES * p.node_slots
    n = p.thread_slots
    return work[base + plane * n : base + (plane + 1) * n]


@view
def strip_table(p, work):
    """The strips as a flat slice: a, b, count, first of each."""
    base = NODE_PLANES * p.node_slots + THREAD_PLANES * p.thread_slots
    return work[base : base + 4 * p.strips]


@view
def chunk_scratch(p, work):
    """Scratch for two chunks of lanes."""
    base = NODE_PLANES * p.node_slots + THREAD_PLANES * p.thread_slots + 4 * p.strips
    return work[base : base + 2 * CHUNK]


@kernel
def gather(lanes, amount):
    """Write the numbers of the lanes with a positive amount one after another; no branch to mispredict."""
    found = 0
    for j in range(amount.size):
        lanes[found] = j
        found += 1 if amount[j] > 0.0 else 0


@kernel
def lay_out_strips(p, work):
    """Write the strip table of a square net."""
    knots = p.knots
    segments = p.net_segments
    square = knots * knots
    oblong = square - knots
    table = strip_table(p, work)
    first = 0
    q = 0
    for direction in range(2):
        across = direction == 0
        size = square if across else oblong
        inner = square if across else square + (segments - 1) * square
        step = 1 if across else knots
        for s in range(segments):
            last = s == segments - 1
            table[q] = 0 if s == 0 else inner + (s - 1) * size
            table[q + 1] = step if last else inner + s * size
            count = square - 1 if (across and last) else size
            table[q + 2] = count
            table[q + 3] = first
            first += count
            q += 4


@kernel
def lay_out_threads(p, work):
    """Give every thread its squared rest length, and lanes that join nothing an infinite one."""
    squared = thread_plane(p, work, LENGTH_SQUARED)
    table = strip_table(p, work)
    for q in range(p.strips):
        first = int(table[4 * q + 3])
        across = q < p.net_segments
        for j in range(int(table[4 * q + 2])):
            real = not (across and j % p.knots == p.knots - 1)
            squared[first + j] = p.thread_length * p.thread_length if real else math.inf


@kernel
def lay_out_masses(p, work):
    """Half of every thread to each of its nodes, then the bullets and the vertex; unused slots get no mass."""
    mass = node_plane(p, work, MASS)
    inverse = node_plane(p, work, INVERSE_MASS)
    squared = thread_plane(p, work, LENGTH_SQUARED)
    half = 0.5 * p.net_mass / p.net_threads
    table = strip_table(p, work)
    for q in range(p.strips):
        a = int(table[4 * q])
        b = int(table[4 * q + 1])
        first = int(table[4 * q + 3])
        for j in range(int(table[4 * q + 2])):
            if squared[first + j] < math.inf:
                mass[a + j] += half
                mass[b + j] += half
    for corner in range(4):
        mass[bullet_node(p.knots, corner)] += p.bullets_mass
    for i in range(4):
        mass[vertex_node(p.knots, i)] += 0.25 * p.vertex_mass
    for i in range(mass.size):
        inverse[i] = 1.0 / mass[i] if mass[i] > 0.0 else 0.0


@kernel
def bullet_node(knots, corner):
    """Knot that carries a bullet; corners 0 to 3 follow one another around the mouth."""
    row = 0 if corner < 2 else knots - 1
    column = 0 if corner == 0 or corner == 3 else knots - 1
    return row * knots + column


@kernel
def vertex_node(knots, i):
    """The i-th of the four knots that share the vertex: the central knot four times, or the central mesh."""
    row = (knots - 1 + (i // 2)) // 2 if knots % 2 == 0 else knots // 2
    column = (knots - 1 + (i % 2)) // 2 if knots % 2 == 0 else knots // 2
    return row * knots + column
