"""What acts on every body: the pull of gravity seen in the orbital frame of the target's initial centre of mass.

A kick takes a velocity from half a substep before an instant to half a substep after it, by the acceleration of that
instant. It also predicts the velocity of the *next* instant, v + dv/2, which the dashpots see then: taken half a
substep back, their force would make the scheme one of first order.
"""

from fmu_src.net_capture.topology import FX, FY, FZ, INVERSE_MASS, MASS, P, Q, R, U, V, W, X, Z, node_plane
from orbital.hill import hill_acceleration, hill_jacobi
from orbital.kernel import kernel


@kernel
def kick(velocity, predicted, force, inverse_mass, h):
    """Velocities half a substep on, and those predicted for the next instant.

        v(t + h/2) = v(t - h/2) + dv,   v(t + h) = v(t + h/2) + dv/2,   dv = h F/m

    Source   leapfrog; the prediction is the straight line through the last two velocities
    Checked  tests/net_capture/test_threads.py
    """
    for j in range(velocity.size):
        change = h * (force[j] * inverse_mass[j])
        velocity[j] += change
        predicted[j] = velocity[j] + 0.5 * change


@kernel
def no_kick_nodes(p, work, start, n, h):
    """Kick one chunk of nodes that feel their threads alone."""
    stop = start + n
    inverse = node_plane(p, work, INVERSE_MASS)[start:stop]
    for axis in range(3):
        kick(
            node_plane(p, work, U + axis)[start:stop],
            node_plane(p, work, P + axis)[start:stop],
            node_plane(p, work, FX + axis)[start:stop],
            inverse,
            h,
        )


@kernel
def hill_kick(x, z, u, v, w, pu, pv, pw, fx, fy, fz, inverse, n, h):
    """Velocities half a substep on under forces and Hill's equations, and those predicted for the next instant.

        du/dt = F_x/m + 3 n^2 x + 2 n v,   dv/dt = F_y/m - 2 n u,   dw/dt = F_z/m - n^2 z

    The Coriolis acceleration takes the mean of the velocities before and after, which is solved for: it turns the
    velocity and does no work.

    Valid    distances small against the orbital radius, circular orbit
    Source   Hill 1878; Clohessy and Wiltshire 1960; the mean velocity as in Boris' pusher of charged particles (1970)
    Checked  tests/net_capture/test_contact.py, test_free_flight.py
    """
    c = n * h
    share = 1.0 / (1.0 + c * c)
    for j in range(x.size):
        a = u[j] + c * v[j] + h * (fx[j] * inverse[j] + 3.0 * n * n * x[j])
        b = v[j] - c * u[j] + h * (fy[j] * inverse[j])
        change = share * (a + c * b) - u[j]
        u[j] += change
        pu[j] = u[j] + 0.5 * change
        change = share * (b - c * a) - v[j]
        v[j] += change
        pv[j] = v[j] + 0.5 * change
        change = h * (fz[j] * inverse[j] - n * n * z[j])
        w[j] += change
        pw[j] = w[j] + 0.5 * change


@kernel
def hill_kick_nodes(p, work, start, n, h):
    """Kick one chunk of nodes that feel their threads and gravity."""
    stop = start + n
    hill_kick(
        node_plane(p, work, X)[start:stop],
        node_plane(p, work, Z)[start:stop],
        node_plane(p, work, U)[start:stop],
        node_plane(p, work, V)[start:stop],
        node_plane(p, work, W)[start:stop],
        node_plane(p, work, P)[start:stop],
        node_plane(p, work, Q)[start:stop],
        node_plane(p, work, R)[start:stop],
        node_plane(p, work, FX)[start:stop],
        node_plane(p, work, FY)[start:stop],
        node_plane(p, work, FZ)[start:stop],
        node_plane(p, work, INVERSE_MASS)[start:stop],
        p.mean_motion,
        h,
    )


@kernel
def no_kick_body(p, position, velocity, acceleration, h):
    """Kick a body that feels nothing but an acceleration of its own [m/s2]."""
    for i in range(3):
        velocity[i] += h * acceleration[i]


@kernel
def hill_kick_body(p, position, velocity, acceleration, h):
    """Kick a body that feels gravity and an acceleration of its own [m/s2], as `hill_kick` does."""
    n = p.mean_motion
    c = n * h
    a = velocity[0] + c * velocity[1] + h * (acceleration[0] + 3.0 * n * n * position[0])
    b = velocity[1] - c * velocity[0] + h * acceleration[1]
    velocity[0] = (a + c * b) / (1.0 + c * c)
    velocity[1] = (b - c * a) / (1.0 + c * c)
    velocity[2] += h * (acceleration[2] - n * n * position[2])


@kernel
def no_weigh_nodes(p, work):
    """Nothing acts."""


@kernel
def hill_weigh_nodes(p, work):
    """Add gravity's apparent force [N] to the force planes, for measures at the instant: its velocities are those
    that half the forces make."""
    mass = node_plane(p, work, MASS)
    half = 0.5 * p.solver_substep
    at = p.scratch[0:3]
    speed = p.scratch[3:6]
    pull = p.scratch[6:9]
    for j in range(mass.size):
        if mass[j] > 0.0:
            for axis in range(3):
                at[axis] = node_plane(p, work, X + axis)[j]
                speed[axis] = node_plane(p, work, U + axis)[j] + half * node_plane(p, work, FX + axis)[j] / mass[j]
            hill_acceleration(pull, at, speed, p.mean_motion)
            for axis in range(3):
                node_plane(p, work, FX + axis)[j] += mass[j] * pull[axis]


@kernel
def hill_potential(p, position):
    """Potential energy per mass [J/kg] at a place in the orbital frame, that of the Jacobi integral."""
    rest = p.scratch[0:3]
    for i in range(3):
        rest[i] = 0.0
    return hill_jacobi(position, rest, p.mean_motion)


@kernel
def potential_of_nodes(p, work):
    """Potential energy [J] of all nodes in the orbital frame."""
    mass = node_plane(p, work, MASS)
    at = p.scratch[3:6]
    total = 0.0
    for j in range(mass.size):
        if mass[j] > 0.0:
            for axis in range(3):
                at[axis] = node_plane(p, work, X + axis)[j]
            total += mass[j] * hill_potential(p, at)
    return total


@kernel
def hill_rate(p):
    """Rate at which the frame turns about its third axis [rad/s]."""
    return p.mean_motion


@kernel
def no_rate(p):
    """The frame does not turn."""
    return 0.0
