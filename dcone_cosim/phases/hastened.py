"""A tow of which only figures are wanted, no table: up to its last orbit in macro steps that are many at once.

What our FMUs carry from step to step does not hang on where a macro step ends, and of what lies before the last orbit
the summary tells tugs, sums, the first state and the last. A run that ends otherwise than foreseen is taken again in
the macro steps of its scene.
"""

from __future__ import annotations

import re

from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.component import Steppable, output_names
from dcone_cosim.phases.phase import Stage
from dcone_cosim.phases.stepping import PhaseLoop, grid_steps
from dcone_cosim.phases.tension import last_orbit, orbital_period
from dcone_cosim.recorder import Recorder

COARSE = 16
"""Macro steps of a tow that are one where no row of it is wanted."""
MARGIN = 1.05
"""How much longer than the first orbit the last one may be [1]; a longer one is seen, and the run is taken again."""
AXIS = "center.semi_major_axis"
KNOWN = re.compile(
    r"(chaser|target|center|relative)\.(position|velocity)\[[123]\]|(chaser|target)\.radius|chaser\.propellant|tug\[.*"
    r"|tether\.(tension|tension_peak|tension_least|impulse|length|length_rate|taut|tug_count|angle)|separation|altitude"
    r"|approach\.(distance|time)|center\.semi_major_axis|energy\.(orbital|relative)|solver\.(steps|rejected)"
)
"""Outputs of which the summary tells nothing that hangs on rows before the last orbit. With any other, rows stay."""
BEGUN = "begun"
"""Key under which the state at the begin is kept."""


def possible(stage: Stage, component: Steppable) -> bool:
    """Whether the rows of a tow before its last orbit are asked for by nobody."""
    phase = stage.phase
    return (
        not (stage.tables or phase.main.fmu is not None or phase.others or stage.keeper is not None)
        and (stage.begun is None or stage.begun.state is None)
        and (component.can_save and component.can_vary_step and AXIS in component.variables)
        and all(KNOWN.fullmatch(name) for name in output_names(component.variables))
    )


class Hastened(PhaseLoop):
    """Steps many at once up to the last orbit.

    Checked  tests/cases/test_hastened.py: the figures are those of all rows, to the bit
    """

    def _run(self) -> None:
        axis = self.component.get([AXIS])[AXIS]
        slow = MARGIN * orbital_period(axis) if axis > 0.0 else self.duration
        until = int((self.duration - slow) / self.macro_step) // COARSE * COARSE
        if until <= 0:
            super()._run()
            return
        self.component.save(BEGUN)
        try:
            self._many, self._until = COARSE, until
            super()._run()
            if self._seen_in_full(until * self.macro_step):
                return
        except FmuError:
            pass  # whatever it is, it comes again in short steps, or is none there
        self.component.restore(BEGUN)
        self._many, self._until = 1, 0
        result = self.result
        result.recorder = Recorder(
            self.read.names, self.component.variables, grid_steps(self.duration, self.macro_step) + 1
        )
        result.steps = 0
        super()._run()

    def _seen_in_full(self, since: float) -> bool:
        """Whether the window of the last orbit lies where every row is, which is from a time on [s]."""
        tension = last_orbit(self.result)
        return (
            tension is not None and tension.is_orbit and tension.window <= self.result.end - self.result.start - since
        )
