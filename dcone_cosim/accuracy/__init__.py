"""What each choice of how to compute a scene costs, and how far off it is.

    settings    the choices there are for a phase: schemes, steps, tolerances, precision, macro and coupling steps
    plan        the phase of a scene by itself, and its cases
    work        one case run: its quantities and its CPU time
    judge       errors against a reference that is itself judged, the floor below which nothing can be told
    show        the table, and the sentence: for 1 % use ...
    plot        error against CPU time
    report      all of it as one page
    commands    `dcone accuracy`

It stands on the runner and the store of `cases`. What a phase is judged by, its kind says (`quantities`); how a model
of ours trades accuracy for time, the model says (`fmu_src.trade`). An FMU from elsewhere has its macro step, and the
coupling step where there is one.
"""
