"""What a run goes on from, and that the scene that goes on fits it.

What is over cannot change: phases before the one that goes on, hand-overs, and of that one whatever its FMU takes
before its start alone. Inputs, tunable parameters and how long it lasts may change, and all of the phases after it.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dcone_cosim.drafts import PROVENANCE
from dcone_cosim.errors import InputError
from dcone_cosim.fmu.steppable import VariableInfo
from dcone_cosim.loading import load
from dcone_cosim.phases import kind_of
from dcone_cosim.results import Begun, RunResult
from dcone_cosim.resume.differences import Difference, differences
from dcone_cosim.resume.instants import Place, begin_of, go_on_at, phase_of
from dcone_cosim.run_folder import ledger_file
from dcone_cosim.run_reading import json_of, provenance_of, read_run
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene_fmus import SceneFmus
from dcone_cosim.state_file import read
from dcone_cosim.states import KeptState

SAME = 1e-9
"""Share of an instant by which the one that is asked for may miss the one that was kept."""
FREE = ("duration",)
"""Fields of a phase that may change while it goes on."""
AFTER = "handoff.compare_without_recoil"
"""Concerns what is done after a phase alone."""


class Origin:
    """An earlier run, and a place in it.

    folder   of the run
    scene    that is to go on
    place    where
    """

    def __init__(self, folder: Path, text: str, settings: Sequence[str]) -> None:
        self.folder, self.option = folder, f"--from {text}"
        self._told = provenance_of(folder)
        self._base = load(str(folder))
        self.scene = load(str(folder), settings)
        if self.scene.accuracy is not None:
            raise InputError(f"{self.option}: the scene asks for an accuracy, which takes runs from their beginning")
        self.place: Place = go_on_at(text, self.scene)
        names = [phase.name for phase in self.scene.phases]
        before = names[: names.index(self.place.phase)]
        run = self._told["phases"]
        self.over = [name for name in before if name in run or not kind_of(name).retries]
        """Phases before it, but for shots that were left out."""

    def begun(self, archives: SceneFmus, scene: Scene) -> Begun:
        """What is gone on from, once the FMUs are there; `InputError` where it does not fit.

        scene    the one that goes on, as it is to be run
        """
        self._need_phases()
        found = differences(self._base, scene)
        self._need_unchanged(found)
        before = self._read(scene)
        self._need_fmus(archives, before)
        if self.place.time is None:
            return Begun(before, self.over, told=self._about(None, {}, before))
        state = self._state()
        self._need_time(state, scene)
        changed = self._changed(found, archives.variables(state.phase))
        place = list(self._told["handed_over_at"]).index(state.phase) if self.over else 0
        ledger = json_of(self.folder / ledger_file(place, state.phase)) if self.over else {}
        return Begun(before, self.over, state, changed, ledger, self._about(state, changed, before))

    def _need_phases(self) -> None:
        run = list(self._told["phases"])
        of = self.place.phase
        if self.place.time is None and not self.over:
            raise InputError(f"{self.option}: the {of} takes over from no other phase; run the scene itself")
        later = run[len(self.over) :]
        if kind_of(of).retries and later and of not in later:
            raise InputError(
                f"{self.option}: that run left the {of} out: the {self.over[-1]} before it had not failed. To make it, "
                f"run the scene from its beginning, so that the {self.over[-1]} fails"
            )
        if self.over != run[: len(self.over)]:
            raise InputError(f"{self.option}: that run has the phases {', '.join(run)}; the {of} has others before it")
        if self.place.time is not None and of not in run:
            raise InputError(
                f"{self.option}: that run came to no {of}: {self._told['message'] or self._told['status']}"
            )
        if self.over and not self._told["phases"][self.over[-1]].get("left"):
            raise InputError(
                f"{self.option}: in {self.folder} the {self.over[-1]} left nothing to take over: "
                f"{self._told['message'] or 'it came to its end, and no phase followed'}"
            )

    def _need_unchanged(self, found: Sequence[Difference]) -> None:
        """Refuse changes of what is over."""
        between = len(self.over) > (1 if self.place.time is None else 0)
        for row in found:
            if row.phase in self.over:
                raise InputError(
                    f"{self.option}: {row.told()}; the {row.phase} is over there, and cannot change any more"
                )
            if between and not row.phase and row.name.startswith("handoff.") and row.name != AFTER:
                raise InputError(
                    f"{self.option}: {row.told()}; the hand-over is over there, and cannot change any more"
                )

    def _changed(self, found: Sequence[Difference], variables: Mapping[str, VariableInfo]) -> dict[str, float]:
        """Values that the phase takes on its way; `InputError` for those that it cannot."""
        changed = {}
        for row in found:
            if row.phase != self.place.phase or (not row.part and row.name in FREE):
                continue
            variable = variables.get(row.name) if row.part == "parameters" else None
            if variable is None:
                raise InputError(
                    f"{self.option}: {row.told()}; the {row.phase} has begun there, and what it is made of, how it is "
                    f"stepped and what it is to do cannot change any more (its {', '.join(FREE)} can)"
                )
            if variable.causality != "input" and variable.variability != "tunable":
                may = sorted(v.name for v in variables.values() if v.causality == "input" or v.variability == "tunable")
                raise InputError(
                    f"{self.option}: {row.told()}; it is a {variable.variability or 'fixed'} {variable.causality}, "
                    f"which the FMU takes before its start alone, and the {row.phase} has begun there. "
                    f"What may change: {', '.join(may) or 'nothing'}"
                )
            changed[row.name] = float(row.now)
        return changed

    def _read(self, scene: Scene) -> RunResult:
        """The earlier run, with what goes on taken over anew."""
        run = [*self._told["phases"], ""]
        until = self.place.phase if self.place.time is None else run[run.index(self.place.phase) + 1]
        return read_run(self.folder, scene, until)

    def _need_fmus(self, archives: SceneFmus, before: RunResult) -> None:
        """The state of an FMU is good for no other one, nor what another has left."""
        if self.place.time is None:
            return
        name = self.place.phase
        self._adopt(archives, before)
        then, now = self._told["phases"][name], archives.facts()[name]
        version = self._told["packages"]["dcone-cosim"]
        pairs = [(name, then, now)]
        pairs += [
            (f"{name}, {part}", about, now["components"][part]) for part, about in then.get("components", {}).items()
        ]
        for part, was, is_ in pairs:
            one, other = was["fmu"]["guid"], is_["fmu"]["guid"]
            if one != other:
                raise InputError(
                    f"{self.option}: the kept state is of another FMU of the {part}: its GUID is {one}, kept by "
                    f"dcone-cosim {version}; this one has {other}. Run the scene from its beginning"
                )

    def _adopt(self, archives: SceneFmus, before: RunResult) -> None:
        """Have the FMU that the phase was run with: what was handed over may have needed another than the scene's."""
        phase = next(phase for phase in before.scene.phases if phase.name == self.place.phase)
        if phase.main.fmu is None:
            archives.adopt(phase)

    def _need_time(self, state: KeptState, scene: Scene) -> None:
        """Refuse a phase that is to end before the state."""
        begin, lasts = begin_of(scene, state.phase), phase_of(scene, state.phase).duration
        if state.time > begin + lasts:
            raise InputError(
                f"{self.option}: {state.phase}.duration = {lasts:g} s ends before that, at {begin + lasts:g} s"
            )

    def _state(self) -> KeptState:
        """The state that was kept nearest to the instant."""
        phase, time = self.place.phase, self.place.time
        assert time is not None
        kept = [row for row in self._told.get("states", ()) if row["phase"] == phase]
        for row in kept:
            if any(abs(time - row[of]) <= SAME * max(abs(time), abs(row[of])) for of in ("asked", "time")):
                state = read(self.folder / row["file"], row["sha256"])
                if (state.phase, state.time, state.rows) != (phase, row["time"], row["rows"]):
                    raise InputError(f"{self.folder / row['file']} is not the state of t = {row['time']:g} s")
                return state
        there = ", ".join(f"{row['time']:g} s" for row in kept) or "none"
        raise InputError(
            f"{self.option}: {self.folder} kept no state of the {phase} there; kept: {there}. "
            "`dcone run SCENE --save-at` keeps one"
        )

    def _about(self, state: KeptState | None, changed: Mapping[str, float], before: RunResult) -> dict[str, Any]:
        """What the provenance tells of it."""
        earlier = dict(before.gone_on)
        same = state is not None and earlier.get("phase") == state.phase
        return {
            "run": self.folder.absolute().name,
            "provenance_sha256": hashlib.sha256((self.folder / PROVENANCE).read_bytes()).hexdigest(),
            "phase": self.place.phase,
            "time": None if state is None else {"value": state.time, "unit": "s"},
            "changed": {**(earlier.get("changed", {}) if same else {}), **changed},
            "earlier": earlier or None,
        }
