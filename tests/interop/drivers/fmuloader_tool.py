"""fmuloader: the plain functions of FMI, called in the order of the standard. The times are those of this program."""

from __future__ import annotations

from fmuloader.fmi2 import Fmi2Slave, Fmi2Type

from tests.interop.job import Job, Row, serve


def run(job: Job) -> list[Row]:
    slave = Fmi2Slave(job.fmu, model_identifier=job.identifier)
    setters = {"Real": slave.set_real, "Integer": slave.set_integer, "Boolean": slave.set_boolean}
    getters = {"Real": slave.get_real, "Integer": slave.get_integer, "Boolean": slave.get_boolean}

    def give(values: Row) -> None:
        for name, value in values.items():
            setters[job.kinds[name]]([job.references[name]], [value])

    def look() -> Row:
        row: Row = {}
        for kind, getter in getters.items():
            names = job.of_kind(kind)
            row |= zip(names, getter([job.references[name] for name in names]), strict=True)
        return row

    slave.instantiate("towed", Fmi2Type.CO_SIMULATION, guid=job.guid)
    give(dict(job.parameters))
    slave.setup_experiment(start_time=0.0)
    slave.enter_initialization_mode()
    slave.exit_initialization_mode()
    rows, time = [], 0.0
    for i in range(job.steps):
        give(job.due(i))
        slave.do_step(time, job.step)
        time += job.step
        if i + 1 in job.looks:
            rows.append(look())
    slave.terminate()
    slave.free_instance()
    return rows


if __name__ == "__main__":
    serve("fmuloader", run)
