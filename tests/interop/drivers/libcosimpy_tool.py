"""libcosimpy: an execution of one local slave, an override manipulator for the inputs, an observer for the outputs."""

from __future__ import annotations

from libcosimpy._internal import get_last_error_message
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

from tests.interop.job import Job, Row, serve

NANOSECONDS = 1e9


def need(done: bool) -> None:
    if not done:
        raise RuntimeError(get_last_error_message())


def run(job: Job) -> list[Row]:
    log_output_level(CosimLogLevel.WARNING)
    execution = CosimExecution.from_step_size(round(job.step * NANOSECONDS))
    slave = CosimLocalSlave(fmu_path=job.fmu, instance_name="towed")
    index = execution.add_local_slave(slave)
    need(index >= 0)
    observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
    need(execution.add_observer(observer))
    need(execution.add_manipulator(manipulator))
    initial = {
        "Real": execution.real_initial_value,
        "Integer": execution.integer_initial_value,
        "Boolean": execution.boolean_initial_value,
    }
    for name, value in job.parameters.items():
        need(initial[job.kinds[name]](index, job.references[name], value))
    override = {
        "Real": manipulator.slave_real_values,
        "Integer": manipulator.slave_integer_values,
        "Boolean": manipulator.slave_boolean_values,
    }
    latest = {
        "Real": observer.last_real_values,
        "Integer": observer.last_integer_values,
        "Boolean": observer.last_boolean_values,
    }
    rows = []
    for i in range(job.steps):
        for name, value in job.due(i).items():
            need(override[job.kinds[name]](index, [job.references[name]], [value]))
        need(execution.step())
        if i + 1 in job.looks:
            row: Row = {}
            for kind, read in latest.items():
                names = job.of_kind(kind)
                row |= zip(names, read(index, [job.references[name] for name in names]), strict=True)
            rows.append(row)
    return rows


if __name__ == "__main__":
    serve("libcosimpy", run)
