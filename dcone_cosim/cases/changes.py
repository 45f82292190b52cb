"""Values of a phase of ours as the settings of the command line that give them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from dcone_cosim import build
from dcone_cosim.scene.data import SHARED, PhaseScene
from dcone_cosim.units import written


def changes_of(phase: PhaseScene, values: Mapping[str, float | Sequence[float]], digits: int = 6) -> tuple[str, ...]:
    """Values as settings: SI, by FMI name, or of a whole vector by its name without indices."""
    known = build.known_variables(phase.main.model) | build.asked_variables(phase.main.model)
    found = []
    for name, value in values.items():
        key = name if name.startswith(f"{SHARED}.") else f"{phase.name}.{name}"
        if isinstance(value, Sequence):
            unit = known[f"{name}[1]"][0].unit
            parts = (
                f'"{written(part, unit, digits)}"' if unit != "1" else written(part, unit, digits) for part in value
            )
            found.append(f"{key}=[{', '.join(parts)}]")
        elif known[name][0].choices:
            found.append(f'{key}="{known[name][0].choices[int(value)]}"')
        else:
            found.append(f"{key}={written(value, known[name][0].unit, digits)}")
    return tuple(found)


def following(phase: PhaseScene, values: Mapping[str, float]) -> Iterator[str]:
    """Terms that follow from values and are others with these, such as for how many nodes there are outputs."""
    main = phase.main
    for name, group in build.CATALOGUE[main.model].groups.items():
        if name in main.terms and group.follows is not None:
            term = group.follows(main.terms, {**main.values, **values})
            if term != group.follows(main.terms, main.values):
                yield f"{phase.name}.{group.table or name}.{group.selector}={term}"
