"""What a user may not expect of a shot."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from fmu_src.cautions import ARAMID, NYLON, Caution, Seen, fibre_of, heavily_damped, low, strained

Values = Mapping[str, float]


def before(values: Values, given: Collection[str], terms: Mapping[str, str]) -> Iterator[Caution]:
    """From what the scene says."""
    for sentence in low(values["orbit.altitude"]) if "orbit.altitude" in values else ():
        yield Caution("orbit.altitude", sentence)
    yield from heavily_damped("net.damping_ratio", values.get("net.damping_ratio"), "a thread's going taut")
    yield from heavily_damped("closing.damping_ratio", values.get("closing.damping_ratio"), "the cord's going taut")


def after(values: Values, given: Collection[str], terms: Mapping[str, str], seen: Seen) -> Iterator[Caution]:
    """From what came out."""
    thread, cord = seen("thread.tension_max"), seen("cord.tension_max")
    if (
        thread is not None
        and {"net.side", "net.mesh", "net.mass", "net.density", "net.youngs_modulus"} <= values.keys()
    ):
        from fmu_src.net_capture.implied import (
            thread_section,
        )  # and with it numba, which a look at a scene does without

        modulus = values["net.youngs_modulus"]
        fibre, stiffness = fibre_of(modulus), modulus * thread_section(values)
        yield from strained("thread.tension_max", "a thread", thread.largest, stiffness, fibre.strain, fibre.name)
    if cord is not None and "closing.axial_stiffness" in values:
        name, stiffness = "closing.axial_stiffness", values["closing.axial_stiffness"]
        # the default is a nylon cord; of one that is given nothing is known but its stiffness
        limit, fibre_name = (ARAMID, "para-aramid (nylon 66: 20 %)") if name in given else (NYLON, "nylon 66")
        yield from strained("cord.tension_max", "the closing cord", cord.largest, stiffness, limit, fibre_name)
