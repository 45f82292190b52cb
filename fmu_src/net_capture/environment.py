"""What acts on every body: the pull of gravity seen in the orbital frame of the target's initial centre of mass."""

from fmu_src.net_capture.topology import U, V, W, X, Z, node_plane
from orbital.hill import hill_acceleration
from orbital.kernel import kernel


@kernel
def hill_kick(x, z, u, v, w, n, h):
    """Velocities from Hill's equations, over a chunk.

        du/dt = 3 n^2 x + 2 n v,   dv/dt = -2 n u,   dw/dt = -n^2 z

    Valid    distances small against the orbital radius, circular orbit
    Source   Hill 1878; Clohessy and Wiltshire 1960
    Checked  tests/net_capture/test_contact.py, test_free_flight.py
    """
    for j in range(x.size):
        old = u[j]
        u[j] += h * (3.0 * n * n * x[j] + 2.0 * n * v[j])
        v[j] -= h * (2.0 * n * old)
        w[j] -= h * (n * n * z[j])


@kernel
def hill_kick_nodes(p, work, start, n, h):
    """Hill's acceleration on one chunk of nodes."""
    stop = start + n
    hill_kick(
        node_plane(p, work, X)[start:stop],
        node_plane(p, work, Z)[start:stop],
        node_plane(p, work, U)[start:stop],
        node_plane(p, work, V)[start:stop],
        node_plane(p, work, W)[start:stop],
        p.mean_motion,
        h,
    )


@kernel
def hill_kick_body(p, position, velocity, h):
    """Hill's acceleration on one body."""
    hill_acceleration(p.scratch[0:3], position, velocity, p.mean_motion)
    for i in range(3):
        velocity[i] += h * p.scratch[i]


@kernel
def no_kick_nodes(p, work, start, n, h):
    """Nothing acts."""


@kernel
def no_kick_body(p, position, velocity, h):
    """Nothing acts."""


@kernel
def hill_rate(p):
    """Rate at which the frame turns about its third axis [rad/s]."""
    return p.mean_motion


@kernel
def no_rate(p):
    """The frame does not turn."""
    return 0.0
