"""The paper's tables as a report: budgets line by line, Fig. 9, and bullets by rule and by simulation."""

from __future__ import annotations

from collections.abc import Sequence

from dcone_cosim.sizing import budget, bullets
from dcone_cosim.sizing.bullets import Opening
from dcone_cosim.sizing.section import Head, Section, text
from orbital import netting

MESHES = (0.1, 0.25, 0.5, 1.0)
"""Of the table of masses [m]."""
FIG_9, OPENINGS = "net_mass.png", "bullets.png"


def sections(openings: Sequence[Opening]) -> list[Section]:
    """All parts; `openings` empty for no flights."""
    return [_budget(), _masses(), _allowed(), *([_bullets(openings)] if openings else [])]


def said(openings: Sequence[Opening]) -> list[str]:
    """What it comes to, in sentences."""
    lines = budget.lines()
    kinds = (budget.DERIVED, budget.FITTED, budget.TAKEN)
    counts = {kind: sum(line.kind == kind for line in lines) for kind in kinds}
    worst = max((line for line in lines if line.kind == budget.DERIVED), key=lambda line: abs(line.difference))
    found = [
        f"of {sum(counts.values())} lines of Tables 3 and 4, {counts[budget.DERIVED]} are derived, "
        f"{counts[budget.FITTED]} fitted "
        f"and {counts[budget.TAKEN]} taken; only the derived ones say anything of the scalings",
        f"the derived line that is farthest off is {worst.name} of {worst.column}: {100.0 * worst.difference:+.2g} %",
    ]
    least = bullets.least(openings) if openings else None
    if least is not None:
        found.append(
            f"by simulation a mouth of {100 * bullets.ENOUGH:g} % of the net needs bullets of {least:.2g} times its "
            f"mass; the "
            f"paper's rule is {budget.BULLETS_OVER_NET:g}"
        )
    return found


def _budget() -> Section:
    rows = [
        (line.column, line.name, line.found, line.paper, line.difference, line.kind, line.how)
        for line in budget.lines()
    ]
    heads = (
        text("column", "debris"), text("line", "line"), Head("found", "here", "kg"), Head("paper", "paper", "kg"),
        Head("difference", "difference", "1", "%"), text("kind", "kind"), text("how", "from"),
    )  # fmt: skip
    purpose = (
        "Mass budgets with a margin of 20 %, each line beside the paper's. Derived: follows from the debris and "
        "from figures that "
        "stand elsewhere; fitted: a law whose parameters come from the figures it is held against; taken: the "
        "paper's own."
    )
    return Section("budget", "Tables 3 and 4 from scalings", purpose, heads, rows)


def _masses() -> Section:
    rows = [
        (mesh, *(netting.net_mass(a, b, mesh, budget.ARAMID.density, budget.THREAD) for _, a, b in budget.LARGE))
        for mesh in MESHES
    ]
    heads = (Head("mesh", "mesh", "m"), *(Head(name.replace(" ", "_"), name, "kg") for name, _, _ in budget.LARGE))
    purpose = (
        "Fig. 9: mass of the net over its mesh for the three configurations of the 8 t debris, 1 mm aramid of 1440 "
        "kg/m3, without "
        "margin, knots or edge rope: rho pi d^2/4 [a (b/l + 1) + b (a/l + 1)]."
    )
    return Section("net_mass", "Net mass over mesh", purpose, heads, rows, FIG_9)


def _allowed() -> Section:
    rows = [(one.name, one.bare, one.margined) for one in budget.allowed()]
    heads = (
        text("net", "net"), Head("bare", "mesh, all of it net", "m"), Head("margined", "mesh, 20 % of it margin", "m"),
    )  # fmt: skip
    purpose = f"The other way round: the mesh that Table 4's {budget.PAPER[2].net:g} kg allow each configuration."
    return Section("mesh", "Mesh that a mass allows", purpose, heads, rows)


def _bullets(openings: Sequence[Opening]) -> Section:
    rows = [(one.ratio, one.opening, one.when, one.since) for one in openings]
    heads = (
        Head("ratio", "bullets over net"), Head("opening", "largest mouth over the net's area", "1", "%"),
        Head("when", "at", "s"), Head("since", "above 80 % since", "s"),
    )  # fmt: skip
    purpose = (
        "Why bullets weigh six times the net: flights of the scene `deployment` (24 m, 3 m/s, 40 deg, a coarse net "
        "of 3 m meshes) "
        "with lighter and heavier ones. The ratio of the masses is what counts, so it holds for any size."
    )
    return Section("bullets", "Bullets by simulation", purpose, heads, rows, OPENINGS)
