"""A model's kernel run in this process behind the same face as an FMU: the master cannot tell them apart."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from dcone_cosim.build import MODELS
from dcone_cosim.component import VariableInfo
from dcone_cosim.errors import FmuError
from fmu_src.instance import Instance, ModelFault


class KernelComponent:
    """Offers what `dcone_cosim.component.Steppable` asks, over `fmu_src.instance.Instance`."""

    def __init__(self, phase: str, name: str, terms: Mapping[str, str]) -> None:
        self.name = name
        self.instance = Instance(MODELS[phase], terms)
        self.variables = {
            n: VariableInfo(n, slot, v.kind, v.unit, v.causality, v.description)
            for n, slot, v, _ in self.instance.interface.scalars()
            if not n.startswith("@")
        }
        self.can_save = True
        self._kept = None

    def set(self, values: Mapping[str, float]) -> None:
        for name, value in values.items():
            self.instance[name] = value if self.variables[name].kind == "Real" else int(value)

    def get(self, names: Sequence[str]) -> dict[str, float]:
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

    def step(self, time: float, size: float) -> None:
        self.instance.time = time
        try:
            self.instance.step(size)
        except ModelFault as fault:
            raise FmuError(str(fault)) from None

    def save(self, key: str = "") -> None:
        self._kept = (self.instance.record.copy(), self.instance.work.copy())

    def restore(self, key: str = "") -> None:
        self.instance.record[:] = self._kept[0]
        self.instance.work[:] = self._kept[1]

    def close(self) -> None:
        pass


class KernelReader:
    def __init__(self, component: KernelComponent, names: Sequence[str]) -> None:
        order = {"Real": 0, "Integer": 1, "Boolean": 2}
        self.names = tuple(sorted(names, key=lambda n: order[component.variables[n].kind]))
        self._reals = [component.variables[n].reference for n in self.names if component.variables[n].kind == "Real"]
        self._others = [component.variables[n].reference for n in self.names if component.variables[n].kind != "Real"]
        self._record = component.instance.record
        self.values = np.zeros(len(self.names))

    def __call__(self):
        count = len(self._reals)
        self.values[:count] = self._record.view(np.float64)[self._reals]
        self.values[count:] = self._record.view(np.int64)[self._others]
        return self.values
