"""From a scene to a run that can be looked at, compared and trusted.

    scene.toml -> scene (read, checked) -> build (FMUs) -> master (phase, hand-off, phase) -> run (folder) -> reports

The master drives FMUs through the FMI 2.0 interface alone, by the variable names of `contract` and `handoff`: it cannot
tell ours from a foreign one. Only `build` knows the models this project makes; from their tables of variables follows
what a scene may say. Nothing is imported here, so that the command line answers at once.
"""
