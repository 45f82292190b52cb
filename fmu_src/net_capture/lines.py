"""The lines of a net, as entries of the table of lines: threads, closing cord, edge rope and the bullets' leads."""

from __future__ import annotations

from fmu_src.lines import Line, Terms, Values

CORD_DIAMETER = 0.5e-3
"""Of the cord whose stiffness is the default of `closing.axial_stiffness` [m]."""


def thread_area(values: Values, terms: Terms) -> float | None:
    """Section [m2] of the thinnest thread of the net; None where nothing tells it, or for no net of ours."""
    if "net" not in terms:
        return None
    from fmu_src.net_capture.implied import thread_section  # and with it numba

    return thread_section(values, terms)


LINES = (
    Line(
        "thread",
        "a thread of the net",
        "net",
        ("thread.tension_max",),
        follows={
            "net.youngs_modulus": "youngs_modulus",
            "net.density": "density",
            "net.damping_ratio": "damping_ratio",
        },
        modulus="net.youngs_modulus",
        breaks_at="break.strength",
        broken=("break.count", "break.time"),
        area=thread_area,
    ),
    Line(
        "cord",
        "the closing cord",
        "closing",
        ("cord.tension_max",),
        follows={"closing.axial_stiffness": "axial_stiffness", "closing.damping_ratio": "damping_ratio"},
        stiffness="closing.axial_stiffness",
        diameter="closing.diameter",
        usual=CORD_DIAMETER,
        usual_material="nylon 66",
        group="closing",
    ),
    *(
        Line(
            name,
            label,
            name,
            (f"{name}.tension_max",),
            follows={f"{name}.{figure}": figure for figure in ("youngs_modulus", "density", "damping_ratio")},
            modulus=f"{name}.youngs_modulus",
            diameter=f"{name}.diameter",
            group=name,
        )
        for name, label in (("edge", "the edge rope"), ("leads", "a bullet's lead"))
    ),
)
