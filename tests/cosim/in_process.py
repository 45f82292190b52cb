"""A model's kernel run in this process behind the same face as an FMU: the master cannot tell them apart."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from dcone_cosim.build import CATALOGUE
from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.component import VariableInfo
from dcone_cosim.phases import kinds
from fmu_src.instance import Instance, ModelFault


class KernelComponent:
    """Offers what `dcone_cosim.fmu.component.Steppable` asks, over `fmu_src.instance.Instance`."""

    def __init__(self, phase: str, name: str, terms: Mapping[str, str]) -> None:
        self.name = name
        self.instance = Instance(CATALOGUE[kinds()[phase].model], terms)
        self.variables = {
            n: VariableInfo(n, slot, v.kind, v.unit, v.causality, v.description)
            for n, slot, v, _ in self.instance.interface.scalars()
            if not n.startswith("@")
        }
        self.can_save = self.can_vary_step = self.can_interpolate = True
        self._begun = self._stale = False
        self._kept = {}

    def set(self, values: Mapping[str, float]) -> None:
        for name, value in values.items():
            self.instance[name] = value if self.variables[name].kind == "Real" else int(value)
        self._stale = True

    def set_rates(self, rates: Mapping[str, float]) -> None:
        self.instance.set_rates(rates)

    def refresh(self) -> None:
        """As in the FMU: outputs that depend directly on inputs follow them when they are read."""
        if self._begun and self._stale:
            self.instance.refresh()
        self._stale = False

    def get(self, names: Sequence[str]) -> dict[str, float]:
        self.refresh()
        return {name: float(self.instance[name]) for name in names}

    def reader(self, names: Sequence[str]) -> KernelReader:
        return KernelReader(self, names)

    def enter_initialisation(self, start: float, stop: float | None = None) -> None:
        self._start = start

    def exit_initialisation(self) -> None:
        try:
            self.instance.initialise(self._start)
        except ModelFault as fault:
            raise FmuError(str(fault)) from None
        self._begun = True

    def step(self, time: float, size: float) -> None:
        self.instance.time = time
        try:
            self.instance.step(size)
        except ModelFault as fault:
            raise FmuError(str(fault)) from None

    def save(self, key: str = "") -> None:
        self.refresh()
        self._kept[key] = (self.instance.record.copy(), self.instance.work.copy(), self.instance.time)

    def restore(self, key: str = "") -> None:
        self.instance.record[:], self.instance.work[:], self.instance.time = self._kept[key]
        self._stale = False

    def release(self, key: str = "") -> None:
        self._kept.pop(key, None)

    def close(self) -> None:
        pass


class KernelReader:
    def __init__(self, component: KernelComponent, names: Sequence[str]) -> None:
        order = {"Real": 0, "Integer": 1, "Boolean": 2}
        self.names = tuple(sorted(names, key=lambda n: order[component.variables[n].kind]))
        self._reals = [component.variables[n].reference for n in self.names if component.variables[n].kind == "Real"]
        self._others = [component.variables[n].reference for n in self.names if component.variables[n].kind != "Real"]
        self._component, self._record = component, component.instance.record
        self.values = np.zeros(len(self.names))

    def __call__(self):
        self._component.refresh()
        count = len(self._reals)
        self.values[:count] = self._record.view(np.float64)[self._reals]
        self.values[count:] = self._record.view(np.int64)[self._others]
        return self.values
