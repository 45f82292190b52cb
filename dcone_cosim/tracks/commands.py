"""`dcone tracks` and `dcone fit` from beginning to end.

tracks.csv         every instant of every marker: measured, simulated, distance
markers.csv        root mean square and largest error of each marker
tracks.png         both over time
fit.json           of a fit: values with intervals, what was left, how it was found
scene.toml         of a fit: the scene that was fitted, as run with the values found
"""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from dcone_cosim import interrupts
from dcone_cosim.cases.case import Case
from dcone_cosim.cases.rows import Row
from dcone_cosim.cases.vary import in_si
from dcone_cosim.cases.work import Fleet
from dcone_cosim.drafts import atomic_folder, check_free
from dcone_cosim.errors import FmuError, InputError
from dcone_cosim.loading import named
from dcone_cosim.names import did_you_mean
from dcone_cosim.progress import Progress
from dcone_cosim.results import RunResult
from dcone_cosim.run_folder import as_json
from dcone_cosim.scene.data import PhaseScene, Scene
from dcone_cosim.scenes.kept import keep
from dcone_cosim.tracks.comparing import Compared, compare, overall
from dcone_cosim.tracks.fitting import CONFIDENCE, Fit, estimate
from dcone_cosim.tracks.plot import draw
from dcone_cosim.tracks.reading import Array, Track, read_tracks
from dcone_cosim.tracks.runs import CAPTURE, of_folder, of_result
from dcone_cosim.tracks.simulated import Flown

JITTER = 1e-6
"""How far beside it each node of a twin begins [m]."""


@dataclass
class Laid:
    """Tracks over a run, and where it was written."""

    found: list[Compared]
    folder: Path
    content: dict[str, Any]
    fit: Fit | None = None
    notes: list[str] = field(default_factory=list)


def tracks(run: Path, file: Path, out: Path | None) -> Laid:
    """Lay the tracks of a file over the run of a folder."""
    folder = out if out is not None else run.with_name(f"{run.absolute().name}-tracks")
    check_free(folder, False)
    measured = read_tracks(file)
    found = compare(of_folder(run), measured)
    content = {"run": str(run), "tracks": str(file), **_told(found)}
    with atomic_folder(folder) as draft:
        _write(found, draft.path, f"{run.name}: measured and simulated")
        (draft.path / "summary.json").write_text(as_json(content) + "\n", encoding="utf-8")
    return Laid(found, draft.folder, content)


def fit(
    name: str,
    file: Path,
    free: Sequence[str],
    out: Path | None,
    progress: Progress,
    settings: Sequence[str] = (),
    noise: float | None = None,
) -> Laid:
    """Estimate values of a scene from the tracks of a file.

    noise    standard deviation of a measured coordinate [m], None where it is not known
    """
    measured = read_tracks(file)
    until = max(float(track.times[-1]) for track in measured)
    scene = named(name, [*settings, 'phases=["capture"]', "capture.hand_over=none"])
    phase = _phase(scene)
    wanted = [_value(phase, key) for key in free]
    if not wanted or len(set(wanted)) < len(wanted):
        raise InputError(f"--free {','.join(free)}: expected keys of the capture, each once, as in net.damping_ratio")
    if until > phase.duration + 1e-9:
        raise InputError(
            f"{file} goes on to {until:g} s; expected no later than capture.duration, {phase.duration:g} s"
        )
    folder = out if out is not None else Path("runs") / f"{scene.name}-fit"
    check_free(folder, False)
    base = _shortened(scene, phase, until, measured)
    fleet = Fleet()
    last: list[RunResult] = []

    def fly(values: Sequence[float], more: Mapping[str, float]) -> Flown:
        last[:] = [_run(fleet, _with(base, {**dict(zip(wanted, values, strict=True)), **more}))]
        return of_result(last[0])

    def simulate(values: Sequence[float], seed: int) -> Array:
        interrupts.check("fit", 0.0)
        return _coordinates(compare(fly(values, _jitter(seed)), measured))[1]

    start = [_started(phase, value, key) for value, key in zip(wanted, free, strict=True)]
    try:
        with interrupts.heeded():
            given, _ = _coordinates(compare(fly(start, {}), measured))
            answer = estimate(
                wanted,
                start,
                [_bounds(phase, value) for value in wanted],
                given,
                simulate,
                noise,
                lambda runs, rms: progress.say(f"run {runs}: {rms:.4g} m off"),
            )
            found = compare(fly([one.value for one in answer.estimates], {}), measured)
    finally:
        fleet.close()
    content = {"scene": scene.name, "tracks": str(file), **_of_fit(answer, phase), **_told(found)}
    with atomic_folder(folder) as draft:
        _write(found, draft.path, f"{scene.title}: fitted")
        keep(scene, draft.path)
        (draft.path / "fit.json").write_text(as_json(content) + "\n", encoding="utf-8")
    return Laid(found, draft.folder, content, answer, [*answer.warnings])


def noise_of(text: str) -> float | None:
    """A length as told [m], None of an empty text."""
    if not text.strip():
        return None
    value = in_si(text)
    if value.unit != "m" or value.number is None or not 0.0 < value.number < math.inf:
        raise InputError(f'--noise {text}: expected a length above zero with its unit, such as "2 mm"')
    return value.number


