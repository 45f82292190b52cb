"""What holds of a gravity that does nothing on its own: bodies that nothing pulls fly straight on, in a frame that does
not turn."""

from orbital.kernel import kernel


@kernel
def start(p):
    """Nothing to do."""


@kernel
def rate(p):
    """The frame does not turn."""
    return 0.0


@kernel
def kick_body(p, place, velocity, pull, h):
    """Kick a body that feels nothing but an acceleration of its own [m/s2].

    Checked  tests/net_capture/test_threads.py
    """
    for i in range(3):
        velocity[i] += h * pull[i]


@kernel
def stray(p, distance, speed, time):
    """A free flight is straight [m]."""
    return 0.0


@kernel
def accelerate(p, out, position, velocity):
    """Nothing accelerates a free node.

    Checked  tests/net_capture/test_threads.py
    """
    for i in range(3):
        out[i] = 0.0


@kernel
def potential(p, position):
    """There is none [J/kg]."""
    return 0.0


@kernel
def body_potential(p):
    """There is none [J]."""
    return 0.0