def _phase(scene: Scene) -> PhaseScene:
    phase = scene.phases[0]
    if phase.name != CAPTURE:
        raise InputError(f"{scene.name} has no capture; expected a scene that begins with one")
    return phase


def _value(phase: PhaseScene, key: str) -> str:
    """FMI name of a free value, which a scene calls with or without the phase before it."""
    name = key.strip().removeprefix(f"{CAPTURE}.")
    if name not in phase.main.defaults:
        raise InputError(
            f"--free {key}: the capture has no parameter of that name{did_you_mean(name, phase.main.defaults)}"
        )
    return name


def _started(phase: PhaseScene, name: str, key: str) -> float:
    value = float(phase.setting(name) or 0.0)
    if value == 0.0:
        raise InputError(f"--free {key}: it is 0 in the scene; expected a first guess of its sign and size, by --set")
    return value


def _bounds(phase: PhaseScene, name: str) -> tuple[float, float]:
    """What the model allows."""
    from dcone_cosim import build

    row = next((row for row, _ in [build.known_variables(phase.main.model).get(name, (None, None))]), None)
    return (-math.inf, math.inf) if row is None else (float(row.minimum), float(row.maximum))


def _unit(phase: PhaseScene, name: str) -> str:
    """SI unit of a value, "1" for a pure number; "" where its FMU does not tell."""
    from dcone_cosim import build

    row, _ = build.known_variables(phase.main.model).get(name, (None, None))
    return "" if row is None else row.unit


def _jitter(seed: int) -> dict[str, float]:
    return {f"solver.jitter[{axis}]": JITTER for axis in (1, 2, 3)} | {"solver.seed": float(seed)}


def _shortened(scene: Scene, phase: PhaseScene, until: float, measured: Sequence[Track]) -> Scene:
    """To the last instant of the tracks, with the nodes kept at theirs."""
    options = phase.options
    instants = sorted({float(t) for track in measured if track.kind == "node" for t in track.times})
    if instants:
        options = replace(options, snapshots=instants)
    steps = max(1, math.ceil(until / phase.macro_step - 1e-9))
    return scene.with_phase(replace(phase, duration=steps * phase.macro_step, options=options))


def _with(scene: Scene, values: Mapping[str, float]) -> Scene:
    phase = scene.phases[0]
    known = {name: value for name, value in values.items() if name in phase.main.defaults}
    main = replace(phase.main, parameters={**phase.main.parameters, **known})
    return scene.with_phase(replace(phase, main=main))


def _run(fleet: Fleet, scene: Scene) -> RunResult:
    kept: list[RunResult] = []

    def tell(case: Case, result: RunResult, timings: Mapping[str, float]) -> Row:
        kept.append(result)
        return Row(case.key, result.status, result.exit_code, result.message)

    row = fleet.row(Case("", scene), tell)
    if not row.succeeded or not kept:
        raise FmuError(f"a run of the fit failed: {row.message or row.status}")
    return kept[-1]


def _coordinates(found: Sequence[Compared]) -> tuple[Array, Array]:
    """Measured and simulated coordinates of all that can be compared, in one order [m]."""
    measured = [one.track.positions[one.known].ravel() for one in found]
    simulated = [one.simulated[one.known].ravel() for one in found]
    return np.concatenate(measured), np.concatenate(simulated)


def _told(found: Sequence[Compared]) -> dict[str, Any]:
    return {"rms": overall(found), "unit": "m", "markers": [one.told() for one in found]}


def _of_fit(answer: Fit, phase: PhaseScene) -> dict[str, Any]:
    return {
        "values": {
            one.name: {
                "start": one.start,
                "value": one.value,
                "low": one.low,
                "high": one.high,
                "unit": _unit(phase, one.name),
            }
            for one in answer.estimates
        },
        "confidence": CONFIDENCE,
        "coordinate_rms_before": answer.before,
        "coordinate_rms_after": answer.after,
        "scatter_of_runs": answer.scatter,
        "noise": answer.noise,
        "chi2": answer.chi2,
        "correlation": answer.correlation,
        "coordinates": answer.coordinates,
        "runs": answer.runs,
        "converged": answer.converged,
    }


def _write(found: Sequence[Compared], folder: Path, title: str) -> None:
    with (folder / "tracks.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        axes = ("x", "y", "z")
        writer.writerow(
            [
                "time [s]",
                "marker",
                *(f"measured {a} [m]" for a in axes),
                *(f"simulated {a} [m]" for a in axes),
                "error [m]",
            ]
        )
        for one in found:
            for time, there, here, error in zip(
                one.track.times, one.track.positions, one.simulated, one.errors, strict=True
            ):
                writer.writerow([time, one.track.marker, *there, *here, error])
    rows = [one.told() for one in found]
    heads = list(dict.fromkeys(key for row in rows for key in row))
    with (folder / "markers.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, heads, restval="")
        table.writeheader()
        table.writerows(rows)
    draw(found, title, folder / "tracks.png")
